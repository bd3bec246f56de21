"""Interfaces: where faces of two blocks lie in one plane and overlap."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats, Vector
from sidmacib.structure.blocks import Block, normal_of, vectors
from sidmacib.structure.overlaps import WIDEST, deepest_overlap, meeting_boxes, tolerance_for
from sidmacib.validation import refused

NEAR = 1e-6  # over the mean size of the blocks: how far faces in one plane may be apart
EDGE = 1e-3  # likewise, at the most: regions that are narrower are edges
LEAST = 1e-3  # over the square of the blocks' mean size: less area does not matter
STEP = 3.0  # times a gap: a larger one is meant
ALONG = 0.9  # least cosine between the normals of faces that touch
KEPT = 12  # digits of the size of an interface


@dataclass(frozen=True, eq=False)
class Interface:
    """A region in which two blocks touch.

    ``below`` and ``above``: indices of the blocks; ``axes``: the unit normal from ``below`` to
    ``above``, then two tangents, (3, 3); ``outline``: the region in coordinates (m) along the
    tangents from ``middle`` (m), its centroid; anticlockwise.
    """

    below: int
    above: int
    axes: Floats
    middle: Vector
    outline: shapely.Polygon

    def pair(self, blocks: Sequence[Block]) -> frozenset[str]:
        """The names of the two of all ``blocks``."""
        return frozenset((blocks[self.below].name, blocks[self.above].name))

    @classmethod
    def of(
        cls,
        ends: tuple[int, int],
        axes: Floats,
        origin: Floats,
        region: shapely.Polygon,
        outline: shapely.Polygon,
    ) -> "Interface":
        """The interface of two blocks in a ``region`` along the tangents from ``origin`` (m).

        ``outline``: the same, perhaps with fewer corners. Last digits, which differ between
        processors, are rounded off.
        """
        flat = shapely.get_coordinates(region.centroid)[0]
        decimals = KEPT - math.ceil(math.log10(outline.length))
        (middle,) = vectors((origin + flat @ axes[1:]).round(decimals)[None])
        outline = shapely.transform(outline, lambda corners: (corners - flat).round(decimals))
        return cls(*ends, axes, middle, outline)


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
    if near > EDGE and near > (most := most_near(blocks)):
        raise refused("tolerance", near, f"at most {_down(most)}, half the thinnest block")
    depth, words = deepest_overlap(blocks, near * mean_size(blocks))
    if words:
        if wide := proposed(blocks, depth):
            words += f"; to accept this, set tolerance: {wide}"
        raise ValueError(f"blocks: {words}")
    found = touching(blocks, near)
    touched = {end for each in found for end in (each.below, each.above)}
    for number, block in enumerate(blocks):
        if not block.fixed and number not in touched:
            raise ValueError(f"{block.name}: touches no other block; {_nearest(blocks, number)}")
    _require_once(blocks, found, near * mean_size(blocks))
    return found


def _nearest(blocks: Sequence[Block], number: int) -> str:
    """How far the faces are that are nearest to a block's, and the tolerance that takes them."""
    every = close(blocks, most_near(blocks) * mean_size(blocks))
    gaps = [abs(gap) for gap, each in every if number in (each.below, each.above)]
    if not gaps:
        return "no face that looks at one of its own is near"
    gap = min(gaps)
    wide = proposed(blocks, gap)
    return f"the nearest is {gap:.2g} m away; to accept the gap, set tolerance: {wide}"


def proposed(blocks: Sequence[Block], gap: float) -> float | None:
    """The tolerance that takes a ``gap`` (m), and all that are of its kind; None if none does."""
    size, most = mean_size(blocks), max(EDGE, most_near(blocks))
    if gap > most * size:
        return None
    gaps = [
        abs(apart)
        for apart, each in close(blocks, most * size)
        if abs(apart) > gap and each.outline.area > LEAST * size**2
    ]
    return min(tolerance_for(next_step([gap, *sorted(gaps)]), size), _down(most))


def next_step(gaps: Sequence[float]) -> float:
    """The last of sorted ``gaps`` before one that is several times as large."""
    return next((gap for gap, after in pairwise(gaps) if after > STEP * gap), gaps[-1])


def _down(value: float) -> float:
    """A positive ``value``, rounded down to two digits."""
    digit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / digit) * digit:.2g}")


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
                names = f"{blocks[one].name} and {blocks[other].name}"
                where = f"which are fixed, overlap where {blocks[free].name} touches both"
                raise ValueError(f"blocks: {names}, {where}")


def _shared(one: Interface, other: Interface, near: float) -> bool:
    """Whether two interfaces lie in one plane and have more than an edge in common."""
    flat = shapely.get_coordinates(other.outline) @ other.axes[1:] + other.middle - one.middle
    if np.abs(flat @ one.axes[0]).max() > 2.0 * near:
        return False
    outline = shapely.Polygon(flat @ one.axes[1:].T)
    return bool(common(one.outline, outline, near).area > near * outline.length)


