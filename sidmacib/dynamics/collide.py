"""Contacts of two convex solids, wherever they are: the plane that parts them best, and points.

The plane is that of a side of one of them, or lies along an edge of either; of all it is the one
from which they are furthest apart, or overlap least (separating axes). On a side, the contact
points are the corners of the opposite side within its outline, and where outlines cross.
"""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.newton.vectors import cross, dot

CORNERS = 64  # of a side, at most
MOST = 2 * CORNERS  # of an outline that is cut
POINTS = 16  # contacts of two solids, the outermost of more
EDGE = 1e-3  # over the solids' size: edges count where they part the solids by so much more
THIN = 1e-6  # over it: a narrower overlap of outlines bears nothing
PARALLEL = 1e-3  # least sine between edges that give a direction


@compiled
def _row(table, k):
    return (table[k, 0], table[k, 1], table[k, 2])


@compiled
def _span(places, first, last, axis):
    """Least and largest coordinate along an axis."""
    low = high = dot(_row(places, first), axis)
    for k in range(first + 1, last):
        along = dot(_row(places, k), axis)
        low = min(low, along)
        high = max(high, along)
    return low, high


@compiled
def _best_side(solids, places, one, other):
    """The side of ``one`` from which ``other`` is furthest, and how far (m)."""
    best, gap = -1, -np.inf
    for side in range(solids.sides[one], solids.sides[one + 1]):
        normal = _row(places.normals, side)
        on = dot(_row(places.vertices, solids.corners[solids.outlines[side]]), normal)
        low, _ = _span(places.vertices, solids.vertices[other], solids.vertices[other + 1], normal)
        if low - on > gap:
            best, gap = side, low - on
    return best, gap


@compiled
def _best_edges(solids, places, one, other, most):
    """The direction across an edge of either that parts them by more than ``most`` (m)."""
    best, gap = (0.0, 0.0, 0.0), most
    for i in range(solids.edges[one], solids.edges[one + 1]):
        for j in range(solids.edges[other], solids.edges[other + 1]):
            axis = cross(_row(places.edges, i), _row(places.edges, j))
            length = np.sqrt(dot(axis, axis))
            if length < PARALLEL:
                continue
            axis = (axis[0] / length, axis[1] / length, axis[2] / length)
            low, high = _span(places.vertices, solids.vertices[one], solids.vertices[one + 1], axis)
            least, most_of = _span(
                places.vertices, solids.vertices[other], solids.vertices[other + 1], axis
            )
            if least - high > gap:
                best, gap = axis, least - high
            if low - most_of > gap:
                best, gap = (-axis[0], -axis[1], -axis[2]), low - most_of
    return best, gap


@compiled
def _opposite(solids, places, solid, normal, near):
    """The side of a ``solid`` that looks most against a ``normal``, of those at its lowest point.

    That is the one least along the normal; ``near`` (m): points no higher are as low.
    """
    first, last = solids.vertices[solid], solids.vertices[solid + 1]
    low, _ = _span(places.vertices, first, last, normal)
    best, least = -1, np.inf
    for side in range(solids.sides[solid], solids.sides[solid + 1]):
        along = dot(_row(places.normals, side), normal)
        if along >= least:
            continue
        for k in range(solids.outlines[side], solids.outlines[side + 1]):
            if dot(_row(places.vertices, solids.corners[k]), normal) <= low + near:
                best, least = side, along
                break
    return best


@compiled
def _cut(outline, count, at, across, cut):
    """The part of an ``outline`` of ``count`` corners behind a plane, in ``cut``: how many."""
    kept = 0
    for k in range(count):
        here, after = _row(outline, k), _row(outline, (k + 1) % count)
        d = dot(here, across) - at
        e = dot(after, across) - at
        if d <= 0.0 and kept < MOST:
            for i in range(3):
                cut[kept, i] = here[i]
            kept += 1
        if (d <= 0.0) != (e <= 0.0) and kept < MOST:
            share = d / (d - e)
            for i in range(3):
                cut[kept, i] = here[i] + share * (after[i] - here[i])
            kept += 1
    return kept


@compiled
def _width(outline, count, normal):
    """Area of an outline seen along a ``normal`` over its length, m."""
    around, length = 0.0, 0.0
    first = _row(outline, 0)
    for k in range(1, count):
        one = (
            outline[k, 0] - first[0],
            outline[k, 1] - first[1],
            outline[k, 2] - first[2],
        )
        length = max(length, np.sqrt(dot(one, one)))
        if k + 1 < count:
            other = (
                outline[k + 1, 0] - first[0],
                outline[k + 1, 1] - first[1],
                outline[k + 1, 2] - first[2],
            )
            around += dot(cross(one, other), normal)
    return abs(around) / (2.0 * length) if length > 0.0 else 0.0


@compiled
def _on_side(solids, places, side, other, size, reach, place, gaps):
    """Points of a solid ``other`` over a ``side``, no further from it than ``reach``: how many."""
    normal = _row(places.normals, side)
    first, last = solids.outlines[side], solids.outlines[side + 1]
    on = dot(_row(places.vertices, solids.corners[first]), normal)
    facing = _opposite(solids, places, other, normal, THIN * size)
    outline, cut = np.empty((MOST, 3)), np.empty((MOST, 3))
    count = 0
    for k in range(solids.outlines[facing], solids.outlines[facing + 1]):
        for i in range(3):
            outline[count, i] = places.vertices[solids.corners[k], i]
        count += 1
    for k in range(first, last):
        here = _row(places.vertices, solids.corners[k])
        after = _row(places.vertices, solids.corners[k + 1 if k + 1 < last else first])
        along = (after[0] - here[0], after[1] - here[1], after[2] - here[2])
        across = cross(along, normal)
        length = np.sqrt(dot(across, across))
        across = (across[0] / length, across[1] / length, across[2] / length)
        count = _cut(outline, count, dot(here, across) + THIN * size, across, cut)
        outline, cut = cut, outline
        if count == 0:
            return 0
    if count < 3 or _width(outline, count, normal) < 4.0 * THIN * size:
        return 0
    found = 0  # points that are near, at the start of the outline
    for k in range(count):
        gap = dot(_row(outline, k), normal) - on
        if gap > reach or _is_there(outline, found, k, 10.0 * THIN * size):
            continue
        for i in range(3):
            outline[found, i] = outline[k, i]
        found += 1
    found = _outermost(outline, found, normal)
    for k in range(found):
        gaps[k] = dot(_row(outline, k), normal) - on
        for i in range(3):
            place[k, i] = outline[k, i] - 0.5 * gaps[k] * normal[i]
    return found


