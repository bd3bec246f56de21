"""Compile functions ahead, when the package is built, see `sidmacib.dynamics.precompiled`.

The files are for this Python, numba and processor. Elsewhere functions are compiled at first use.
"""

# mypy: allow-untyped-calls

import shutil
from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import float64, int64, typeof, types

from sidmacib.mechanics import newton
from sidmacib.mechanics.compilation import SHIPPED, Shipped
from sidmacib.mechanics.contact_law import kernels
from sidmacib.mechanics.newton import drift, faces, least_energy, linear, stiffness

Signature = tuple[Any, ...]


def signatures() -> dict[Any, Signature]:
    """Functions that the static model calls, and the types that it calls them with."""
    row, table, three = float64[::1], float64[:, ::1], types.UniTuple(float64, 3)
    four = types.UniTuple(float64, 4)
    plain, cube = np.zeros((1, 1)), np.zeros((1, 3, 3))
    whole, start = np.zeros((1, 2), np.int64), np.zeros(2, np.int64)
    of_faces = plain, plain, start, cube, cube, whole
    of_triangles = np.zeros((1, 3), np.int64), plain[0], start
    built = faces.ContactFaces(*of_faces, *of_triangles, cube, 1.0, 1.0, 0, 1.0, 0, 0, 0)
    matrix, contacts, here = map(
        typeof, (linear.Matrix(plain, plain, plain), built, faces.new_point(built))
    )
    loads = typeof(faces.Applied(plain[0], cube))
    solved, nodes = (contacts, matrix, here), (loads, row, table, row)  # guess, slip, whole
    controlled = types.UniTuple(loads, 2), row, float64, float64, table, row
    return {
        stiffness.whole_faces: (contacts, here),
        newton.elastic: (*solved, row, float64),
        drift.settled: (*solved, *nodes, four),
        newton.controlled: (*solved, *controlled, three),
        drift.pushed: (*solved, *nodes, float64, float64),
        drift.falls: (contacts, table, row, loads, matrix, here, float64),
        newton.put_at: (contacts, table, row, loads, here, row),
        faces.put_slips: (contacts, table, row, here, table),
        least_energy.product: (row, row),
        least_energy.allowed_at: (row, float64, float64),
        least_energy.least_energy: (*solved, *nodes, four),
        newton.newton: (*solved, *nodes, three, types.Tuple((float64, int64, float64))),
        kernels._utilisation: (row, row, row, row, table, float64),
        kernels.forces_and_tangents: (table, table, row, table),
    }


def compile_ahead(found: Mapping[Any, Signature]) -> None:
    """Write all functions, each for its types, into the folder of the package."""
    shutil.rmtree(SHIPPED, ignore_errors=True)
    for function in found:  # before any is compiled, as one compiles others
        function._cache = Shipped(function.py_func)
    for function, given in found.items():
        function.compile(given)
