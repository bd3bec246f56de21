"""What moved pieces touch: vertices that have left a side, and pieces that have met.

A vertex that passes an edge of the side that it touches leaves its contact to this edge, or loses
it. Where pieces meet that had no interface, what follows is not known.
"""

from collections.abc import Collection, Iterable, Sequence
from itertools import chain, combinations, product

from .assembly import GivenAssembly, GivenPiece, GivenSolid, Node, Vector, cross, dot, length, plus
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
    least, pieces = MET * assembly.length_m, assembly.pieces
    solids = [
        (number, solid, _placed(solid, piece, motion))
        for number, (piece, motion) in enumerate(zip(pieces, motions, strict=True))
        for solid in piece.solids
    ]
    for (one, before, now), (other, others_before, others_now) in combinations(solids, 2):
        if one == other or (pieces[one].fixed and pieces[other].fixed):
            continue
        deep = _overlap(now, others_now, least)
        if deep <= least or deep <= least + max(0.0, _overlap(before, others_before, 0.0)):
            continue
        faces = [n for n, f in enumerate(assembly.faces) if {f.below, f.above} == {one, other}]
        nodes = [n for n, node in enumerate(every) if node.face in faces]
        left = [n for n in nodes if n not in lost]
        above = ((every[n], on_flat_side(assembly, every[n], motions)[1]) for n in left)
        pressed = (-far if node.vertex_above else far for node, far in above)
        if not faces or (left != nodes and deep > least + max(pressed, default=0.0)):
            where = "beyond their interface" if faces else "where they had no interface"
            return f"{pieces[one].name} meets {pieces[other].name}, {where}"
    return None


def _placed(solid: GivenSolid, piece: GivenPiece, motion: PieceMotion) -> GivenSolid:
    """A solid where its piece has moved to."""
    return GivenSolid(
        [plus(corner, moved(corner, piece.centre_m, motion)) for corner in solid.corners_m],
        [spun(normal, motion.rotation) for normal in solid.normals],
        [spun(edge, motion.rotation) for edge in solid.edges],
    )


def _overlap(one: GivenSolid, other: GivenSolid, enough: float) -> float:
    """Least overlap (m) of two solids along any axis that may separate them.

    Any that is not above ``enough`` if there is one.
    """
    crossed = (cross(*edges) for edges in product(one.edges, other.edges))
    across = (
        [part / size for part in axis] for axis in crossed if (size := length(axis)) > PARALLEL
    )
    least = min(
        min(other_high - low, high - other_low)
        for low, high, other_low, other_high in zip(*one.box, *other.box, strict=True)
    )
    for axis in chain(one.normals, other.normals, across):
        if least <= enough:
            break
        a, b = ([dot(corner, axis) for corner in each.corners_m] for each in (one, other))
        least = min(least, max(a) - min(b), max(b) - min(a))
    return least
