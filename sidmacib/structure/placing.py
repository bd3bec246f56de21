"""Order of placing: which block can be put where the others are, one by one.

Blocks that touch block each other's way (directional blocking graphs, Wilson & Latombe 1994,
doi:10.1016/0004-3702(94)90048-5). A block can be placed last if it can be taken away, by a
translation, however small. Without it no other block is blocked by more, so it does not matter
which of several is taken first: an order is found if there is one.

Not seen: blocks that would meet others on a longer way or would go in by a turn, blocks placed
together, and whether what stands so far holds; formwork is taken for granted.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

import numpy as np

from sidmacib.mechanics.assembly import Floats, Vector

CLEAR = 1e-3  # cosine that counts as a way into a block: faces of files are as skew
# Two blocks that touch, and unit vectors, (K, 3), along which the second, as seen from the first,
# must move by 0 or more.
Contact = tuple[int, int, Floats]


@dataclass(frozen=True)
class Order:
    """The order in which free blocks are placed, and the blocks that cannot be, by index.

    ``steps``: of each block the direction in which it moves to its place, a unit vector.
    """

    steps: Mapping[int, Vector]
    stuck: tuple[int, ...]


def placing_order(free: Mapping[int, float], contacts: Iterable[Contact]) -> Order:
    """An order of placing ``free`` blocks, of these heights of their centres (m).

    All other blocks are there before. Blocks are taken away from the highest down.
    """
    around: dict[int, list[tuple[int, Floats]]] = defaultdict(list)
    for one, other, walls in contacts:
        around[one].append((other, -walls))
        around[other].append((one, walls))
    waiting = [(-round(height, 9), block) for block, height in free.items()]
    heapify(waiting)
    stuck: dict[int, float] = {}
    taken: dict[int, Vector] = {}
    while waiting:
        rank, block = heappop(waiting)
        out = way_out([walls for other, walls in around[block] if other not in taken])
        if out is None:
            stuck[block] = rank
            continue
        taken[block] = (-out[0] + 0.0, -out[1] + 0.0, -out[2] + 0.0)
        for other in {other for other, _ in around[block]} & stuck.keys():
            heappush(waiting, (stuck.pop(other), other))
    return Order(dict(reversed(taken.items())), tuple(sorted(stuck)))


def way_out(walls: Iterable[Floats]) -> Vector | None:
    """A unit vector along which none of ``walls``, (K, 3) each, is entered; None if there is none.

    Of all that which leaves the walls that can be left by most, then the steepest.
    """
    sides = np.unique(np.round(np.concatenate([np.empty((0, 3)), *walls]), 9), axis=0)
    _, sizes, axes = np.linalg.svd(np.concatenate([np.zeros((1, 3)), sides]))
    along_all = axes[np.count_nonzero(sizes > CLEAR) :]
    # The edges of the cone of ways are in two walls each, or across a line that it contains.
    planes = np.concatenate([sides, along_all])
    one, other = np.triu_indices(len(planes), 1)
    edges = _units(np.cross(planes[one], planes[other]))
    ways = np.concatenate([edges, -edges])
    ways = ways[(ways @ sides.T >= -CLEAR).all(axis=1)]
    if not len(ways):
        return None
    inside = ways.sum(axis=0)  # a way, too, as they are a convex cone
    ways = np.concatenate([ways, _units(inside[None])])
    left = sides[sides @ ways[-1] > CLEAR]
    apart = np.round((ways @ left.T).min(axis=1, initial=1.0), 6)
    best = max(range(len(ways)), key=lambda k: (apart[k], round(ways[k, 2], 6), *ways[k, :2]))
    x, y, z = np.round(ways[best], 9).tolist()
    return x, y, z


def _units(vectors: Floats) -> Floats:
    """``vectors``, (K, 3), with length 1, without those that have none."""
    length = np.linalg.norm(vectors, axis=1)
    return np.asarray(vectors[length > CLEAR] / length[length > CLEAR, None])
