"""Whether blocks overlap: convex ones that no plane parts."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.spatial import cKDTree

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import Block

PARALLEL = 1e-6  # least length of the cross product of two unit vectors that gives a direction


def require_apart(blocks: Sequence[Block], near: float) -> None:
    """ValueError, with their names, for two convex blocks that overlap by more than ``near`` (m).

    Pairs of fixed blocks may overlap. Blocks that are not convex are not looked at.
    """
    for one, other in _candidates(blocks, near):
        depth = overlap(one, other, near)
        if depth > near:
            raise ValueError(f"blocks: {one.name} and {other.name} overlap by {depth:.3g} m")


def overlap(one: Block, other: Block, near: float = 0.0) -> float:
    """How far two convex blocks reach into each other, in m; 0 or less if they do not.

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


def _candidates(blocks: Sequence[Block], near: float) -> Iterator[tuple[Block, Block]]:
    """Pairs of convex blocks, one of them free, whose boxes overlap."""
    low = np.array([block.places.min(axis=0) for block in blocks])
    high = np.array([block.places.max(axis=0) for block in blocks])
    middle, reach = (low + high) / 2, np.linalg.norm(high - low, axis=1) / 2
    convex = [block.reentrant is None for block in blocks]
    usual = float(np.median(reach))
    large = set(np.flatnonzero(reach > 2 * usual).tolist())  # few, such as the ground
    tree = cKDTree(middle)
    for number, others in enumerate(tree.query_ball_point(middle, reach + 2 * usual)):
        for other in sorted(large.union(others)):
            small = other not in large or number in large
            pair = number < other if small else number != other
            if not pair or not (convex[number] and convex[other]):
                continue
            if blocks[number].fixed and blocks[other].fixed:
                continue
            inside = np.minimum(high[number], high[other]) - np.maximum(low[number], low[other])
            if inside.min() > near:
                yield blocks[number], blocks[other]


def _axes(one: Block, other: Block) -> Iterator[Floats]:
    yield from one.normals
    yield from other.normals
    across = np.cross(_edges(one)[:, None], _edges(other)[None]).reshape(-1, 3)
    length = np.linalg.norm(across, axis=1)
    yield from across[length > PARALLEL] / length[length > PARALLEL][:, None]


def _edges(block: Block) -> Floats:
    """Directions of the edges, each once, (E, 3)."""
    along = np.concatenate([np.roll(c, -1, axis=0) - c for c in block.outlines])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    along *= np.where(along[np.arange(len(along)), np.abs(along).argmax(axis=1)] < 0, -1.0, 1.0)[
        :, None
    ]
    return np.unique(np.round(along, 9), axis=0)
