"""The exact V-M envelope: the polygon that a feasible set projects to."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sidmacib.contact_points.programme import Sidmacib, SupportFunction
from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Floats

LEAST_SIZE = 1e-9  # what is smaller is a point
MOST_PROGRAMMES = 1000  # a polygon that asks for more is none


@dataclass(frozen=True)
class Envelope:
    """A convex polygon in the (V, M) plane.

    ``vertices``: (K, 2), V in N and M in N m, counter-clockwise from the smallest V.
    ``programmes``: number of linear programmes that it took, at most vertices plus
    edges (four for a set without width in V).
    """

    vertices: Floats
    programmes: int


def envelope(model: Sidmacib) -> Envelope:
    """All vertices of the set of loads (V, M) that ``model`` carries.

    Raises `sidmacib.errors.CapacityError` if the set is empty.
    """
    furthest = SupportFunction.of(model)
    found = polygon(furthest)
    # Plus 0: no -0 in tables.
    return Envelope(found.vertices * furthest.plane + 0.0, found.programmes)


def polygon(support: Callable[[Floats], Floats], tolerance: float = 1e-7) -> Envelope:
    """The polygon whose furthest point along a normal (shape (2,)) is ``support(normal)``.

    Start from the two extremes along the first axis. Ask for the furthest point beyond each chord:
    if there is none the chord is an edge, otherwise the point splits it. A point found on an
    edge's interior proves that edge as well, so no question is asked twice, and there are at most
    as many as vertices and edges. Lengths below ``tolerance`` times the polygon's distance from
    the origin, which should be about 1, are taken for nothing. Raises
    `sidmacib.errors.SolverError` if answers contradict each other so much that it comes to no end.
    """
    asked = _Asked(support)
    first, last = asked.furthest(-1.0, 0.0), asked.furthest(1.0, 0.0)
    if last[0] - first[0] <= tolerance * asked.size:  # no width in the first axis
        first, last = asked.furthest(0.0, -1.0), asked.furthest(0.0, 1.0)
        straight = last[1] - first[1] > tolerance * asked.size
        return Envelope(np.array([first, last] if straight else [first]), len(asked.proofs))
    points: list[Floats] = []
    chords = [(last, first), (first, last)]  # the boundary that is left, its next part at the end
    while chords:
        start, end = chords.pop()
        point = _beyond(asked, start, end, tolerance * asked.size)
        if point is None:
            points.append(start)
        else:
            chords += [(point, end), (start, point)]
    nothing = tolerance * asked.size
    points = _without_straight_angles(points, nothing)
    left = min(point[0] for point in points)
    lefts = [i for i, point in enumerate(points) if point[0] <= left + nothing]
    begin = min(lefts, key=lambda i: points[i][1])
    return Envelope(np.array(points[begin:] + points[:begin]), len(asked.proofs))


class _Asked:
    """What was asked of ``support``: half-planes that touch the polygon, and its size."""

    def __init__(self, support: Callable[[Floats], Floats]) -> None:
        self.support = support
        self.proofs: list[tuple[Floats, float]] = []
        self.size = LEAST_SIZE

    def furthest(self, x: float, y: float) -> Floats:
        if len(self.proofs) == MOST_PROGRAMMES:
            raise SolverError(f"envelope: more than {MOST_PROGRAMMES} programmes; give up")
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


def _beyond(asked: _Asked, start: Floats, end: Floats, nothing: float) -> Floats | None:
    """The furthest point beyond the chord, None if the chord is an edge."""
    chord = end - start
    length = float(np.hypot(*chord))
    if length <= nothing:
        return None
    normal = np.array([chord[1], -chord[0]]) / length
    if asked.proven(start, end, normal, nothing):
        return None
    point = asked.furthest(*normal)
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
