"""What moved pieces touch: vertices that have left a side, and pieces that have met.

Contacts are only those that the assembly has at the start. Where pieces meet elsewhere, the engine
cannot say what follows.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import chain, combinations, product

from .assembly import GivenAssembly, GivenSolid, Node, cross, dot, length, plus
from .motion import STILL, Fall, PieceMotion, moved, way
from .records import EngineOutcome

BEYOND_EDGE = 0.05  # over the mean size of pieces: a vertex further outside a side has left it
MET = 0.01  # over that size: pieces that overlap by more have met
LOOK = 0.01  # over that size: the motion from one look at the surroundings to the next
PARALLEL = 1e-6  # sine of the angle of edges that have no normal in common


class Surroundings:
    """Looks at what pieces touch whenever one of them has moved on.

    ``lost``: numbers of the nodes whose vertex has left the side that it touched. ``met``: which
    two pieces have met, in words.
    """

    def __init__(self, assembly: GivenAssembly, lost: Iterable[int] = ()) -> None:
        self.assembly, self.lost = assembly, set(lost)
        self.met: str | None = None
        self.looked = [STILL] * len(assembly.pieces)

    def look(self, motions: Sequence[PieceMotion]) -> list[int]:
        """Nodes that are lost since the last look, which was long ago if a piece has moved far."""
        least = LOOK * self.assembly.length_m
        if all(
            way(self.assembly, piece, self.looked[piece], motions[piece]) <= least
            for piece in self.assembly.free
        ):
            return []
        off = [
            number
            for number, node in enumerate(self.assembly.nodes)
            if number not in self.lost and _is_off(self.assembly, node, motions)
        ]
        self.looked = list(motions)
        self.lost.update(off)
        self.met = meeting(self.assembly, motions, self.lost)
        return off

    def at_last(self, fall: Fall, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """`Fall.at_last`, unless pieces that go on as they do meet before they have fallen."""
        outcome = fall.at_last(motions)
        if outcome is not EngineOutcome.UNSETTLED:
            self.met = meeting(self.assembly, fall.ahead(motions), self.lost)
        return EngineOutcome.MEETING if self.met else outcome


def _slip(assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion]) -> list[float]:
    """How a node's vertex has moved (m) from where the other piece's side has moved to."""
    face = assembly.faces[node.face]
    above, below = (
        moved(node.position_m, assembly.pieces[piece].centre_m, motions[piece])
        for piece in (face.above, face.below)
    )
    return plus(above, below, -1.0) if node.vertex_above else plus(below, above, -1.0)


def _is_off(assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion]) -> bool:
    """Whether a node's vertex is off the other piece's side."""
    face = assembly.faces[node.face]
    place = plus(node.position_m, _slip(assembly, node, motions))
    most = BEYOND_EDGE * assembly.length_m
    edges = face.edges_below if node.vertex_above else face.edges_above
    return any(dot(place, edge[:3]) - edge[3] > most for edge in edges)


def meeting(
    assembly: GivenAssembly, motions: Sequence[PieceMotion], lost: Collection[int] = ()
) -> str | None:
    """Which two pieces overlap without a contact there, in words; None if none do.

    By more than `MET`, and than at the start. Where nodes between them are ``lost``, by more than
    the others are pressed together; where none is, pieces with an interface have not met. Solids
    that are not convex are left out.
    """
    least = MET * assembly.length_m
    for one, other in _near(assembly, motions, least):
        deep = _overlap(one, other, least)
        if deep <= least or deep <= least + max(0.0, _overlap(one.built(), other.built(), 0.0)):
            continue
        pair = {one.piece, other.piece}
        faces = [n for n, face in enumerate(assembly.faces) if {face.below, face.above} == pair]
        nodes = [n for n, node in enumerate(assembly.nodes) if node.face in faces]
        left = [n for n in nodes if n not in lost]
        pressed = (_pressed(assembly, assembly.nodes[n], motions) for n in left)
        if not faces or (left != nodes and deep > least + max(pressed, default=0.0)):
            where = "beyond their interface" if faces else "where they had no interface"
            first, second = (assembly.pieces[each.piece].name for each in (one, other))
            return f"{first} meets {second}, {where}"
    return None


def _pressed(assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion]) -> float:
    """How far (m) a node's vertex has moved into the side, whose normal turns with its piece."""
    face = assembly.faces[node.face]
    turn = PieceMotion(
        STILL.displacement, motions[face.below if node.vertex_above else face.above].rotation
    )
    normal = plus(face.normal, moved(face.normal, STILL.displacement, turn))
    into = dot(_slip(assembly, node, motions), normal)
    return -into if node.vertex_above else into


class _Placed:
    """A solid where its piece has moved to."""

    def __init__(
        self, piece: int, solid: GivenSolid, motion: PieceMotion, assembly: GivenAssembly
    ) -> None:
        centre = assembly.pieces[piece].centre_m
        turn = PieceMotion((0.0, 0.0, 0.0), motion.rotation)
        self.piece, self.solid, self.assembly = piece, solid, assembly
        self.corners = [plus(c, moved(c, centre, motion)) for c in solid.corners_m]
        self.normals, self.edges = (
            [plus(each, moved(each, (0.0, 0.0, 0.0), turn)) for each in ways]
            for ways in (solid.normals, solid.edges)
        )
        self.low, self.high = (list(map(f, *self.corners)) for f in (min, max))

    def built(self) -> "_Placed":
        """The solid where it was at the start."""
        return _Placed(self.piece, self.solid, STILL, self.assembly)


def _near(
    assembly: GivenAssembly, motions: Sequence[PieceMotion], least: float
) -> Iterator[tuple[_Placed, _Placed]]:
    """Solids of different pieces, not both fixed, whose boxes overlap by more than ``least``."""
    placed = [
        _Placed(number, solid, motions[number], assembly)
        for number, piece in enumerate(assembly.pieces)
        for solid in piece.solids
    ]
    for one, other in combinations(placed, 2):
        near = all(
            min(one.high[axis] - other.low[axis], other.high[axis] - one.low[axis]) > least
            for axis in range(3)
        )
        fixed = all(assembly.pieces[each.piece].fixed for each in (one, other))
        if near and one.piece != other.piece and not fixed:
            yield one, other


def _overlap(one: _Placed, other: _Placed, enough: float) -> float:
    """Least overlap (m) of two solids along any axis that may separate them.

    Any that is not above ``enough`` if there is one.
    """
    crossed = (cross(*edges) for edges in product(one.edges, other.edges))
    across = (
        [part / size for part in axis] for axis in crossed if (size := length(axis)) > PARALLEL
    )
    least = float("inf")
    for axis in chain(one.normals, other.normals, across):
        a, b = ([dot(corner, axis) for corner in each.corners] for each in (one, other))
        least = min(least, max(a) - min(b), max(b) - min(a))
        if least <= enough:
            break
    return least
