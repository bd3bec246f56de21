"""Contact nodes on faces: points with tributary areas that integrate the stress over a face.

Every face is divided into equal cells. Along each side a quadrature rule gives points between 0 and
1 and weights that add up to 1; the nodes are the tensor product of both sides.
"""

from functools import lru_cache

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers, NodeLayout, Nodes, Rectangle

# Quadrature rule of one cell: places in the cell, and weights.
CELL_RULES = {
    NodeLayout.CENTRES: ((0.5,), (1.0,)),
    NodeLayout.VERTICES: ((0.0, 1.0), (0.5, 0.5)),
    NodeLayout.LOBATTO: ((0.0, 0.5, 1.0), (1 / 6, 4 / 6, 1 / 6)),
}


MOST_CELLS = 1_000_000  # of an assembly's faces: as many take some gigabytes
STRETCH = 1e-6  # by which a cell may exceed the mesh, so that rounding of a size adds no cell


def cells_along(lengths: Floats, mesh: float) -> Integers:
    """Equal cells on ``lengths`` (m), none longer than ``mesh`` (m), and at least one."""
    return np.maximum(1, np.ceil(lengths / (mesh * (1.0 + STRETCH)))).astype(np.int64)


def cell_counts(faces: tuple[Rectangle, ...], mesh: float) -> Integers:
    """Cells of each face along x, y and z, (F, 3); 1 along its normal."""
    low, high = corners(faces)
    return cells_along(high - low, mesh)


def corners(faces: tuple[Rectangle, ...]) -> tuple[Floats, Floats]:
    """Lowest and highest corners of ``faces``, in m, (F, 3) each."""
    low, high = np.array([(face.low, face.high) for face in faces]).transpose(1, 0, 2)
    return low, high


def side_rule(layout: NodeLayout, cells: int) -> tuple[Floats, Floats]:
    """Places from 0 to 1 on a side of that many ``cells``, and their weights, both (K,)."""
    places, weights = (np.array(values) for values in CELL_RULES[layout])
    step = len(places) - 1 or 1  # number of nodes from one cell's first node to the next cell's
    count = step * (cells - 1) + len(places)
    place, weight = np.empty(count), np.zeros(count)
    for cell in range(cells):
        nodes = slice(step * cell, step * cell + len(places))
        place[nodes] = (cell + places) / cells
        weight[nodes] += weights / cells
    return place, weight


@lru_cache(maxsize=1024)
def unit_face(layout: NodeLayout, counts: tuple[int, ...], axis: int) -> tuple[Floats, Floats]:
    """Nodes on a unit square normal to ``axis``, with ``counts`` cells along x, y and z.

    Returns places, (K, 3), and areas, (K,); the last axis runs fastest.
    """
    sides = [
        (np.zeros(1), np.ones(1)) if k == axis else side_rule(layout, count)
        for k, count in enumerate(counts)
    ]
    (_, x), (_, y), (_, z) = sides
    place = np.stack(np.meshgrid(*(places for places, _ in sides), indexing="ij"), axis=-1)
    return place.reshape(-1, 3), (x[:, None, None] * y[:, None] * z).ravel()


def contact_nodes(
    faces: tuple[Rectangle, ...], mesh: float, layout: NodeLayout, least: int = 1
) -> Nodes:
    """Nodes of ``layout`` on equal cells of ``faces``, no cell longer than ``mesh`` (m).

    ``least``: cells along every side, however short. ValueError for more cells than `MOST_CELLS`.
    """
    low, high = corners(faces)
    cells = np.maximum(least, cells_along(high - low, mesh))
    if (count := cells.prod(axis=1, dtype=float).sum()) > MOST_CELLS:
        raise ValueError(
            f"mesh: {mesh:g} m is not allowed; it must be longer, so that all faces have at most "
            f"{MOST_CELLS} cells (they would have {count:.3g})"
        )
    units = [
        unit_face(layout, tuple(counts), face.axis)
        for face, counts in zip(faces, cells.tolist(), strict=True)
    ]
    index = np.repeat(np.arange(len(faces)), [len(share) for _, share in units])
    place, share = (np.concatenate(parts) for parts in zip(*units, strict=True))
    area = np.array([face.area for face in faces])
    return Nodes(index, low[index] + place * (high - low)[index], area[index] * share)
