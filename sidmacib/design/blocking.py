"""Order of placing: which block can be put where the others are, one by one.

Blocks that touch block each other's way (directional blocking graphs, Wilson & Latombe 1994,
doi:10.1016/0004-3702(94)90048-5): a block cannot move into another across an interface, and locks
let it move along them, or away from the interface, but not across them. Where a block reaches
beyond the interface, the grooves for the other one's locks end in a wall, into which these cannot
move. A block can be placed last if it can be taken away, by a translation, however small. Without
it no other block is blocked by more, so it does not matter which of several is taken first: an
order is found if there is one.

Not seen: blocks that would meet others on a longer way, two blocks placed at once, and whether
what stands so far holds; formwork is taken for granted.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
import shapely

from sidmacib.design import Choice
from sidmacib.design.model import Site
from sidmacib.mechanics.assembly import Assembly, Floats, Vector
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block

CLEAR = 1e-7  # cosine that counts as a way into a block
# Where a wall is looked for: how far beyond the interface and how deep, both over the depth of the
# groove, and along an edge. Wedges that begin at the edge, as of voussoirs, are not seen.
BEYOND, DEEP, ALONG = 0.1, 0.02, np.linspace(0.01, 0.99, 15)
# Motions that locks bar, by face: across them, (3,), either way, and into walls: directions into
# which the block above must move by 0 or more, as seen from the block below, (K, 3).
_Rows = dict[int, tuple[Floats, Floats]]


@dataclass(frozen=True)
class Order:
    """The order in which free blocks are placed, and the blocks that cannot be, by index.

    ``steps``: of each block the direction in which it moves to its place, a unit vector.
    """

    steps: Mapping[int, Vector]
    stuck: tuple[int, ...]


def order_of(assembly: Assembly, sites: Sequence[Site], choice: Choice) -> Order:
    """An order of placing the blocks of an ``assembly`` with the rows of ``choice``.

    Fixed blocks are there before. Blocks are taken away from the highest down.
    """
    rows: _Rows = {}
    for site, layout in zip(sites, choice, strict=True):
        if layout is not None:
            across = np.cross(assembly.faces[site.face].axes[0], layout.run)
            rows[site.face] = across, _walls(assembly, site.face, layout.kind.height / 2.0)
    left = [number for number, piece in enumerate(assembly.pieces) if not piece.fixed]
    left.sort(key=lambda k: (-round(float(assembly.pieces[k].centre[2]), 9), k))
    here = set(range(len(assembly.pieces)))
    taken: dict[int, Vector] = {}
    while True:
        ways = ((block, _way_out(assembly, rows, block, here)) for block in left)
        block, out = next((each for each in ways if each[1] is not None), (-1, None))
        if out is None:
            return Order(dict(reversed(taken.items())), tuple(sorted(left)))
        left.remove(block)
        here.remove(block)
        taken[block] = (-out[0] + 0.0, -out[1] + 0.0, -out[2] + 0.0)


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


def _walls(assembly: Assembly, number: int, depth: float) -> Floats:
    """The walls at the grooves of a ``depth`` (m) on either side of a face, see `_Rows`.

    A groove ends at the outline of the face. It is closed where its block goes on behind that; a
    wedge that begins there is taken to be cut away.
    """
    face = assembly.faces[number]
    assert isinstance(face, Polygon)
    walls = []
    for start, end in pairwise(shapely.get_coordinates(face.outline.exterior)):
        edge = end - start
        length = float(np.linalg.norm(edge))
        outward = np.array([edge[1], -edge[0]]) / length
        places = face.at(start + ALONG[:, None] * edge + BEYOND * depth * outward)
        for block, side in ((face.below, -1.0), (face.above, 1.0)):
            if _any_inside(assembly.pieces[block], places + side * DEEP * depth * face.axes[0]):
                walls.append(side * outward @ face.axes[1:])
    return np.array(walls).reshape(-1, 3)


def _any_inside(piece: object, places: Floats) -> bool:
    """Whether any of ``places`` (m), (K, 3), is inside a convex block."""
    assert isinstance(piece, Block)
    heights = [
        (places - corners[0]) @ normal
        for corners, normal in zip(piece.outlines, piece.normals, strict=True)
    ]
    return bool((np.max(heights, axis=0) < 0.0).any())


def _way_out(assembly: Assembly, rows: _Rows, block: int, here: set[int]) -> Vector | None:
    """A unit vector along which a block can leave those that are here; None if it is blocked."""
    from_others, across, walls = [], [], []
    for number, face in enumerate(assembly.faces):
        if block in (face.below, face.above) and {face.below, face.above} <= here:
            side = 1.0 if face.above == block else -1.0
            from_others.append(side * face.axes[0])
            if number in rows:
                across.append(rows[number][0])
                walls.append(side * rows[number][1])
    away, along = (np.reshape(each, (-1, 3)) for each in (from_others, across))
    open_to = np.concatenate([away, *walls])
    flat = open_to - (open_to @ np.linalg.pinv(along)) @ along if len(along) else open_to
    ways = np.array([*_ways(np.concatenate([open_to, along])), *_units(flat)])
    free = (ways @ open_to.T >= -CLEAR).all(axis=1) & (np.abs(ways @ along.T) <= CLEAR).all(axis=1)
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
