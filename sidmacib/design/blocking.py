"""Order of placing the blocks of a design, and rows of locks that leave none.

A block cannot move into another across an interface, and locks let it move along them, or away from
the interface, but not across them. Where a block reaches beyond the interface, the grooves for the
other one's locks end in a wall, into which these cannot move.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from sidmacib.design import Choice
from sidmacib.design.model import Site
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block
from sidmacib.structure.placing import Order, placing_order

# Where a wall is looked for: how far beyond the interface and how deep, both over the depth of the
# groove, and along an edge. Wedges that begin at the edge, as of voussoirs, are not seen.
BEYOND, DEEP, ALONG = 0.1, 0.02, np.linspace(0.01, 0.99, 15)


def order_of(assembly: Assembly, sites: Sequence[Site], choice: Choice) -> Order:
    """An order of placing the blocks of an ``assembly`` with the rows of ``choice``.

    Fixed blocks are there before.
    """
    walls = [face.axes[:1] for face in assembly.faces]
    for site, layout in zip(sites, choice, strict=True):
        if layout is not None:
            across = np.cross(walls[site.face], layout.run)
            ends = _walls(assembly, site.face, layout.kind.height / 2.0)
            walls[site.face] = np.concatenate([walls[site.face], across, -across, ends])
    heights = {k: float(p.centre[2]) for k, p in enumerate(assembly.pieces) if not p.fixed}
    faces = zip(assembly.faces, walls, strict=True)
    return placing_order(heights, ((face.below, face.above, of) for face, of in faces))


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
    """The walls at the grooves of a ``depth`` (m) on either side of a face, see `order_of`.

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
