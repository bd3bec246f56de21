"""Compile functions ahead, when the package is built: python -m sidmacib.mechanics.precompiled.

The files are for this Python, numba and processor. Elsewhere functions are compiled at first use.
"""

# mypy: allow-untyped-calls

import shutil
from typing import Any

import numpy as np
from numba import float64, int64, typeof, types

from sidmacib.mechanics import newton
from sidmacib.mechanics.compilation import SHIPPED, Shipped
from sidmacib.mechanics.contact_law import kernels
from sidmacib.mechanics.newton import faces

Signature = tuple[Any, ...]


def signatures() -> dict[Any, Signature]:
    """Functions that the static model calls, and the types that it calls them with."""
    row, table, three = float64[::1], float64[:, ::1], types.UniTuple(float64, 3)
    whole = np.zeros((1, 2), np.int64)
    start, cube = whole[0], np.zeros((1, 3, 3))
    law, places, blocks = np.zeros((4, 1)), np.zeros((2, 1)), np.zeros((1, 2, 2, 6, 6))
    contacts = typeof(
        faces.ContactFaces(law, places, start, cube, cube, whole, blocks, False, 0, 0, 0)
    )
    matrix, here = (
        typeof(newton.Matrix(law, law, law)),
        typeof(faces.new_point(1, np.array([0, 1]))),
    )
    solved, nodes = (contacts, matrix, here), (row, row, table, row)  # forces, guess, slip, whole
    return {
        faces.whole_faces: (contacts, here),
        newton.elastic: (*solved, row, float64),
        newton.equilibrium: (*solved, *nodes, three),
        kernels.put_slip: (table, table, row, table, table, table),
        kernels._utilisation: (row, row, row, row, table, float64),
        newton.product: (row, row),
        newton.allowed_at: (row, float64, float64),
        newton.put_at: (contacts, table, row, row, here, row),
        newton.least_energy: (*solved, *nodes, types.UniTuple(float64, 4)),
        newton.newton: (*solved, *nodes, three, types.Tuple((float64, int64))),
        kernels.forces_and_tangents: (table, table, row, table),
    }


def main() -> None:
    """Write all of them into the folder of the package."""
    shutil.rmtree(SHIPPED, ignore_errors=True)
    found = signatures()
    for function in found:  # before any is compiled, as one compiles others
        function._cache = Shipped(function.py_func)
    for function, given in found.items():
        function.compile(given)


if __name__ == "__main__":
    main()
