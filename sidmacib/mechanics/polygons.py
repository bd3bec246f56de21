"""Faces of any outline, and contact nodes on them.

A rectangle has the nodes of the joint's faces, in either direction. A convex outline is cut into
triangles around its centroid, any other by a constrained Delaunay triangulation; each triangle is
divided into equal ones no longer than the mesh.
"""

import math
from dataclasses import dataclass

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Face, Floats, NodeLayout, Nodes, Vector
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

    def nodes(self, mesh: float, layout: NodeLayout, divided: int = 1) -> tuple[Floats, Floats]:
        """Places along the tangents (m), (K, 2), and areas (m2), (K,), of its nodes.

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

    def nodes(self, mesh: float, layout: NodeLayout, divided: int = 1) -> tuple[Floats, Floats]:
        """The contact points, whatever the mesh."""
        return self.places, self.areas


def polygon_nodes(
    faces: tuple[Polygon, ...], mesh: float, layout: NodeLayout, divided: int = 1
) -> Nodes:
    """Nodes of ``layout`` on cells of ``faces`` no longer than ``mesh`` (m, may be infinite).

    Each side of these cells is ``divided`` into that many.
    """
    flat = [face.nodes(mesh, layout, divided) for face in faces]
    index = np.repeat(np.arange(len(faces)), [len(area) for _, area in flat])
    places = [face.at(place) for face, (place, _) in zip(faces, flat, strict=True)]
    return Nodes(index, np.concatenate(places), np.concatenate([area for _, area in flat]))


def outline_nodes(
    outline: shapely.Polygon, mesh: float, layout: NodeLayout, divided: int = 1
) -> tuple[Floats, Floats]:
    """Places (m), (K, 2), and areas (m2), (K,), of the nodes on an outline; see `Polygon.nodes`."""
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
        return corners, (areas + np.roll(areas, 1)) / 2.0
    places, weights = TRIANGLE_RULES[layout]
    pieces = _divided(triangles, cells)
    points = np.einsum("nk,tkx->tnx", places, pieces).reshape(-1, 2)
    return _merged(points, (_areas(pieces)[:, None] * weights).ravel(), size)


def _right_angled(corners: Floats) -> bool:
    sides = np.roll(corners, -1, axis=0) - corners
    across = np.abs(np.sum(sides * np.roll(sides, -1, axis=0), axis=1))
    return bool(across.max() <= CLOSE * np.square(sides).sum())


def _on_rectangle(
    corners: Floats, mesh: float, layout: NodeLayout, divided: int
) -> tuple[Floats, Floats]:
    first, second = corners[1] - corners[0], corners[3] - corners[0]
    lengths = np.hypot(*np.array([first, second]).T)
    counts = divided * cells_along(lengths, mesh)
    (p, wp), (q, wq) = (side_rule(layout, count) for count in counts.tolist())
    places = corners[0] + p[:, None, None] * first + q[:, None] * second
    return places.reshape(-1, 2), math.prod(lengths.tolist()) * np.outer(wp, wq).ravel()


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


def _merged(points: Floats, areas: Floats, size: float) -> tuple[Floats, Floats]:
    """Points at the same place as one, with the sum of their areas."""
    _, first, same = np.unique(
        np.round(points / (CLOSE * size)), axis=0, return_index=True, return_inverse=True
    )
    return points[first], np.asarray(np.bincount(same.ravel(), areas), float)


def hull_sides(points: Floats) -> tuple[Floats, Floats]:
    """The sides of the convex hull of ``points``, (K, 2) in m.

    Their unit normals, outwards, (M, 2), and their distances from the origin along these (m), (M,).
    """
    hull = shapely.orient_polygons(shapely.MultiPoint(points).convex_hull)
    outline = shapely.get_coordinates(hull.exterior)
    along = np.diff(outline, axis=0)
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    return outward, (outward * outline[:-1]).sum(axis=1)
