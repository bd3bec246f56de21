"""What moved pieces touch: vertices that have left a side, and pieces that have met.

A vertex that passes an edge of the side that it touches leaves its contact to this edge, or loses
it. Where pieces meet that had no interface, what follows is not known.
"""

from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import chain, combinations, product

from .assembly import GivenAssembly, GivenSolid, Node, Vector, cross, dot, length, plus
from .motion import STILL, Fall, PieceMotion, built, moved, spun, way
from .records import EngineOutcome

# Over the mean size of pieces, how far a vertex may be outside a side: one that was built inside;
# one beside bonds, or that was built at its edge, as a corner of both pieces; one that takes the
# place of another.
BEYOND_EDGE, BEYOND_CORNER, AT_EDGE = 0.0002, 0.05, 0.0002
MET = 0.01  # over that size: pieces that overlap by more have met
LOOK = 0.005  # over that size: the motion from one look at the surroundings to the next
PARALLEL = 1e-6  # sine of the angle of edges that have no normal in common


class Surroundings:
    """Looks at what pieces touch whenever one of them has moved on.

    ``nodes``: those of the assembly, or what has taken their places. ``lost``: numbers of those
    that have left the side that they touched. ``met``: which two pieces have met, in words.
    """

    def __init__(
        self, assembly: GivenAssembly, nodes: Sequence[Node] = (), lost: Iterable[int] = ()
    ) -> None:
        self.assembly, self.nodes, self.lost = assembly, list(nodes or assembly.nodes), set(lost)
        self.met: str | None = None
        self.looked = [STILL] * len(assembly.pieces)

    def copy(self) -> "Surroundings":
        """The same nodes, before any look."""
        return Surroundings(self.assembly, self.nodes, self.lost)

    def look(self, motions: Sequence[PieceMotion], *, at_rest: bool = False) -> list[int]:
        """Numbers of nodes that are lost or replaced since the last look.

        That was long ago if a piece has moved far, or, ``at_rest``, at all.
        """
        least = (AT_EDGE if at_rest else LOOK) * self.assembly.length_m
        if all(
            way(self.assembly, piece, self.looked[piece], motions[piece]) <= least
            for piece in range(len(motions))
        ):
            return []
        self.looked, off = list(motions), []
        for number, node in enumerate(self.nodes):
            if number not in self.lost and (edge := _edge_passed(self.assembly, node, motions)):
                off.append(number)
                other = _on_edge(self.assembly, node, motions, edge)
                # Beside bonds, which stay where they are, nodes are close to each other.
                bonds = not self.assembly.dry
                if bonds or _edge_passed(self.assembly, other, motions, new=True):
                    self.lost.add(number)
                else:
                    self.nodes[number] = other
        self.met = meeting(self.assembly, motions, self.nodes, self.lost)
        return off

    def at_last(self, fall: Fall, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """`Fall.at_last`, unless pieces that go on as they do meet before they have fallen."""
        outcome = fall.at_last(motions)
        if outcome is not EngineOutcome.UNSETTLED:
            self.met = meeting(self.assembly, fall.ahead(motions), self.nodes, self.lost)
        return EngineOutcome.MEETING if self.met else outcome


def on_flat_side(
    assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion]
) -> tuple[list[float], float]:
    """Where a node's vertex is on the other piece's flat side, which is where it was built.

    And how far it is above the plane of the face, on the side of the piece above it.
    """
    face = assembly.faces[node.face]
    vertex, flat = (face.above, face.below) if node.vertex_above else (face.below, face.above)
    there = moved(node.position_m, assembly.pieces[vertex].centre_m, motions[vertex])
    now = plus(node.position_m, there)
    place = built(now, assembly.pieces[flat].centre_m, motions[flat])
    above = dot(plus(place, assembly.planes_m[node.face], -1.0), face.normal)
    return plus(place, face.normal, -above), above