@compiled
def _is_there(outline, found, k, near):
    """Whether the point ``k`` of an outline is one of its first ``found``."""
    for earlier in range(found):
        apart = 0.0
        for i in range(3):
            apart = max(apart, abs(outline[earlier, i] - outline[k, i]))
        if apart < near:
            return True
    return False


@compiled
def _outermost(outline, count, normal):
    """Put those of ``count`` points first that are outermost in `POINTS` directions: how many."""
    if count <= POINTS:
        return count
    along = normal[0] if abs(normal[0]) < 0.6 else normal[1]
    t = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.6 else (0.0, 1.0, 0.0)
    t = (t[0] - along * normal[0], t[1] - along * normal[1], t[2] - along * normal[2])
    length = np.sqrt(dot(t, t))
    t = (t[0] / length, t[1] / length, t[2] / length)
    u = cross(normal, t)
    chosen = np.zeros(count, np.bool_)
    for way in range(POINTS):
        angle = 2.0 * np.pi * way / POINTS
        c, s = np.cos(angle), np.sin(angle)
        axis = (c * t[0] + s * u[0], c * t[1] + s * u[1], c * t[2] + s * u[2])
        best, most = 0, -np.inf
        for k in range(count):
            out = dot(_row(outline, k), axis)
            if out > most:
                best, most = k, out
        chosen[best] = True
    kept = 0
    for k in range(count):
        if chosen[k]:
            for i in range(3):
                outline[kept, i] = outline[k, i]
            kept += 1
    return kept


@compiled
def _nearest_of_edges(solids, places, one, other, axis, place):
    """The point between the edges of two solids that are nearest along an ``axis``."""
    best = np.inf
    for i in range(solids.rims[one], solids.rims[one + 1]):
        a, b = _row(places.vertices, solids.ends[i, 0]), _row(places.vertices, solids.ends[i, 1])
        for j in range(solids.rims[other], solids.rims[other + 1]):
            c, d = (
                _row(places.vertices, solids.ends[j, 0]),
                _row(places.vertices, solids.ends[j, 1]),
            )
            u = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
            v = (d[0] - c[0], d[1] - c[1], d[2] - c[2])
            w = (a[0] - c[0], a[1] - c[1], a[2] - c[2])
            uu, uv, vv = dot(u, u), dot(u, v), dot(v, v)
            det = uu * vv - uv * uv
            if det <= PARALLEL**2 * uu * vv:
                continue
            uw, vw = dot(u, w), dot(v, w)
            s = min(max((uv * vw - vv * uw) / det, 0.0), 1.0)
            t = min(max((uu * vw - uv * uw) / det, 0.0), 1.0)
            p = (a[0] + s * u[0], a[1] + s * u[1], a[2] + s * u[2])
            q = (c[0] + t * v[0], c[1] + t * v[1], c[2] + t * v[2])
            apart = (q[0] - p[0], q[1] - p[1], q[2] - p[2])
            along = dot(apart, axis)
            aside = dot(apart, apart) - along * along
            if aside < best:
                best = aside
                for k in range(3):
                    place[0, k] = 0.5 * (p[k] + q[k])
    return best


@compiled
def meet(solids, places, one, other, size, reach, held, normal, place, gaps):
    """Contacts of two solids no further apart than ``reach`` (m): their number, and the side.

    ``normal``: from ``one`` to ``other``, ``place``: m, ``gaps``: m, which are filled. ``held``:
    the side that they were last found on, or -1: it is kept unless another parts them by `EDGE` of
    their ``size`` (m) more.
    """
    side, gap = _best_side(solids, places, one, other)
    flat, clear = _best_side(solids, places, other, one)
    if max(gap, clear) > reach:
        return 0, -1
    of_one = gap >= clear - EDGE * EDGE * size
    if not of_one:
        side, gap = flat, clear
    if held >= 0 and held != side:
        first = solids.sides[one] <= held < solids.sides[one + 1]
        along = _row(places.normals, held)
        on = dot(_row(places.vertices, solids.corners[solids.outlines[held]]), along)
        far = other if first else one
        low, _ = _span(places.vertices, solids.vertices[far], solids.vertices[far + 1], along)
        if low - on >= gap - EDGE * size:
            side, gap, of_one = held, low - on, first
    axis, apart = _best_edges(solids, places, one, other, gap + EDGE * size)
    if apart > reach:
        return 0, -1
    crosses = apart > gap + EDGE * size
    if crosses and _nearest_of_edges(solids, places, one, other, axis, place) < np.inf:
        for i in range(3):
            normal[i] = axis[i]
        gaps[0] = apart
        return 1, -1
    sign = 1.0 if of_one else -1.0
    for i in range(3):
        normal[i] = sign * places.normals[side, i]
    far = other if of_one else one
    return _on_side(solids, places, side, far, size, reach, place, gaps), side
