"""Stiffness matrices of the chain, put together from springs, locks and pairs of neighbours."""

from itertools import product

import numpy as np

from sidmacib.mechanics.assembly import Floats

UNKNOWNS = 7  # of a lock and its column, in m: a tilt counts times b, a turn times a


def matrix(*springs: tuple[float, dict[int, float]], size: int = UNKNOWNS) -> Floats:
    """Stiffness matrix of springs, each with its stiffness and what it makes of the unknowns."""
    whole = np.zeros((size, size))
    for stiffness, terms in springs:
        whole += stiffness * outer(row_of(terms, size))
    return whole


def row_of(terms: dict[int, float], size: int) -> Floats:
    """The coefficients of the unknowns in a movement."""
    row = np.zeros(size)
    row[list(terms)] = list(terms.values())
    return row


def outer(rows: Floats) -> Floats:
    """Each row times itself."""
    return rows[..., :, None] * rows[..., None, :]


def add_locks(whole: Floats, parts: Floats) -> None:
    """Add the stiffness (n, 7, 7) of each lock with its column."""
    count = len(parts)
    lock = np.arange(count)
    whole.reshape(count, UNKNOWNS, count, UNKNOWNS)[lock, :, lock, :] += parts


def add_pairs(whole: Floats, parts: Floats) -> None:
    """Add the stiffness (n - 1, 14, 14) between each two neighbours."""
    count = len(parts) + 1
    lock = np.arange(count - 1)
    blocks = whole.reshape(count, UNKNOWNS, count, UNKNOWNS)
    for row, column in product((0, 1), (0, 1)):
        rows, columns = (slice(at * UNKNOWNS, (at + 1) * UNKNOWNS) for at in (row, column))
        blocks[lock + row, :, lock + column, :] += parts[:, rows, columns]
