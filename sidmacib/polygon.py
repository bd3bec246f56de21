"""The exact V-M envelope: the polygon that a feasible set projects to."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.programme import Sidmacib, SupportFunction


@dataclass(frozen=True)
class Envelope:
    """A convex polygon in the (V, M) plane.

    ``vertices``: (K, 2), V in N and M in N m, counter-clockwise from the smallest V.
    ``programmes``: number of linear programmes that it took, at most vertices plus
    edges (two more for a set without width in V).
    """

    vertices: Floats
    programmes: int


def envelope(model: Sidmacib) -> Envelope:
    """All vertices of the set of loads (V, M) that ``model`` carries.

    Raises `sidmacib.errors.CapacityError` if the set is empty or unbounded.
    """
    scale = np.array([model.joint.T0, model.joint.T0 * model.joint.a])
    furthest = SupportFunction.of(model)
    found = polygon(lambda normal: furthest(normal / scale) / scale)
    return Envelope(found.vertices * scale, found.programmes)


def polygon(support: Callable[[Floats], Floats], tolerance: float = 1e-7) -> Envelope:
    """The polygon whose furthest point along a normal (shape (2,)) is ``support(normal)``.

    Start from the two extremes along the first axis. Ask for the furthest point beyond each chord:
    if there is none the chord is an edge, otherwise the point splits it. A point found on an
    edge's interior proves that edge as well, so no question is asked twice, and there are at most
    as many as vertices and edges. Points closer than ``tolerance`` are taken for one; the polygon
    should be about 1 in size.
    """
    proofs: list[tuple[Floats, float]] = []  # half-planes known to touch the polygon

    def ask(normal: Floats) -> Floats:
        point = support(normal)
        proofs.append((normal, float(normal @ point)))
        return point

    def proven(start: Floats, end: Floats, outward: Floats) -> bool:
        return any(
            normal @ outward > 0.0
            and abs(normal @ start - reach) <= tolerance
            and abs(normal @ end - reach) <= tolerance
            for normal, reach in proofs
        )

    def between(start: Floats, end: Floats) -> list[Floats]:
        """Points of the boundary from ``start``, included, to ``end``, counter-clockwise."""
        chord = end - start
        if np.linalg.norm(chord) <= tolerance:
            return [start]
        normal = np.array([chord[1], -chord[0]]) / np.linalg.norm(chord)
        if proven(start, end, normal):
            return [start]
        point = ask(normal)
        if normal @ (point - start) <= tolerance:
            return [start]
        return between(start, point) + between(point, end)

    first, last = ask(np.array([-1.0, 0.0])), ask(np.array([1.0, 0.0]))
    if np.linalg.norm(last - first) <= tolerance:  # no width in the first axis
        first, last = ask(np.array([0.0, -1.0])), ask(np.array([0.0, 1.0]))
    if np.linalg.norm(last - first) <= tolerance:  # a single point
        return Envelope(np.array([first]), len(proofs))
    points = _without_straight_angles(between(first, last) + between(last, first), tolerance)
    start = min(range(len(points)), key=lambda i: (round(points[i][0], 7), round(points[i][1], 7)))
    return Envelope(np.array(points[start:] + points[:start]), len(proofs))


def _without_straight_angles(points: list[Floats], tolerance: float) -> list[Floats]:
    """Drop the points that lie within ``tolerance`` of the line between their neighbours."""
    kept: list[Floats] = list(points)
    index = 0
    while index < len(kept) and len(kept) > 2:
        before, point, after = kept[index - 1], kept[index], kept[(index + 1) % len(kept)]
        chord, arm = after - before, point - before
        length = float(np.linalg.norm(chord))
        if abs(chord[0] * arm[1] - chord[1] * arm[0]) <= tolerance * max(length, tolerance):
            del kept[index]
            index = max(index - 1, 0)
        else:
            index += 1
    return kept
