"""Compile functions ahead, those of the static model too: python -m sidmacib.dynamics.precompiled.

See `sidmacib.mechanics.precompiled`.
"""

# mypy: allow-untyped-calls

from typing import Any

import numpy as np
from numba import float64, typeof, types

from sidmacib.dynamics.bodies import Bodies, State
from sidmacib.dynamics.contacts import Contacts, Pairs, Places, Solids
from sidmacib.dynamics.impulses import Acting, steps
from sidmacib.dynamics.roots import Roots
from sidmacib.mechanics import precompiled


def signatures() -> dict[Any, precompiled.Signature]:
    """The function that the model in time calls, and the types that it calls it with."""
    row, table, cube = np.zeros(1), np.zeros((1, 1)), np.zeros((1, 3, 3))
    whole, pairs = np.zeros(1, np.int64), np.zeros((1, 2), np.int64)
    contacts = typeof(Contacts(whole, whole, whole, whole, cube, table, row, table, row))
    given = (
        Solids(whole, whole, whole, whole, whole, whole, whole, pairs, row),
        Places(table, table, table),
        Bodies(row, cube, cube),
        State(table, table, table, table),
        Pairs(pairs, row, whole),
    )
    acting = typeof(Acting(table, cube, table, 0.0, 0.0, 0.0))
    more = (types.UniTuple(contacts, 2), acting, float64, float64[:, ::1], float64[::1])
    roots = typeof(Roots(whole, whole, row, cube, table, table, whole, cube, table))
    return {steps: (*map(typeof, given), *more, roots, float64[:, ::1])}


if __name__ == "__main__":
    precompiled.compile_ahead(precompiled.signatures() | signatures())
