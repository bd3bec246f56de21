"""Mesh errors of the static model of a structure: the same on smaller cells.

The peak of a structure whose bonds fail one after the other need not come closer to its limit from
one mesh to the next, as it does in a joint: the change is no measure of what is left. All meshes
have to agree then, and the range of their peaks, beside what no mesh shows, is the error of each.
"""

import math
from collections.abc import Mapping

import numpy as np

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mesh_error import BOUNDS, DIGITS, LoadKind, kind_of, mesh_errors
from sidmacib.problem import Failures, MeshErrors


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
