"""Whether blocks overlap: convex ones if no plane parts them, others by the volume they share."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import manifold3d
import numpy as np
import shapely

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.structure.blocks import Block, area_vector

WIDEST = 0.1  # largest tolerance, over the mean size of the blocks
MOST_SHARED = 0.5  # of a block's volume, as no tolerance is above half of the thinnest block
PARALLEL = 1e-6  # least length of the cross product of two unit vectors that gives a direction


@dataclass(frozen=True, eq=False)
class Placed:
    """A convex solid of a ``piece`` where the piece is placed; see `Block`."""

    piece: int
    fixed: bool
    places: Floats
    normals: Floats
    outlines: tuple[Floats, ...]


Solid = TypeVar("Solid", Block, Placed)


def deepest_overlap(blocks: Sequence[Block], near: float) -> tuple[float, str]:
    """The two ``blocks`` that overlap most, by more than ``near`` (m): how far (m), and in words.

    No words if none do. Pairs of fixed blocks may overlap. Blocks that are not convex overlap if
    the volume that they share is more than a layer of that thickness on the smaller one, or than
    half of that.
    """
    most, words, count = near, "", 0
    for one, other in candidates(blocks, near):
        if one.reentrant is None and other.reentrant is None:
            depth = overlap(one, other, near)
            amount = f"{depth:.3g} m"
        else:
            surface = min(_surface(one), _surface(other))
            volume = shared_volume(one, other, near * surface)
            depth, amount = volume / surface, f"{volume:.3g} m3"
            if volume > MOST_SHARED * min(one.volume, other.volume):
                depth = math.inf
        count += depth > near
        if depth > most:
            most, words = depth, f"{one.name} and {other.name} overlap by {amount}"
    if count > 1:
        words += f", the most of {count} pairs"
    return most, words


def tolerance_for(gap: float, size: float) -> float:
    """The tolerance, of one digit, that takes faces as touching which are ``gap`` (m) apart."""
    share = gap * (1.0 + 1e-9) / size
    digit = 10.0 ** math.floor(math.log10(share))
    return float(f"{math.ceil(share / digit) * digit:.1g}")


def shared_volume(one: Block, other: Block, most: float = 0.0) -> float:
    """The volume (m3) that two blocks share, convex or not; see `common_volume`."""
    middle, size = one.places.mean(axis=0), one.size
    first, second = (solid_of(block, middle, size) for block in (one, other))
    return common_volume(first, second, most / size**3) * size**3


def common_volume(one: manifold3d.Manifold, other: manifold3d.Manifold, most: float = 0.0) -> float:
    """The volume that two solids share, to rounding; another way if it is above ``most``.

    Where faces touch, Manifold (3.5) may find a part of a block in one order, none in the other.
    """
    for first, second in ((one, other), (other, one)):
        if (shared := float((first ^ second).volume())) <= most:
            return shared
    return min(shared, float(one.volume() + other.volume() - (one + other).volume()))


def solid_of(block: Block, middle: Floats, size: float) -> manifold3d.Manifold:
    """``block`` about ``middle`` (m), (3,), in units of ``size`` (m)."""
    triangles = []
    for face, corners, normal in zip(block.faces, block.outlines, block.normals, strict=True):
        along = corners[1] - corners[0]
        plane = np.column_stack([along, np.cross(normal, along)]) / np.linalg.norm(along)
        triangles.append(
            np.array(face)[manifold3d.triangulate([(corners - middle) @ plane / size])]
        )
    places = (block.places - middle) / size
    return manifold3d.Manifold(
        manifold3d.Mesh64(places, np.concatenate(triangles).astype(np.uint64))
    )


def _surface(block: Block) -> float:
    """Area of all faces, in m2."""
    around = [area_vector(corners) for corners in block.outlines]
    return float(np.linalg.norm(around, axis=1).sum()) / 2


def overlap(one: Solid, other: Solid, near: float = 0.0) -> float:
    """Depth (m) to which two convex blocks reach into each other; 0 or less if they do not.

    By separating axes: normals of faces and cross products of edges. The search ends at the first
    axis along which they overlap by ``near`` at most.
    """
    least = np.inf
    for axis in _axes(one, other):
        first, second = one.places @ axis, other.places @ axis
        depth = min(first.max() - second.min(), second.max() - first.min())
        least = min(least, float(depth))
        if least <= near:
            break
    return least


def candidates(blocks: Sequence[Solid], near: float) -> Iterator[tuple[Solid, Solid]]:
    """Pairs of blocks, one of them free, whose boxes overlap by more than ``near`` (m)."""
    if not blocks:
        return
    low = np.array([block.places.min(axis=0) for block in blocks])
    high = np.array([block.places.max(axis=0) for block in blocks])
    for one, other in meeting_boxes(low, high).tolist():
        depth = (np.minimum(high[one], high[other]) - np.maximum(low[one], low[other])).min()
        if depth > near and not (blocks[one].fixed and blocks[other].fixed):
            yield blocks[one], blocks[other]


def meeting_boxes(low: Floats, high: Floats) -> Integers:
    """Pairs of boxes that meet, (K, 2), in their order.

    ``low``, ``high``: their least and largest coordinates (m), (N, 3).
    """
    u, v = np.argsort(high.max(axis=0) - low.min(axis=0))[1:]  # the plane with the fewest overlaps
    boxes = shapely.box(low[:, u], low[:, v], high[:, u], high[:, v])
    one, other = shapely.STRtree(boxes).query(boxes)
    meet = (low[one] <= high[other]).all(axis=1) & (low[other] <= high[one]).all(axis=1)
    pairs = np.stack([one, other], axis=1)[meet & (one < other)]
    return np.asarray(pairs[np.lexsort(pairs.T[::-1])])


def _axes(one: Solid, other: Solid) -> Iterator[Floats]:
    yield from one.normals
    yield from other.normals
    across = np.cross(_edges(one)[:, None], _edges(other)[None]).reshape(-1, 3)
    length = np.linalg.norm(across, axis=1)
    yield from across[length > PARALLEL] / length[length > PARALLEL][:, None]


def _edges(block: Block | Placed) -> Floats:
    """Directions of the edges, each once, (E, 3)."""
    along = np.concatenate([np.roll(c, -1, axis=0) - c for c in block.outlines])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    along *= np.where(along[np.arange(len(along)), np.abs(along).argmax(axis=1)] < 0, -1.0, 1.0)[
        :, None
    ]
    return np.unique(np.round(along, 9), axis=0)
