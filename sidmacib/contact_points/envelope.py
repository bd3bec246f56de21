"""The exact V-M envelope: the polygon onto which the feasible set projects."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sidmacib.contact_points.programme import Sidmacib, SupportFunction
from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Floats

LEAST_SIZE = 1e-9  # a smaller polygon is a point
MOST_PROGRAMMES = 1000  # if more are needed, answers contradict each other


@dataclass(frozen=True)
class Envelope:
    """A convex polygon in the (V, M) plane.

    ``vertices``: (K, 2), V in N and M in N m, counter-clockwise from the smallest V.
    ``programmes``: number of linear programmes that were solved, at most vertices plus edges (four
    for a set without width in V).
    """

    vertices: Floats
    programmes: int


def envelope(model: Sidmacib) -> Envelope:
    """All vertices of the set of loads (V, M) that ``model`` carries.

    Raises `sidmacib.errors.CapacityError` if the set is empty.
    """
    furthest = SupportFunction(model)
    in_units = polygon(furthest)
    # Plus 0 turns -0 into 0.
    return Envelope(in_units.vertices * furthest.plane + 0.0, in_units.programmes)


def polygon(support: Callable[[Floats], Floats], tolerance: float = 1e-7) -> Envelope:
    """The polygon whose furthest point along a normal (shape (2,)) is ``support(normal)``.

    It starts from the two extremes along the first axis and looks for the furthest point beyond
    each chord: if there is none the chord is an edge, otherwise the point splits it. A point inside
    an edge proves that edge as well, so no programme is solved twice, and their number is at most
    that of vertices and edges. Lengths below ``tolerance`` times the polygon's distance from the
    origin, which should be about 1, count as 0. Raises `sidmacib.errors.SolverError` if answers
    contradict each other so much that the search does not end.
    """
    queries = _Queries(support)
    first, last = queries.furthest(-1.0, 0.0), queries.furthest(1.0, 0.0)
    if last[0] - first[0] <= tolerance * queries.size:  # no width in the first axis
        first, last = queries.furthest(0.0, -1.0), queries.furthest(0.0, 1.0)
        straight = last[1] - first[1] > tolerance * queries.size
        return Envelope(np.array([first, last] if straight else [first]), len(queries.proofs))
    points: list[Floats] = []
    chords = [(last, first), (first, last)]  # what is left of the boundary, next chord last
    while chords:
        start, end = chords.pop()
        point = _beyond(queries, start, end, tolerance * queries.size)
        if point is None:
            points.append(start)
        else:
            chords += [(point, end), (start, point)]
    nothing = tolerance * queries.size
    points = _without_straight_angles(points, nothing)
    left = min(point[0] for point in points)
    lefts = [i for i, point in enumerate(points) if point[0] <= left + nothing]
    begin = min(lefts, key=lambda i: points[i][1])
    return Envelope(np.array(points[begin:] + points[:begin]), len(queries.proofs))


class _Queries:
    """Queries of ``support`` so far: half-planes that touch the polygon, and its size."""

    def __init__(self, support: Callable[[Floats], Floats]) -> None:
        self.support = support
        self.proofs: list[tuple[Floats, float]] = []
        self.size = LEAST_SIZE

    def furthest(self, x: float, y: float) -> Floats:
        if len(self.proofs) == MOST_PROGRAMMES:
            raise SolverError(f"envelope: incomplete after {MOST_PROGRAMMES} programmes")
        normal = np.array([x, y])
        point = self.support(normal)
        self.proofs.append((normal, float(normal @ point)))
        self.size = max(self.size, float(np.abs(point).max()))
        return point

    def proven(self, start: Floats, end: Floats, outward: Floats, nothing: float) -> bool:
        """Whether an answer shows that the chord is an edge."""
        return any(
            normal @ outward > 0.0
            and abs(normal @ start - reach) <= nothing
            and abs(normal @ end - reach) <= nothing
            for normal, reach in self.proofs
        )


def _beyond(queries: _Queries, start: Floats, end: Floats, nothing: float) -> Floats | None:
    """The furthest point beyond the chord, None if the chord is an edge."""
    chord = end - start
    length = float(np.hypot(*chord))
    if length <= nothing:
        return None
    normal = np.array([chord[1], -chord[0]]) / length
    if queries.proven(start, end, normal, nothing):
        return None
    point = queries.furthest(*normal)
    return point if normal @ (point - start) > nothing else None


def _without_straight_angles(points: list[Floats], nothing: float) -> list[Floats]:
    """Drop the points that lie within ``nothing`` of the line between their neighbours."""
    kept: list[Floats] = list(points)
    index = 0
    while index < len(kept) and len(kept) > 2:
        before, point, after = kept[index - 1], kept[index], kept[(index + 1) % len(kept)]
        chord, arm = after - before, point - before
        length = float(np.hypot(*chord))
        if abs(chord[0] * arm[1] - chord[1] * arm[0]) <= nothing * max(length, nothing):
            del kept[index]
            index = max(index - 1, 0)
        else:
            index += 1
    return kept
