"""Vectors and triples in compiled code."""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled


@compiled
def norm(vector):
    """Euclidean norm."""
    square = 0.0
    for value in vector:
        square += value**2
    return np.sqrt(square)


@compiled
def farthest(one, other):
    """The largest difference between components, NaN if one of them is NaN."""
    largest = 0.0
    for i in range(len(one)):
        apart = abs(one[i] - other[i])
        if not apart <= largest:
            largest = apart
    return largest


@compiled
def dot(one, other):
    """Inner product of two triples."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


@compiled
def cross(one, other):
    """Cross product of two triples."""
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )


@compiled
def times(matrix, vector):
    """Product of a (3, 3) ``matrix`` and a triple."""
    return (
        matrix[0, 0] * vector[0] + matrix[0, 1] * vector[1] + matrix[0, 2] * vector[2],
        matrix[1, 0] * vector[0] + matrix[1, 1] * vector[1] + matrix[1, 2] * vector[2],
        matrix[2, 0] * vector[0] + matrix[2, 1] * vector[1] + matrix[2, 2] * vector[2],
    )


@compiled
def together(axes, a, b, c):
    """The sum of ``a``, ``b`` and ``c`` times the rows of ``axes``."""
    return (
        a * axes[0, 0] + b * axes[1, 0] + c * axes[2, 0],
        a * axes[0, 1] + b * axes[1, 1] + c * axes[2, 1],
        a * axes[0, 2] + b * axes[1, 2] + c * axes[2, 2],
    )


@compiled
def put(row, a, b, c, d, e, f):
    """Fill a ``row`` of six numbers."""
    row[0], row[1], row[2], row[3], row[4], row[5] = a, b, c, d, e, f
