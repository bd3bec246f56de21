"""Faces of any outline, and contact nodes on them.

A rectangle has the nodes of the joint's faces, in either direction. A convex outline is cut into
triangles around its centroid, any other by a constrained Delaunay triangulation; each triangle is
divided into equal ones no longer than the mesh.

Triangles between nodes fill a face, over whose pressed parts pressure is integrated. Where a
polygon may be cut into triangles in several ways, all count, with equal shares: no diagonal is
preferred.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import shapely

from sidmacib.mechanics.assembly import (
    CLOSE,
    Face,
    Floats,
    Integers,
    Kind,
    NodeLayout,
    Nodes,
    Vector,
)
from sidmacib.mechanics.contact_nodes import cells_along, side_rule

# Quadrature rules of a triangle: barycentric places, and weights. The last is exact to degree 3.
CORNERS = np.eye(3)
TRIANGLE_RULES = {
    NodeLayout.CENTRES: (np.full((1, 3), 1 / 3), np.ones(1)),
    NodeLayout.VERTICES: (CORNERS, np.full(3, 1 / 3)),
    NodeLayout.LOBATTO: (
        np.concatenate([CORNERS, (1.0 - CORNERS) / 2, np.full((1, 3), 1 / 3)]),
        np.array([1 / 20] * 3 + [2 / 15] * 3 + [9 / 20]),
    ),
}
# Triangles between the nodes of one.
INSIDE = {
    NodeLayout.CENTRES: np.zeros((0, 3), np.int64),
    NodeLayout.VERTICES: np.array([[0, 1, 2]]),
    NodeLayout.LOBATTO: np.array(
        [[6, 0, 5], [6, 5, 1], [6, 1, 3], [6, 3, 2], [6, 2, 4], [6, 4, 0]]
    ),
}


class FlatNodes(NamedTuple):
    """Nodes of a face: ``places`` along its tangents (m), (K, 2), and ``areas`` (m2), (K,).

    ``triangles`` between them, (T, 3), with ``parts`` of the area of the face (m2), (T,).
    """

    places: Floats
    areas: Floats
    triangles: Integers
    parts: Floats


@dataclass(frozen=True, eq=False)
class Polygon(Face):
    """A face with an ``outline`` along its tangents (m), from its ``middle``, the centroid."""

    axes: Floats
    middle: Vector
    outline: shapely.Polygon

    @property
    def area(self) -> float:
        """In m2."""
        return float(self.outline.area)

    @property
    def corners(self) -> Floats:
        """Corners of the outer boundary, in m, (K, 3)."""
        return self.at(shapely.get_coordinates(self.outline.exterior)[:-1])

    def at(self, flat: Floats) -> Floats:
        """Points in space, (K, 3) in m, of points along the tangents, (K, 2) in m."""
        return np.asarray(self.middle + flat @ self.axes[1:])

    def nodes(self, mesh: float, layout: NodeLayout, divided: int = 1) -> FlatNodes:
        """Its nodes.

        Cells no longer than ``mesh`` (m), each side of which is ``divided`` into that many.
        """
        return outline_nodes(self.outline, mesh, layout, divided)


@dataclass(frozen=True, eq=False)
class ResultantLimits:
    """Limits of the shear V across locks (N) and the torque M (N m) about the middle of a face.

    ``shear`` V + ``torque`` M <= 1: coefficients in 1/N and 1/(N m), (K,). V is positive where the
    block above is pushed along the row of locks, from the first one on. The limits hold where the
    face is compressed by ``compression`` (N) at least.
    """

    shear: Floats
    torque: Floats
    compression: float = 0.0


@dataclass(frozen=True, eq=False)
class CondensedLocks(Polygon):
    """A face whose locks are condensed into contact points: its nodes.

    The tangents are along the locks and across them. ``places`` along these (m), (K, 2), and
    ``areas`` (m2), (K,): of the points. ``limits``: of the resultant of their forces, if any.
    """

    places: Floats
    areas: Floats
    limits: ResultantLimits | None = None

    def nodes(self, mesh: float, layout: NodeLayout, divided: int = 1) -> FlatNodes:
        """The contact points, whatever the mesh."""
        return FlatNodes(self.places, self.areas, INSIDE[NodeLayout.CENTRES], np.zeros(0))


def polygon_nodes(
    faces: tuple[Polygon, ...],
    mesh: float,
    layout: NodeLayout,
    divided: int = 1,
    *,
    pressed: bool = False,
) -> Nodes:
    """Nodes of ``layout`` on cells of ``faces`` no longer than ``mesh`` (m, may be infinite).

    Each side of these cells is ``divided`` into that many. ``pressed``: whether pressure on dry
    faces is integrated over triangles, rather than concentrated at the nodes.
    """
    flat = [face.nodes(mesh, layout, divided) for face in faces]
    counts = [len(each.areas) for each in flat]
    places = [face.at(each.places) for face, each in zip(faces, flat, strict=True)]
    dry = [None if pressed and face.kind is Kind.DRY else 0 for face in faces]
    used = [*zip(flat, np.cumsum([0, *counts[:-1]]).tolist(), dry, strict=True)]
    return Nodes(
        np.repeat(np.arange(len(faces)), counts),
        np.concatenate(places),
        np.concatenate([each.areas for each in flat]),
        np.concatenate([each.triangles[:count] + n for each, n, count in used]),
        np.concatenate([each.parts[:count] for each, _, count in used]),
    )


def outline_nodes(
    outline: shapely.Polygon, mesh: float, layout: NodeLayout, divided: int = 1
) -> FlatNodes:
    """The nodes on an outline; see `Polygon.nodes`."""
    corners = shapely.get_coordinates(outline.exterior)[:-1]
    size = float(np.ptp(corners, axis=0).max())
    convex = outline.convex_hull.area - outline.area <= CLOSE * size**2
    if convex and len(corners) == 4 and _right_angled(corners):
        return _on_rectangle(corners, mesh, layout, divided)
    if convex:
        middle = np.broadcast_to(shapely.get_coordinates(outline.centroid), corners.shape)
        triangles = np.stack([middle, corners, np.roll(corners, -1, axis=0)], axis=1)
    else:
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(outline))
        triangles = np.array([shapely.get_coordinates(part)[:3] for part in parts])
    longest = np.hypot(*(triangles - np.roll(triangles, 1, axis=1)).T).max()
    cells = divided * int(cells_along(longest, mesh))
    if convex and cells == 1 and layout is NodeLayout.VERTICES:
        # Half of the triangles at either side, which balances about the centroid.
        areas = _areas(triangles)
        fans = _fans(len(corners))
        of_fans = _areas(corners[fans]) / len(corners)
        return FlatNodes(corners, np.asarray((areas + np.roll(areas, 1)) / 2.0), fans, of_fans)
    places, weights = TRIANGLE_RULES[layout]
    pieces = _divided(triangles, cells)
    points = np.einsum("nk,tkx->tnx", places, pieces)
    areas, inside = _areas(pieces), INSIDE[layout]
    found, same = _merged(points.reshape(-1, 2), size)
    share = np.asarray(np.bincount(same, (areas[:, None] * weights).ravel()), float)
    between = same.reshape(points.shape[:2])[:, inside].reshape(-1, 3)
    return FlatNodes(found, share, between, np.repeat(areas / max(len(inside), 1), len(inside)))


def _fans(count: int) -> Integers:
    """Triangles that fill a convex polygon of ``count`` corners, once from each corner."""
    fans = [(i, i + k, i + k + 1) for i in range(count) for k in range(1, count - 1)]
    return np.array(fans, np.int64) % count


def _right_angled(corners: Floats) -> bool:
    sides = np.roll(corners, -1, axis=0) - corners
    across = np.abs(np.sum(sides * np.roll(sides, -1, axis=0), axis=1))
    return bool(across.max() <= CLOSE * np.square(sides).sum())


def _on_rectangle(corners: Floats, mesh: float, layout: NodeLayout, divided: int) -> FlatNodes:
    first, second = corners[1] - corners[0], corners[3] - corners[0]
    lengths = np.hypot(*np.array([first, second]).T)
    counts = divided * cells_along(lengths, mesh)
    (p, wp), (q, wq) = (side_rule(layout, count) for count in counts.tolist())
    places = corners[0] + p[:, None, None] * first + q[:, None] * second
    area, number = math.prod(lengths.tolist()), np.arange(len(p) * len(q)).reshape(len(p), -1)
    one, two, three, four = (
        number[i : len(p) - 1 + i, j : len(q) - 1 + j].ravel()
        for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    cut = [(one, two, three), (one, three, four), (one, two, four), (two, three, four)]
    cells = area / 4.0 * np.outer(np.diff(p), np.diff(q)).ravel()
    return FlatNodes(
        places.reshape(-1, 2),
        np.asarray(area * np.outer(wp, wq).ravel(), float),
        np.stack([np.column_stack(each) for each in cut], axis=1).reshape(-1, 3).astype(np.int64),
        np.repeat(cells, len(cut)),
    )


def _areas(triangles: Floats) -> Floats:
    (ax, ay), (bx, by) = (triangles[:, k].T - triangles[:, 0].T for k in (1, 2))
    return np.asarray(np.abs(ax * by - ay * bx) / 2.0)


def _divided(triangles: Floats, cells: int) -> Floats:
    """Equal ones that fill ``triangles``, (T, 3, 2): (T cells ** 2, 3, 2)."""
    steps = [[(i, j), (i + 1, j), (i, j + 1)] for i in range(cells) for j in range(cells - i)]
    steps += [
        [(i + 1, j + 1), (i, j + 1), (i + 1, j)] for i in range(cells) for j in range(cells - i - 1)
    ]
    origin, along, across = (triangles[:, None, None, k] for k in range(3))
    i, j = np.array(steps, float)[..., None].transpose(2, 0, 1, 3)
    divided = origin + i * ((along - origin) / cells) + j * ((across - origin) / cells)
    return np.asarray(divided.reshape(-1, 3, 2))


def _merged(points: Floats, size: float) -> tuple[Floats, Integers]:
    """Points at the same place as one, and the number of that of each."""
    _, first, same = np.unique(
        np.round(points / (CLOSE * size)), axis=0, return_index=True, return_inverse=True
    )
    return points[first], np.asarray(same.ravel(), np.int64)


def hull_sides(points: Floats) -> tuple[Floats, Floats]:
    """The sides of the convex hull of ``points``, (K, 2) in m.

    Their unit normals, outwards, (M, 2), and their distances from the origin along these (m), (M,).
    """
    hull = shapely.orient_polygons(shapely.MultiPoint(points).convex_hull)
    outline = shapely.get_coordinates(hull.exterior)
    along = np.diff(outline, axis=0)
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    return outward, (outward * outline[:-1]).sum(axis=1)
