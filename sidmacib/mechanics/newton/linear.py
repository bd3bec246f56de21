"""Gaussian elimination in a matrix with a band and a border."""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.compilation import compiled


class Matrix(NamedTuple):
    """A square matrix with a band and a border.

    ``band``: element (i, j) of the inner rows and columns is at (i, width + j - i), (inner,
    3 width + 1): elimination with row exchanges fills twice the width above the diagonal.
    ``right``: inner rows of the outer columns, (inner, outer). ``below``: outer rows, (outer, all).
    """

    band: Floats
    right: Floats
    below: Floats


@compiled
def solve_linear(contacts, matrix, x):
    """Turn the right side ``x`` into the solution, and destroy ``matrix``.

    Gaussian elimination with row exchanges, within the band and then within the border. Returns
    whether there is a solution.
    """
    inner, outer, width = contacts.inner, contacts.outer, contacts.band
    band, right, below = matrix.band, matrix.right, matrix.below
    reach = np.empty(inner, np.int64)  # last nonzero column of each row
    for i in range(inner):
        reach[i] = min(i + width, inner - 1)
    for j in range(inner):
        last = min(j + width, inner - 1)
        pivot = largest_in_column(band, width, j, last)
        if pivot != j:
            exchange(contacts, matrix, x, reach, j, pivot)
        count = reach[j] - j + 1
        pivot_row = band[j, width : width + count]
        if pivot_row[0] == 0.0:
            return False
        for i in range(j + 1, last + 1):
            if band[i, width + j - i] == 0.0:  # more than half of the band, in a row of locks
                continue
            row = band[i, width + j - i : width + j - i + count]
            factor = row[0] / pivot_row[0]
            reach[i] = max(reach[i], reach[j])
            for c in range(count):
                row[c] -= factor * pivot_row[c]
            for c in range(outer):
                right[i, c] -= factor * right[j, c]
            x[i] -= factor * x[j]
        for i in range(outer):
            row = below[i, j : j + count]
            factor = row[0] / pivot_row[0]
            for c in range(count):
                row[c] -= factor * pivot_row[c]
            for c in range(outer):
                below[i, inner + c] -= factor * right[j, c]
            x[inner + i] -= factor * x[j]
    if not solve_dense(below[:, inner:], x[inner:]):
        return False
    substitute(contacts, matrix, x, reach)
    return True


@compiled
def substitute(contacts, matrix, x, reach):
    """Back substitution: the inner part of the solution, after elimination."""
    inner, width = contacts.inner, contacts.band
    band, right = matrix.band, matrix.right
    for j in range(inner - 1, -1, -1):
        value = x[j]
        for c in range(contacts.outer):
            value -= right[j, c] * x[inner + c]
        row, known = band[j, width:], x[j : reach[j] + 1]
        for c in range(1, len(known)):
            value -= row[c] * known[c]
        x[j] = value / row[0]


@compiled
def largest_in_column(band, width, j, last):
    """Row, from ``j`` to ``last``, that has the largest element in column ``j``."""
    pivot, largest = j, abs(band[j, width])
    for i in range(j + 1, last + 1):
        size = abs(band[i, width + j - i])
        if size > largest:
            pivot, largest = i, size
    return pivot


@compiled
def exchange(contacts, matrix, x, reach, j, pivot):
    """Exchange rows ``j`` and ``pivot``."""
    width, band, right = contacts.band, matrix.band, matrix.right
    shift = pivot - j
    for c in range(width, width + max(reach[j], reach[pivot]) - j + 1):
        band[j, c], band[pivot, c - shift] = band[pivot, c - shift], band[j, c]
    for c in range(contacts.outer):
        right[j, c], right[pivot, c] = right[pivot, c], right[j, c]
    x[j], x[pivot] = x[pivot], x[j]
    reach[j], reach[pivot] = reach[pivot], reach[j]


@compiled
def solve_dense(matrix, x):
    """`solve_linear` for a full matrix."""
    size = len(x)
    for j in range(size):
        pivot = j
        for i in range(j + 1, size):
            if abs(matrix[i, j]) > abs(matrix[pivot, j]):
                pivot = i
        if matrix[pivot, j] == 0.0:
            return False
        for c in range(j, size):
            matrix[j, c], matrix[pivot, c] = matrix[pivot, c], matrix[j, c]
        x[j], x[pivot] = x[pivot], x[j]
        for i in range(j + 1, size):
            factor = matrix[i, j] / matrix[j, j]
            for c in range(j + 1, size):
                matrix[i, c] -= factor * matrix[j, c]
            x[i] -= factor * x[j]
    for j in range(size - 1, -1, -1):
        for c in range(j + 1, size):
            x[j] -= matrix[j, c] * x[c]
        x[j] /= matrix[j, j]
    return True


@compiled
def negative_pivots(contacts, matrix):
    """The number of negative pivots in an elimination without exchanges, which destroys ``matrix``.

    That of eigenvalues below 0, where the matrix is symmetric (Sylvester's law of inertia).
    """
    inner, outer, width = contacts.inner, contacts.outer, contacts.band
    band, right, below = matrix.band, matrix.right, matrix.below
    found = 0
    for j in range(inner):
        last = min(j + width, inner - 1)
        pivot = band[j, width]
        found += pivot < 0.0
        for i in range(j + 1, last + 1):
            factor = band[i, width + j - i] / pivot
            if factor == 0.0:
                continue
            for c in range(1, last - j + 1):
                band[i, width + j - i + c] -= factor * band[j, width + c]
            for c in range(outer):
                right[i, c] -= factor * right[j, c]
        for i in range(outer):
            factor = below[i, j] / pivot
            for c in range(1, last - j + 1):
                below[i, j + c] -= factor * band[j, width + c]
            for c in range(outer):
                below[i, inner + c] -= factor * right[j, c]
    border = below[:, inner:]
    for j in range(outer):
        found += border[j, j] < 0.0
        for i in range(j + 1, outer):
            factor = border[i, j] / border[j, j]
            for c in range(j + 1, outer):
                border[i, c] -= factor * border[j, c]
    return found
