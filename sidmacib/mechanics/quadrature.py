"""Contact nodes on faces: points with tributary areas that stand for a stress all over the face.

Every face is divided into equal cells, and both of its sides have a rule: points between 0 and 1
and weights that add up to 1. Nodes are the points of one side by those of the other.
"""

import numpy as np

from sidmacib.mechanics.assembly import CLOSE, Face, Floats, NodeLayout, Nodes

# The rule of one cell: places in the cell, and weights.
RULES = {
    NodeLayout.CENTRES: ((0.5,), (1.0,)),
    NodeLayout.VERTICES: ((0.0, 1.0), (0.5, 0.5)),
    NodeLayout.LOBATTO: ((0.0, 0.5, 1.0), (1 / 6, 4 / 6, 1 / 6)),
}


def cell_counts(faces: tuple[Face, ...], mesh: float) -> list[tuple[int, int, int]]:
    """Cells of each face along x, y and z, none longer than ``mesh`` (m); 1 along its normal."""
    low, high = np.array([(face.low, face.high) for face in faces]).transpose(1, 0, 2)
    counts = np.maximum(1, np.ceil((high - low) / mesh - CLOSE)).astype(int)
    return [(int(x), int(y), int(z)) for x, y, z in counts]


def side_rule(layout: NodeLayout, cells: int) -> tuple[Floats, Floats]:
    """Places from 0 to 1 on a side of that many ``cells``, and their weights, both (K,)."""
    places, weights = (np.array(values) for values in RULES[layout])
    step = len(places) - 1 or 1  # from a cell's first node to the next one's
    count = step * (cells - 1) + len(places)
    found, weight = np.empty(count), np.zeros(count)
    for cell in range(cells):
        own = slice(step * cell, step * cell + len(places))
        found[own] = (cell + places) / cells
        weight[own] += weights / cells
    return found, weight


def contact_nodes(faces: tuple[Face, ...], mesh: float, layout: NodeLayout) -> Nodes:
    """Nodes of ``layout`` on equal cells of ``faces``, no cell longer than ``mesh`` (m)."""
    rules: dict[int, tuple[Floats, Floats]] = {}
    positions, areas = [], []
    for face, counts in zip(faces, cell_counts(faces, mesh), strict=True):
        places, shares = [np.zeros(1)] * 3, [np.ones(1)] * 3
        for k in range(3):
            if k != face.axis:
                if counts[k] not in rules:
                    rules[counts[k]] = side_rule(layout, counts[k])
                places[k], shares[k] = rules[counts[k]]
        # The last axis runs fastest.
        place = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 3)
        share = shares[0][:, None, None] * shares[1][:, None] * shares[2]
        low, high = np.array(face.low), np.array(face.high)
        positions.append(low + place * (high - low))
        areas.append(face.area * share.ravel())
    index = np.repeat(np.arange(len(faces)), [len(area) for area in areas])
    return Nodes(index, np.concatenate(positions), np.concatenate(areas))
