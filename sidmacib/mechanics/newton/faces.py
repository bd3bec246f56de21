"""Faces with contact nodes: the forces on the pieces, and their derivatives.

The unknowns (m) are those of `sidmacib.mechanics.springs`, in the order that
`sidmacib.mechanics.rigid.ordering` finds; forces are in N. The unknowns of a piece are a slice that
begins at ``Structure.begin``; its faces move by six components of it.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.newton.compilation import compiled
from sidmacib.mechanics.newton.node_law import node_force, node_tangent

NORMAL, SHEAR, FRICTION, GIVEN, P, Q = range(6)  # columns of `Structure.nodes`


class Structure(NamedTuple):
    """What stays the same along a path, see `sidmacib.mechanics.springs.Springs`.

    ``nodes``: normal and shear stiffness (N/m), friction coefficient, given friction (N) and place
    of each, (N, 6). Given friction is a limit that does not depend on the normal force, not even at
    an open node; if there is no other friction, the energy of the nodes is convex.
    ``begin``: first unknown of the pieces below and above each face, -1 for a fixed one, (F, 2).
    ``bonded``: forces on the two pieces by the unknowns of either while all bonds of a face are
    whole (N/m), see `whole_faces`, (F, 2, 2, 6, 6).
    The ``inner`` unknowns come first; those coupled by the stiffness are at most ``band`` apart.
    The ``outer`` unknowns follow and may be coupled to all others.
    """

    nodes: Floats
    start: Integers
    motion: Floats
    begin: Integers
    bonded: Floats
    inner: int
    outer: int
    band: int


@compiled
def norm(vector):
    """Euclidean norm."""
    square = 0.0
    for value in vector:
        square += value**2
    return np.sqrt(square)


@compiled
def face_motion(structure, face, unknowns, w):
    """Relative motion ``w`` (6,) of the middle of ``face``."""
    for i in range(6):
        value = 0.0
        for side in range(2):
            begin = structure.begin[face, side]
            if begin >= 0:
                for j in range(6):
                    value += structure.motion[face, side, i, j] * unknowns[begin + j]
        w[i] = value


@compiled
def node_displacement(p, q, slip, node, w):
    """Displacement (m) of ``node`` at (p, q), less its slip, when its face moves by ``w``."""
    d1, d2 = w[1] - q * w[3] - slip[node, 0], w[2] + p * w[3] - slip[node, 1]
    return w[0] + q * w[4] - p * w[5], d1, d2


@compiled
def unbalanced(structure, slip, whole, unknowns, target, residual):
    """Put ``target`` less the nodes' forces into ``residual``; returns its norm (N)."""
    w, force = np.empty(6), np.empty(6)
    for i, value in enumerate(target):
        residual[i] = value
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        force[:] = 0.0
        for node in range(structure.start[face], structure.start[face + 1]):
            normal, shear, friction, given, p, q = structure.nodes[node]
            d0, d1, d2 = node_displacement(p, q, slip, node, w)
            f0, f1, f2 = node_force(normal, shear, friction, given, whole[node], d0, d1, d2)
            force[0] += f0
            force[1] += f1
            force[2] += f2
            force[3] += p * f2 - q * f1
            force[4] += q * f0
            force[5] -= p * f0
        for side in range(2):
            begin = structure.begin[face, side]
            if begin >= 0:
                for i in range(6):
                    for j in range(6):
                        residual[begin + j] -= structure.motion[face, side, i, j] * force[i]
    return norm(residual)


@compiled
def face_stiffness(structure, face, slip, whole, w, k):
    """Put the derivative of the face's forces by its motion ``w`` into ``k``, (6, 6).

    Returns whether any node resists.
    """
    nodes, resists = structure.nodes, False
    k[:] = 0.0
    for node in range(structure.start[face], structure.start[face + 1]):
        given, p, q = nodes[node, GIVEN], nodes[node, P], nodes[node, Q]
        d0, d1, d2 = node_displacement(p, q, slip, node, w)
        if d0 <= 0.0 and whole[node] == 0.0 and given == 0.0:  # open
            continue
        resists = True
        normal, shear, friction = nodes[node, NORMAL], nodes[node, SHEAR], nodes[node, FRICTION]
        t00, t10, t20, t11, t12, t22 = node_tangent(
            normal, shear, friction, given, whole[node], d0, d1, d2
        )
        # All six forces of the face by the normal displacement, then its shear forces by shear.
        rises = t00, t10, t20, p * t20 - q * t10, q * t00, -p * t00
        for i in range(6):
            k[i, 0] += rises[i]
            k[i, 4] += rises[i] * q
            k[i, 5] -= rises[i] * p
        k[1, 1] += t11
        k[1, 2] += t12
        k[2, 2] += t22
        k[1, 3] += p * t12 - q * t11
        k[2, 3] += p * t22 - q * t12
        k[3, 3] += p * p * t22 - 2.0 * p * q * t12 + q * q * t11
    k[2, 1], k[3, 1], k[3, 2] = k[1, 2], k[1, 3], k[2, 3]
    return resists