def touching(blocks: Sequence[Block], near: float = NEAR) -> tuple[Interface, ...]:
    """`interfaces`, whether or not every block touches another."""
    return tuple(each for _, each in close(blocks, near * mean_size(blocks)))


def most_near(blocks: Sequence[Block]) -> float:
    """The largest tolerance at which no face meets another through a block, at most `WIDEST`."""
    thin = min(float(np.ptp(block.places @ block.normals.T, axis=0).min()) for block in blocks)
    return min(WIDEST, thin / 2.0 / mean_size(blocks))


def mean_size(blocks: Sequence[Block]) -> float:
    """Mean size of the free ``blocks``, in m; of all if none is free.

    Without the fixed ones, as the ground may be drawn as large as one likes.
    """
    free = [block.size for block in blocks if not block.fixed]
    return float(np.mean(free or [block.size for block in blocks]))


def in_order(found: Iterable[Interface]) -> tuple[Interface, ...]:
    """Interfaces in the order of their blocks, then of their places."""
    return tuple(sorted(found, key=lambda each: (each.below, each.above, each.middle)))


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
    return in_order(whole for same in regions.values() for whole in _whole(same, near))


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
        first, axes, middle = plane[0], plane[0].axes, np.array(plane[0].middle)
        outlines: list[shapely.Polygon] = []
        for part in plane:
            corners = shapely.get_coordinates(part.outline) @ part.axes[1:] + part.middle - middle
            outline = shapely.Polygon(corners @ axes[1:].T)
            for other in outlines:
                outline = shapely.snap(outline, other, near)
            outlines.append(outline)
        for region in shapely.get_parts(_united(outlines, near)):
            ends = first.below, first.above
            yield Interface.of(ends, axes, middle, region, _plain(region, near))


def _united(outlines: Sequence[shapely.Polygon], near: float) -> shapely.Geometry:
    """Outlines that do not overlap as one region; on a grid as `common`, if need be."""
    exact, area = shapely.union_all(outlines), math.fsum(each.area for each in outlines)
    if abs(exact.area - area) <= near * math.fsum(each.length for each in outlines):
        return exact
    return shapely.union_all(outlines, grid_size=near)


def close(blocks: Sequence[Block], near: float) -> list[tuple[float, Interface]]:
    """Regions in which faces of two ``blocks`` are ``near`` (m) or nearer, with their distance.

    That is the largest within the region (m), negative where blocks overlap. Not of two fixed ones.
    """
    size = mean_size(blocks)
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
    low = np.array([side.corners.min(axis=0) for side in sides]) - near / 2.0
    high = np.array([side.corners.max(axis=0) for side in sides]) + near / 2.0
    one, other = (pairs := meeting_boxes(low, high)).T
    block = np.array([side.block for side in sides])
    normal, held = np.array([side.normal for side in sides]), np.array([b.fixed for b in blocks])
    facing = (block[one] < block[other]) & ~(held[block[one]] & held[block[other]])
    facing &= np.einsum("ij,ij->i", normal[one], normal[other]) < -ALONG
    found: list[tuple[float, Interface]] = []
    for here, there in pairs[facing].tolist():
        found += _overlap(sides[here], sides[there], near, min(near, EDGE * size), centre)
    return sorted(found, key=lambda each: (each[1].below, each[1].above, each[1].middle))


def _overlap(
    one: _Side, other: _Side, near: float, edge: float, centre: Floats
) -> Iterator[tuple[float, Interface]]:
    along = float(one.normal @ other.normal)
    apart = other.corners @ one.normal - one.offset
    if apart.min() > near or apart.max() < -near:
        return
    axes = np.array([one.normal, *tangents(one.normal)])
    first, second = (shapely.Polygon(side.corners @ axes[1:].T) for side in (one, other))
    for part in shapely.get_parts(common(first, second, edge)):
        if part.geom_type != "Polygon" or part.area <= edge * part.length:  # a touching edge
            continue
        on_one = shapely.get_coordinates(part) @ axes[1:] + one.offset * one.normal
        gaps = (other.offset - on_one @ other.normal) / along
        gap = float(gaps[np.abs(gaps).argmax()])
        if abs(gap) > near:
            continue
        ends, origin = (one.block, other.block), centre + one.offset * one.normal
        yield gap, Interface.of(ends, axes, origin, part, _plain(part, edge))


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


def triangles(region: shapely.Polygon, corners: Floats) -> Iterator[list[int]]:
    """Triangles that fill a plane ``region``, as numbers of its ``corners``, (K, 2)."""
    near = CLOSE * float(np.ptp(corners, axis=0).max())
    for part in shapely.get_parts(shapely.constrained_delaunay_triangles(region)):
        places = shapely.get_coordinates(part)[:3]
        apart = np.abs(corners[None, :, :] - places[:, None, :]).max(axis=2)
        numbers = apart.argmin(axis=1).tolist()
        assert float(apart.min(axis=1).max()) <= near
        yield numbers
