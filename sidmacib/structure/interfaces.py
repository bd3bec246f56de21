"""Interfaces: where faces of two blocks lie in one plane and overlap."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import shapely
from scipy.spatial import cKDTree

from sidmacib.mechanics.assembly import Floats, Vector
from sidmacib.structure.blocks import Block, normal_of
from sidmacib.structure.overlaps import require_apart

NEAR = 1e-6  # over the mean size of the blocks: how far faces in one plane may be apart


@dataclass(frozen=True, eq=False)
class Interface:
    """A region in which two blocks touch.

    ``below`` and ``above``: indices of the blocks; ``axes``: the unit normal from ``below`` to
    ``above``, then two tangents, (3, 3); ``outline``: the region in coordinates (m) along the
    tangents from ``middle`` (m), its centroid.
    """

    below: int
    above: int
    axes: Floats
    middle: Vector
    outline: shapely.Polygon


@dataclass(frozen=True, eq=False)
class _Side:
    """A face of a block: its corners (m), unit normal, and distance from the origin along it."""

    block: int
    corners: Floats
    normal: Floats
    offset: float


def interfaces(blocks: Sequence[Block], near: float = NEAR) -> tuple[Interface, ...]:
    """All regions in which ``blocks`` touch, in the order of the blocks.

    ``near``: how far two faces in one plane may be apart, over the mean size of the free blocks.
    A pair of fixed blocks has none. ValueError, with their names, for blocks that overlap by more,
    and for a free block that touches nothing.
    """
    require_apart(blocks, near * mean_size(blocks))
    found = touching(blocks, near)
    touched = {end for each in found for end in (each.below, each.above)}
    for number, block in enumerate(blocks):
        if not block.fixed and number not in touched:
            raise ValueError(
                f"{block.name}: touches no other block; a gap may be at most "
                f"{near * mean_size(blocks):g} m (tolerance {near:g} of the blocks' mean size)"
            )
    _require_once(blocks, found, near * mean_size(blocks))
    return found


def _require_once(blocks: Sequence[Block], found: Sequence[Interface], near: float) -> None:
    """ValueError, with their names, for fixed blocks that overlap where one block touches both."""
    on_fixed: dict[int, list[tuple[int, Interface]]] = {}
    for each in found:
        for free, held in ((each.below, each.above), (each.above, each.below)):
            if blocks[held].fixed:
                on_fixed.setdefault(free, []).append((held, each))
    for free, regions in on_fixed.items():
        for (one, region), (other, later) in combinations(regions, 2):
            if one != other and _shared(region, later, near):
                raise ValueError(
                    f"blocks: {blocks[one].name} and {blocks[other].name}, which are fixed, "
                    f"overlap where {blocks[free].name} touches both"
                )


def _shared(one: Interface, other: Interface, near: float) -> bool:
    """Whether two interfaces lie in one plane and have more than an edge in common."""
    flat = shapely.get_coordinates(other.outline) @ other.axes[1:] + other.middle - one.middle
    if np.abs(flat @ one.axes[0]).max() > 2.0 * near:
        return False
    outline = shapely.Polygon(flat @ one.axes[1:].T)
    return bool(common(one.outline, outline, near).area > near * outline.length)


def touching(blocks: Sequence[Block], near: float = NEAR) -> tuple[Interface, ...]:
    """`interfaces`, whether or not every block touches another."""
    size = mean_size(blocks)
    return tuple(
        sorted(
            _touching(blocks, size, near * size),
            key=lambda each: (each.below, each.above, each.middle),
        )
    )


def mean_size(blocks: Sequence[Block]) -> float:
    """Mean size of the free ``blocks``, in m; of all if none is free.

    Without the fixed ones, as the ground may be drawn as large as one likes.
    """
    free = [block.size for block in blocks if not block.fixed]
    return float(np.mean(free or [block.size for block in blocks]))


def joined(found: Sequence[Interface], pieces: Sequence[int], near: float) -> tuple[Interface, ...]:
    """Interfaces between pieces from ``found`` ones between the solids that these consist of.

    ``pieces``: index of each solid's piece. Regions of two pieces that lie in one plane and share
    an edge become one; ``near`` in m.
    """
    regions: dict[tuple[int, int], list[Interface]] = {}
    for each in found:
        below, above = pieces[each.below], pieces[each.above]
        if below != above:
            regions.setdefault((below, above), []).append(replace(each, below=below, above=above))
    return tuple(
        sorted(
            (whole for same in regions.values() for whole in _whole(same, near)),
            key=lambda each: (each.below, each.above, each.middle),
        )
    )


def _whole(parts: list[Interface], near: float) -> Iterator[Interface]:
    """``parts`` of the interfaces of two pieces, put together where they share an edge."""
    planes: list[list[Interface]] = []
    for part in parts:
        for plane in planes:
            apart = (np.array(part.middle) - plane[0].middle) @ plane[0].axes[0]
            if abs(apart) <= near and np.allclose(part.axes[0], plane[0].axes[0], atol=1e-6):
                plane.append(part)
                break
        else:
            planes.append([part])
    for plane in planes:
        if len(plane) == 1:
            yield plane[0]
            continue
        axes, middle = plane[0].axes, np.array(plane[0].middle)
        outlines: list[shapely.Polygon] = []
        for part in plane:
            corners = shapely.get_coordinates(part.outline) @ part.axes[1:] + part.middle - middle
            outline = shapely.Polygon(corners @ axes[1:].T)
            for other in outlines:
                outline = shapely.snap(outline, other, near)
            outlines.append(outline)
        for region in shapely.get_parts(_united(outlines, near)):
            flat = shapely.get_coordinates(region.centroid)[0]
            x, y, z = middle + flat @ axes[1:]
            outline = shapely.affinity.translate(_plain(region, near), *(-flat))
            yield replace(plane[0], middle=(float(x), float(y), float(z)), outline=outline)


def _united(outlines: Sequence[shapely.Polygon], near: float) -> shapely.Geometry:
    """Outlines that do not overlap as one region; on a grid as `common`, if need be."""
    exact, area = shapely.union_all(outlines), math.fsum(each.area for each in outlines)
    if abs(exact.area - area) <= near * math.fsum(each.length for each in outlines):
        return exact
    return shapely.union_all(outlines, grid_size=near)


def _touching(blocks: Sequence[Block], size: float, near: float) -> Iterator[Interface]:
    centre = np.mean([block.places.mean(axis=0) for block in blocks], axis=0)
    sides = [
        _Side(
            number,
            corners - centre,
            normal := normal_of(corners - centre),
            float((corners - centre).mean(axis=0) @ normal),
        )
        for number, block in enumerate(blocks)
        for corners in block.outlines
    ]
    low = np.array([side.corners.min(axis=0) for side in sides]) - near
    high = np.array([side.corners.max(axis=0) for side in sides]) + near
    reach = float(np.abs([low, high]).max())
    # Planes as points: a normal that is off by an angle moves corners by it times the block's size.
    planes = np.array([[*(side.normal * size), side.offset] for side in sides])
    opposite = cKDTree(planes).query_ball_point(-planes, near * (1.0 + reach / size))
    for number, others in enumerate(opposite):
        one = sides[number]
        later = np.array([k for k in others if sides[k].block > one.block], dtype=int)
        boxes = (low[later] <= high[number]).all(axis=1) & (low[number] <= high[later]).all(axis=1)
        for other in later[boxes].tolist():
            if blocks[one.block].fixed and blocks[sides[other].block].fixed:
                continue
            yield from _overlap(one, sides[other], near, centre)


def _overlap(one: _Side, other: _Side, near: float, centre: Floats) -> Iterator[Interface]:
    if np.abs(other.corners @ one.normal - one.offset).max() > near:
        return
    axes = np.array([one.normal, *tangents(one.normal)])
    first, second = (shapely.Polygon(side.corners @ axes[1:].T) for side in (one, other))
    for part in shapely.get_parts(common(first, second, near)):
        if part.geom_type != "Polygon" or part.area <= near * part.length:  # a touching edge
            continue
        flat = shapely.get_coordinates(part.centroid)[0]
        outline = shapely.affinity.translate(_plain(part, near), *(-flat))
        x, y, z = centre + one.offset * one.normal + flat @ axes[1:]
        yield Interface(one.block, other.block, axes, (float(x), float(y), float(z)), outline)


def common(one: shapely.Polygon, other: shapely.Polygon, near: float) -> shapely.Geometry:
    """The region that two outlines share, to ``near`` (m).

    Where edges coincide but for rounding, GEOS (3.14) may return the whole of one outline for two
    that only share an edge. On a grid its overlay is robust; the exact one counts where both agree.
    """
    exact = shapely.intersection(one, other)
    robust = shapely.intersection(one, other, grid_size=near)
    agree = abs(exact.area - robust.area) <= near * (one.length + other.length)
    return exact if agree else robust


def _plain(part: shapely.Polygon, near: float) -> shapely.Polygon:
    """The region without corners on its straight sides, anticlockwise, the lowest corner first."""
    return shapely.normalize(shapely.remove_repeated_points(part.simplify(near), near)).reverse()


def tangents(normal: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors in a plane, the first as level as it can be; right-handed with ``normal``.

    For a normal along x, y or z they are the next two axes, as on the joint's faces.
    """
    largest = int(np.argmax(np.abs(normal)))
    first = np.eye(3)[(largest + 1) % 3]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)
