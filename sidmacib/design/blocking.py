"""Order of placing: which block can be put where the others are, one by one.

Blocks that touch block each other's way (directional blocking graphs, Wilson & Latombe 1994,
doi:10.1016/0004-3702(94)90048-5): a block cannot move into another across an interface, and locks
let it move along them, or away from the interface, but not across them. A block can be placed last
if it can be taken away, by a translation, however small. Without it no other block is blocked by
more, so it does not matter which of several is taken first: an order is found if there is one.

Not seen: blocks that would meet others on a longer way, two blocks placed at once, and whether
what stands so far holds; formwork is taken for granted.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sidmacib.design.layouts import Layout
from sidmacib.design.model import Site
from sidmacib.mechanics.assembly import Assembly, Floats, Vector

CLEAR = 1e-7  # cosine that counts as a way into a block
Choice = Sequence[Layout | None]  # for each site


@dataclass(frozen=True)
class Step:
    """A block that is placed, and the direction in which it moves to its place, a unit vector."""

    block: int
    along: Vector


@dataclass(frozen=True)
class Order:
    """The steps in which free blocks are placed, and the blocks that cannot be, by index."""

    steps: tuple[Step, ...]
    stuck: tuple[int, ...]


def order_of(assembly: Assembly, sites: Sequence[Site], choice: Choice) -> Order:
    """An order of placing the blocks of an ``assembly`` with the rows of ``choice``.

    Fixed blocks are there before. Blocks are taken away from the highest down.
    """
    across = _across(assembly, sites, choice)
    left = {number for number, piece in enumerate(assembly.pieces) if not piece.fixed}
    fixed = set(range(len(assembly.pieces))) - left
    touching = _touching(assembly)
    taken: list[Step] = []
    ranked = sorted(left, key=lambda k: (-round(float(assembly.pieces[k].centre[2]), 9), k))
    while True:
        for block in ranked:
            here = left | fixed
            if block in left and (out := _way_out(assembly, across, touching, block, here)):
                left.remove(block)
                taken.append(Step(block, (-out[0] + 0.0, -out[1] + 0.0, -out[2] + 0.0)))
                break
        else:
            return Order(tuple(reversed(taken)), tuple(sorted(left)))


def conflict(
    assembly: Assembly, sites: Sequence[Site], choice: Choice
) -> frozenset[tuple[int, int]] | None:
    """Sites and directions of locks because of which some block cannot be placed.

    Without any one of them, the rest block nothing. None if an order exists; empty if blocks are
    stuck without any locks.
    """
    if not order_of(assembly, sites, choice).stuck:
        return None
    left = list(choice)
    for number, layout in enumerate(choice):
        if layout is not None:
            left[number] = None
            if not order_of(assembly, sites, left).stuck:
                left[number] = layout
    return frozenset((k, layout.direction) for k, layout in enumerate(left) if layout is not None)


def _touching(assembly: Assembly) -> dict[int, list[tuple[int, int, Floats]]]:
    """Of each block: the faces it touches others at, the other block, and the way away from it."""
    found: dict[int, list[tuple[int, int, Floats]]] = {}
    for number, face in enumerate(assembly.faces):
        found.setdefault(face.above, []).append((number, face.below, face.axes[0]))
        found.setdefault(face.below, []).append((number, face.above, -face.axes[0]))
    return found


def _across(assembly: Assembly, sites: Sequence[Site], choice: Choice) -> dict[int, Floats]:
    """By face: the direction across its locks."""
    return {
        site.face: np.cross(assembly.faces[site.face].axes[0], layout.run)
        for site, layout in zip(sites, choice, strict=True)
        if layout is not None
    }


def _way_out(
    assembly: Assembly,
    across: dict[int, Floats],
    touching: dict[int, list[tuple[int, int, Floats]]],
    block: int,
    here: set[int],
) -> Vector | None:
    """A unit vector along which a block can leave those that are here; None if it is blocked."""
    faces = [each for each in touching.get(block, []) if each[1] in here]
    away = np.array([each[2] for each in faces]).reshape(-1, 3)
    along = np.array([across[each[0]] for each in faces if each[0] in across]).reshape(-1, 3)
    flat = away - (away @ np.linalg.pinv(along)) @ along if len(along) else away
    ways = np.array([*_ways(np.concatenate([away, along])), *_units(flat)])
    free = (ways @ away.T >= -CLEAR).all(axis=1) & (np.abs(ways @ along.T) <= CLEAR).all(axis=1)
    if not free.any():
        return None
    # The ways out are a convex cone: the sum of its edges is one, too.
    ways = np.concatenate([ways[free], _units(ways[free].sum(axis=0)[None])])
    apart = (ways @ away.T).min(axis=1, initial=1.0)
    best = max(range(len(ways)), key=lambda k: (round(apart[k], 6), round(ways[k, 2], 6), -k))
    x, y, z = np.round(ways[best], 9).tolist()
    return x, y, z


def _units(vectors: Floats) -> Floats:
    """``vectors``, (K, 3), with length 1, without those that have none."""
    length = np.linalg.norm(vectors, axis=1)
    return np.asarray(vectors[length > CLEAR] / length[length > CLEAR, None])


def _ways(normals: Floats) -> Iterator[Floats]:
    """Vectors that include the edges of any cone with sides of these ``normals``, (K, 3)."""
    unlike: list[Floats] = []
    for one in normals:
        if all(abs(one @ other) < 1.0 - CLEAR for other in unlike):
            unlike.append(one)
    for one, other in combinations(unlike, 2):
        edge = np.cross(one, other)
        yield from (edge / np.linalg.norm(edge), -edge / np.linalg.norm(edge))
    if len(unlike) <= 1:
        one = unlike[0] if unlike else np.array([0.0, 0.0, -1.0])
        flat = np.cross(one, np.eye(3)[int(np.argmin(np.abs(one)))])
        flat /= np.linalg.norm(flat)
        third = np.cross(one, flat)
        yield from (one, -one, flat, -flat, third, -third)
