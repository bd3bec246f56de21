"""Mesh errors of the static model of a structure: the same on cells of half the size."""

import math
from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mesh_error import LoadKind, kind_of, mesh_errors

SETTLED = 0.2  # mesh error of a peak, over it: above it the first failure counts
UNSETTLED = "the peak depends too much on the mesh: the first failure counts"


class Failures(NamedTuple):
    """First failure and peak: loads in N, or angles in degrees where gravity turns."""

    first: float
    peak: float


class MeshErrors(NamedTuple):
    """Of the first failure and the peak, each over itself; None of one that is 0."""

    first: float | None
    peak: float | None


UNKNOWN = MeshErrors(None, None)


def is_unsettled(peak_error: float | None, *, bond_fails: bool) -> bool:
    """Whether the first failure counts, not the peak, of which ``peak_error`` is the mesh error.

    ``bond_fails``: whether a bond does before the peak; if not, there is no first failure.
    """
    return bond_fails and peak_error is not None and peak_error > SETTLED


def structure_mesh_errors(
    assembly: Assembly, coarse: Failures, fine: Failures, *, of_fine: bool = False
) -> MeshErrors:
    """The errors of ``coarse``, on the cells of ``assembly``, or ``of_fine``, on smaller ones."""
    sides = [math.sqrt(face.area) for face in assembly.faces]
    cells = max(1.0, float(np.mean(sides)) / assembly.mesh)
    late = kind_of([(coarse.peak, coarse.first), (fine.peak, fine.first)])

    def error(one: float, other: float, kind: LoadKind) -> float | None:
        if not (one > 0.0 and other > 0.0):
            return None
        found = mesh_errors({cells: one, 2 * cells: other}, assembly.layout, kind)
        return found[2 * cells if of_fine else cells]

    return MeshErrors(
        error(coarse.first, fine.first, LoadKind.FIRST_FAILURE),
        error(coarse.peak, fine.peak, late),
    )