@compiled
def tangent_stiffness(structure, slip, whole, unknowns, floor, matrix):
    """Put the derivative of the nodes' forces on the pieces into ``matrix``.

    ``floor`` (N/m) is added to the diagonal: it keeps pieces that nothing holds during an iteration
    from flying off, and changes no equilibrium.
    """
    w, k, blocks = np.empty(6), np.empty((6, 6)), np.empty((2, 2, 6, 6))
    matrix.band[:], matrix.right[:], matrix.below[:] = 0.0, 0.0, 0.0
    matrix.band[:, structure.band] = floor
    for i in range(structure.outer):
        matrix.below[i, structure.inner + i] = floor
    for face in range(len(structure.begin)):
        if is_whole(structure, face, whole):
            add_face(structure, matrix, face, structure.bonded[face])
            continue
        face_motion(structure, face, unknowns, w)
        if face_stiffness(structure, face, slip, whole, w, k):
            by_pieces(structure, face, k, blocks)
            add_face(structure, matrix, face, blocks)


@compiled
def is_whole(structure, face, whole):
    """Whether all bonds of ``face`` are whole: its stiffness then does not depend on its motion."""
    for node in range(structure.start[face], structure.start[face + 1]):
        if whole[node] != 1.0:
            return False
    return True


@compiled
def whole_faces(structure):
    """Put the stiffness of each face with all bonds whole into ``structure.bonded``."""
    count = len(structure.nodes)
    slip, whole, w, k = np.zeros((count, 2)), np.ones(count), np.zeros(6), np.empty((6, 6))
    for face in range(len(structure.begin)):
        face_stiffness(structure, face, slip, whole, w, k)
        by_pieces(structure, face, k, structure.bonded[face])


@compiled
def by_pieces(structure, face, k, blocks):
    """Turn the stiffness ``k`` by the face's motion into ``blocks`` by the two pieces' unknowns."""
    moved = np.empty((6, 6))
    for right in range(2):
        if structure.begin[face, right] >= 0:
            multiply(k, structure.motion[face, right], moved)
            for left in range(2):
                if structure.begin[face, left] >= 0:
                    multiply_transposed(structure.motion[face, left], moved, blocks[left, right])


@compiled
def multiply(one, other, product):
    """Put ``one`` times ``other``, both (6, 6), into ``product``."""
    for i in range(6):
        row = one[i, 0], one[i, 1], one[i, 2], one[i, 3], one[i, 4], one[i, 5]
        put_row(row, other, product, i)


@compiled
def multiply_transposed(one, other, product):
    """`multiply` with the transpose of ``one``; faster than with a view of it."""
    for i in range(6):
        row = one[0, i], one[1, i], one[2, i], one[3, i], one[4, i], one[5, i]
        put_row(row, other, product, i)


@compiled
def put_row(row, other, product, i):
    """Put ``row``, six numbers, times ``other`` into row ``i`` of ``product``.

    Written out, it is vectorised.
    """
    a, b, c, d, e, f = row
    for j in range(6):
        product[i, j] = (
            a * other[0, j]
            + b * other[1, j]
            + c * other[2, j]
            + d * other[3, j]
            + e * other[4, j]
            + f * other[5, j]
        )


@compiled
def add_face(structure, matrix, face, blocks):
    """Add ``blocks`` of the pieces below and above ``face``, (2, 2, 6, 6), to ``matrix``."""
    inner, band, border, below = structure.inner, matrix.band, matrix.right, matrix.below
    for left in range(2):
        row = structure.begin[face, left]
        for right in range(2):
            column = structure.begin[face, right]
            if row < 0 or column < 0:
                continue
            # A loop each, not one with a choice inside: several times faster.
            if row >= inner:
                for i in range(6):
                    for j in range(6):
                        below[row - inner + i, column + j] += blocks[left, right, i, j]
            elif column >= inner:
                for i in range(6):
                    for j in range(6):
                        border[row + i, column - inner + j] += blocks[left, right, i, j]
            else:
                first = structure.band + column - row
                for i in range(6):
                    for j in range(6):
                        band[row + i, first - i + j] += blocks[left, right, i, j]
