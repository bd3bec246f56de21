"""How far loads are at most from those on an ever finer mesh, told from two meshes.

Errors are taken as proportional to the size of cells: with r times as many cells along a side, the
change from one mesh to the other is r - 1 times what is left. Two numbers for each layout of the
nodes make this an upper estimate for 95 % of joints or more: a factor on it, and a floor for what
two meshes cannot see, over the cells along a side. docs/models.md tells what they were found from.
"""

import math
from collections.abc import Iterable, Mapping
from enum import StrEnum, auto

import numpy as np

from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mechanics.contact_nodes import cells_along

APART = 1.4  # ratio of the cells along a side of two meshes, at least, to tell an error
DIGITS = 9  # after the decimal point, of a relative error; less is rounding
BEHIND = 0.002  # of the first failure; a peak that is further above it is behind it


class LoadKind(StrEnum):
    """What a load is, as far as its mesh error goes."""

    FIRST_FAILURE = auto()
    PEAK = auto()  # where it is all but the first failure, or nothing fails
    LATE_PEAK = auto()  # behind the first failure


# Factor, and floor over the cells along a side.
BOUNDS = {
    NodeLayout.CENTRES: {
        LoadKind.FIRST_FAILURE: (3.0, 0.05),
        LoadKind.PEAK: (3.0, 0.05),
        LoadKind.LATE_PEAK: (3.0, 0.15),
    },
    NodeLayout.VERTICES: {
        LoadKind.FIRST_FAILURE: (1.0, 0.01),
        LoadKind.PEAK: (1.0, 0.02),
        LoadKind.LATE_PEAK: (1.0, 0.1),
    },
    NodeLayout.LOBATTO: {
        LoadKind.FIRST_FAILURE: (1.0, 0.005),
        LoadKind.PEAK: (1.0, 0.02),
        LoadKind.LATE_PEAK: (1.0, 0.12),
    },
}


def cells_of(joint: Joint, mesh: float) -> float:
    """Cells along a side of the locks' horizontal faces on a ``mesh`` (m): their geometric mean."""
    sides = np.array([joint.a, min(map(joint.width, joint.numbers))])
    along, across = cells_along(sides, mesh)
    return math.sqrt(along * across)


def kind_of(loads: Iterable[tuple[float, float | None]]) -> LoadKind:
    """The kind of the loads (N) of a joint on some meshes, each with its first failure if known."""
    late = any(first is not None and load > first * (1.0 + BEHIND) for load, first in loads)
    return LoadKind.LATE_PEAK if late else LoadKind.PEAK


def mesh_errors(
    loads: Mapping[float, float], layout: NodeLayout, kind: LoadKind
) -> dict[float, float]:
    """Relative mesh errors of ``loads`` (N), by cells along a side; empty if they cannot tell.

    That of the finest mesh follows from the next one that is `APART` from it; those of the others
    are their differences to the finest and its error.
    """
    finest = max(loads)
    coarser = [cells for cells in loads if APART * cells <= finest]
    if not coarser:
        return {}
    factor, floor = BOUNDS[layout][kind]
    change = {cells: abs(load / loads[finest] - 1.0) for cells, load in loads.items()}
    next_one = max(coarser)
    error = factor * change[next_one] / (finest / next_one - 1.0) + floor / finest
    return {cells: round(own + error, DIGITS) for cells, own in change.items()}
