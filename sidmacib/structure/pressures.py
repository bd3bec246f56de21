"""Permanent pressures on the sides of blocks that touch nothing.

A face counts as far as no interface covers it. Pressures vary linearly, and forces and moments on
each region are integrated exactly.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Assembly, Floats, NodeLayout, Vector
from sidmacib.mechanics.polygons import Polygon, outline_nodes
from sidmacib.structure.blocks import Compound, solids_of
from sidmacib.structure.interfaces import ALONG, NEAR, tangents, touching
from sidmacib.structure.loads import Permanent
from sidmacib.validation import refused

LEAST = 1e-9  # of a face's area: smaller regions carry nothing
Bounds = Mapping[int, tuple[float, float]]  # least and largest coordinate (m) by axis


def pressing(
    assembly: Assembly,
    blocks: Sequence[str],
    side: Vector,
    within: float,
    bounds: Bounds,
    pressure: Callable[[Floats], Floats],
    along: Floats | None = None,
    near: float = NEAR,
) -> Permanent:
    """Loads by a ``pressure`` (Pa), a linear function of points, (K, 3) in m, on sides of blocks.

    They are free blocks whose names fit one of the patterns ``blocks``, and faces whose outward
    normal is within an angle ``within`` (degrees) of ``side``, as far as coordinates are in
    ``bounds``. At 90 degrees: all faces that look that way at all.
    It pushes against each face, or acts in the direction ``along``, of length 1, on the area
    projected onto the plane across it. ``near``: tolerance of interfaces, as in `structure`.
    ValueError if no side of a free block is there.
    """
    pieces = assembly.pieces
    free = [number for number, piece in enumerate(pieces) if not piece.fixed]
    chosen = [n for n in free if any(fnmatchcase(pieces[n].name, each) for each in blocks)]
    if not chosen:
        allowed = f"names of free blocks, such as {pieces[free[0]].name}"
        raise refused("blocks", " ".join(blocks), allowed)
    outward = np.array(side) / np.linalg.norm(side)
    least = max(math.cos(math.radians(within)) - CLOSE, 1e-6)
    found = Permanent.none(len(pieces))
    area = 0.0
    for number in chosen:
        piece = pieces[number]
        covers = _covers(assembly, number, near)
        for solid in solids_of(piece):
            for corners, normal in zip(solid.outlines, solid.normals, strict=True):
                if float(normal @ outward) <= least:
                    continue
                points, areas = _exposed(corners, normal, covers, bounds, near * solid.size)
                area += float(areas.sum())
                way = -normal if along is None else along * abs(float(normal @ along))
                forces = (pressure(points) * areas)[:, None] * way
                found += Permanent.of(len(pieces), number, points - piece.centre, forces)
    if not area > 0.0:
        raise ValueError(
            f"no free face of these blocks looks that way there, within {within:g} degrees"
        )
    return found


def _covers(assembly: Assembly, number: int, near: float) -> list[tuple[Floats, Floats]]:
    """Outward normals, and outlines in space (m), (K, 3), of what covers a piece's faces."""
    found = []
    for face in assembly.faces:
        if isinstance(face, Polygon) and number in (face.below, face.above):
            sign = 1.0 if face.below == number else -1.0
            found.append((sign * face.axes[0], face.corners))
    piece = assembly.pieces[number]
    if isinstance(piece, Compound):
        for each in touching(piece.solids, near):
            corners = each.middle + shapely.get_coordinates(each.outline)[:-1] @ each.axes[1:]
            found += [(sign * each.axes[0], corners) for sign in (1.0, -1.0)]
    return found


def _exposed(
    corners: Floats,
    normal: Floats,
    covers: Sequence[tuple[Floats, Floats]],
    bounds: Bounds,
    near: float,
) -> tuple[Floats, Floats]:
    """Points (m), (K, 3), and areas (m2), (K,), of what is in ``bounds`` and not covered."""
    origin, axes = corners[0], np.array(tangents(normal))
    region: shapely.Geometry = shapely.Polygon((corners - origin) @ axes.T)
    size = float(np.ptp(corners, axis=0).max())
    least = LEAST * region.area
    for other, outline in covers:
        apart = np.abs((outline - origin) @ normal).max()
        if other @ normal > ALONG and apart <= 2.0 * near + CLOSE * size:
            cover = shapely.Polygon((outline - origin) @ axes.T)
            region = region.difference(cover, grid_size=CLOSE * size)
    for axis, limits in bounds.items():
        for sign, limit in zip((-1.0, 1.0), limits, strict=True):
            # sign (x - limit) <= 0 for the coordinate x along the axis.
            region = _cut(region, sign * axes[:, axis], sign * (limit - origin[axis]))
    points, areas = [np.empty((0, 3))], [np.empty(0)]
    for part in shapely.get_parts(region):
        if part.geom_type == "Polygon" and part.area > least:
            flat, of = outline_nodes(part, math.inf, NodeLayout.LOBATTO)[:2]
            points.append(origin + flat @ axes)
            areas.append(of)
    return np.concatenate(points), np.concatenate(areas)


def _cut(region: shapely.Geometry, way: Floats, most: float) -> shapely.Geometry:
    """The part of a plane ``region`` where a point's ``way``, (2,), is at most ``most`` (m)."""
    length = float(np.linalg.norm(way))
    if length < CLOSE:
        return region if most >= 0.0 else shapely.Polygon()
    if region.is_empty or most == math.inf:
        return region
    unit = way / length
    across = np.array([-unit[1], unit[0]])
    reach = 2.0 * float(np.abs(shapely.get_coordinates(region)).max()) + abs(most / length)
    edge = unit * (most / length)
    half = [edge - reach * across, edge + reach * across]
    corners = [*half, *(each - 4.0 * reach * unit for each in half[::-1])]
    return region.intersection(shapely.Polygon(corners))