def centres(
    assembly: GivenAssembly, node: Node, radii: tuple[float, float], motions: Sequence[PieceMotion]
) -> tuple[list[float], list[float]]:
    """Centres (m) of a node's spheres below and above, where its pieces have moved to.

    That of the vertex touches it, that of the flat side its plane.
    """
    face, (place, above) = assembly.faces[node.face], on_flat_side(assembly, node, motions)
    flat = face.below if node.vertex_above else face.above
    middle, motion = assembly.pieces[flat].centre_m, motions[flat]
    under, over = (above, 0.0) if not node.vertex_above else (0.0, above)
    found = []
    for height in (under - radii[0], over + radii[1]):
        position = plus(place, face.normal, height)
        found.append(plus(position, moved(position, middle, motion)))
    return found[0], found[1]


def _edge_passed(
    assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion], new: bool = False
) -> Vector | None:
    """An edge of the flat side that a node's vertex has passed, if any; ``new``: as one that is."""
    face, (place, _) = assembly.faces[node.face], on_flat_side(assembly, node, motions)
    flat, own = face.edges_below, face.edges_above
    if not node.vertex_above:
        flat, own = own, flat

    def beyond(position: Vector, edge: Vector) -> float:
        return (dot(position, edge[:3]) - edge[3]) / assembly.length_m

    corner = sum(beyond(node.position_m, edge) >= -AT_EDGE for edge in own) > 1
    for edge in flat:
        both = not assembly.dry or (corner and beyond(node.position_m, edge) >= -AT_EDGE)
        if beyond(place, edge) > (AT_EDGE if new else BEYOND_CORNER if both else BEYOND_EDGE):
            return edge
    return None


def _on_edge(
    assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion], edge: Vector
) -> Node:
    """The node where a vertex has passed an ``edge``: a point of this on the side of the other."""
    place, _ = on_flat_side(assembly, node, motions)
    back = plus(place, edge[:3], edge[3] - dot(place, edge[:3]))
    return Node(node.face, back, node.area_m2, not node.vertex_above)


def meeting(
    assembly: GivenAssembly,
    motions: Sequence[PieceMotion],
    every: Sequence[Node],
    lost: Collection[int] = (),
) -> str | None:
    """Which two pieces overlap without a contact there, in words; None if none do.

    By more than `MET`, and than at the start. Where nodes between them are ``lost``, by more than
    the others are pressed together; where none is, pieces with an interface have not met. Solids
    that are not convex are left out.
    """
    least = MET * assembly.length_m
    for one, other in _near(assembly, motions, least):
        deep = _overlap(one, other, least)
        if deep <= least or deep <= least + max(
            0.0, _overlap(one.at_start(), other.at_start(), 0.0)
        ):
            continue
        pair = {one.piece, other.piece}
        faces = [n for n, face in enumerate(assembly.faces) if {face.below, face.above} == pair]
        nodes = [n for n, node in enumerate(every) if node.face in faces]
        left = [n for n in nodes if n not in lost]
        pressed = (_pressed(assembly, every[n], motions) for n in left)
        if not faces or (left != nodes and deep > least + max(pressed, default=0.0)):
            where = "beyond their interface" if faces else "where they had no interface"
            first, second = (assembly.pieces[each.piece].name for each in (one, other))
            return f"{first} meets {second}, {where}"
    return None


def _pressed(assembly: GivenAssembly, node: Node, motions: Sequence[PieceMotion]) -> float:
    """How far (m) a node's vertex has moved into the flat side."""
    above = on_flat_side(assembly, node, motions)[1]
    return -above if node.vertex_above else above


class _Placed:
    """A solid where its piece has moved to."""

    def __init__(
        self, piece: int, solid: GivenSolid, motion: PieceMotion, assembly: GivenAssembly
    ) -> None:
        centre = assembly.pieces[piece].centre_m
        self.piece, self.solid, self.assembly = piece, solid, assembly
        self.corners = [plus(c, moved(c, centre, motion)) for c in solid.corners_m]
        self.normals, self.edges = (
            [spun(each, motion.rotation) for each in ways] for ways in (solid.normals, solid.edges)
        )
        self.low, self.high = (list(map(f, *self.corners)) for f in (min, max))

    def at_start(self) -> "_Placed":
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
