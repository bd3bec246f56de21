"""Mesh errors of loads, estimated from several meshes.

Errors are assumed proportional to the size of cells: with r times as many cells along a side, the
change from one mesh to the other is r - 1 times the error that is left. Two constants for each
layout of the nodes make this an upper estimate for at least 95 % of joints: a factor on it, and a
floor over the cells along a side for errors that two meshes do not show. docs/models.md says how
they were found.

The peak of a structure whose bonds fail one after the other need not come closer to its limit from
one mesh to the next, as it does in a joint: the change is no measure of what is left. All meshes
have to agree then, and the range of their peaks, beside what no mesh shows, is the error of each.
"""

import math
from collections.abc import Iterable, Mapping
from enum import StrEnum, auto

import numpy as np

from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.contact_nodes import cells_along
from sidmacib.problem import Failures, MeshErrors

APART = 1.4  # least ratio of the cells along a side of two meshes that give an estimate
DIGITS = 9  # of a relative error after the decimal point; the rest is rounding
SETTLED = 0.2  # mesh error of a peak that counts though a bond fails before it, over the peak
BEHIND = 0.002  # over the first failure: a peak further above it is a late peak


class LoadKind(StrEnum):
    """Kinds of loads that differ in their mesh errors."""

    FIRST_FAILURE = auto()
    PEAK = auto()  # almost at the first failure, or without failure
    LATE_PEAK = auto()  # well above the first failure


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
    """Geometric mean of the cells along both sides of a lock's horizontal face, ``mesh`` in m."""
    sides = np.array([joint.a, min(map(joint.width, joint.numbers))])
    along, across = cells_along(sides, mesh)
    return math.sqrt(along * across)


def kind_of(loads: Iterable[tuple[float, float | None]], *, moves: bool = False) -> LoadKind:
    """The kind of the loads (N) of a joint on several meshes, each with its first failure.

    ``moves``: whether blocks move before a bond fails. What friction did before then decides, as
    behind a first failure.
    """
    late = any(first is not None and load > first * (1.0 + BEHIND) for load, first in loads)
    return LoadKind.LATE_PEAK if late or moves else LoadKind.PEAK


def mesh_errors(
    loads: Mapping[float, float], layout: NodeLayout, kind: LoadKind
) -> dict[float, float]:
    """Relative mesh errors of ``loads`` (N), by cells along a side; empty without two meshes.

    The error on the finest mesh follows from the next mesh that is `APART` from it. The error on
    another mesh is its difference to the finest plus the error of that.
    """
    finest = max(loads)
    coarser = [cells for cells in loads if APART * cells <= finest]
    if not coarser:
        return {}
    factor, floor = BOUNDS[layout][kind]
    change = {cells: abs(load / loads[finest] - 1.0) for cells, load in loads.items()}
    next_one = max(coarser)
    error = factor * change[next_one] / (finest / next_one - 1.0) + floor / finest
    return {cells: round(relative + error, DIGITS) for cells, relative in change.items()}


def structure_mesh_errors(assembly: Assembly, found: Mapping[int, Failures]) -> MeshErrors:
    """The errors of the failures on the smallest cells; of a late peak, on any of them.

    ``found``: by the number of cells, along a side, that one of ``assembly`` is divided into.
    """
    sides = [math.sqrt(face.area) for face in assembly.faces]
    cells = max(1.0, float(np.mean(sides)) / assembly.mesh)
    first = {cells * divided: each.first for divided, each in found.items()}
    peak = {cells * divided: each.peak for divided, each in found.items()}
    kind = kind_of((each.peak, each.first) for each in found.values())

    def error(loads: Mapping[float, float], kind: LoadKind) -> float | None:
        if not all(load > 0.0 for load in loads.values()):
            return None
        finest = max(loads)
        if kind is not LoadKind.LATE_PEAK:
            return mesh_errors(loads, assembly.layout, kind).get(finest)
        factor, floor = BOUNDS[assembly.layout][kind]
        apart = (max(loads.values()) - min(loads.values())) / loads[finest]
        return round(factor * apart + floor / finest, DIGITS)

    return MeshErrors(error(first, LoadKind.FIRST_FAILURE), error(peak, kind))
