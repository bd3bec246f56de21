"""Newton's method on contact nodes, compiled: the law of a node, sums over faces, elimination.

Everything that is compiled stands in this file, as numba's cache notices changes of this file only.
No library for linear algebra is called: the results are the same on every processor.

Unknowns are those of `sidmacib.mechanics.springs`, in the order that `sidmacib.mechanics.ordering`
finds, in m; forces in N. A piece's unknowns are a slice that begins at ``Structure.begin``; faces
move by six components of it, which is where pieces that deform would enter.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from sidmacib.mechanics.assembly import Floats, Integers

STEPS = 60  # of Newton's method
LEAST_SHARES = 0.1, 0.01  # of a step; the first is quicker, the second more patient
FLOOR = 1e-10  # of the largest stiffness


class Structure(NamedTuple):
    """What does not change along a path, see `sidmacib.mechanics.springs.Springs`.

    ``begin``: first unknown of the pieces below and above each face, -1 for a fixed one, (F, 2).
    ``inner`` unknowns come first, and those that share an entry of the stiffness are at most
    ``band`` apart; the ``outer`` ones behind them may share one with all.
    """

    normal_stiffness: Floats
    shear_stiffness: Floats
    friction: Floats
    start: Integers
    place: Floats
    motion: Floats
    begin: Integers
    inner: int
    outer: int
    band: int


class Matrix(NamedTuple):
    """A square matrix with a band and a border.

    ``band``: element (i, j) of the inner rows and columns is at (i, width + j - i), (inner,
    3 width + 1): elimination with row exchanges fills twice the width above the diagonal.
    ``right``: inner rows of the outer columns, (inner, outer). ``below``: outer rows, (outer, all).
    """

    band: Floats
    right: Floats
    below: Floats


# --- the law of a node ---------------------------------------------------------------------------
@njit(cache=True)
def node_force(normal, shear, friction, bonded, d0, d1, d2):  # type: ignore[no-untyped-def]
    """Force (N) of a node at displacement d (m), less its slip: return mapping to its cone.

    ``normal``, ``shear``: stiffness in N/m.
    """
    if bonded:
        return normal * d0, shear * d1, shear * d2
    if d0 <= 0.0:
        return 0.0, 0.0, 0.0
    size, cone = shear * np.sqrt(d1 * d1 + d2 * d2), friction * normal * d0
    share = shear if size <= cone else shear * (cone / size)
    return normal * d0, share * d1, share * d2


@njit(cache=True)
def node_tangent(normal, shear, friction, bonded, d0, d1, d2):  # type: ignore[no-untyped-def]
    """Derivatives (N/m) of `node_force`.

    In this order: of the normal force by d0, of the shear forces (1, 2) by d0, of 1 by d1, of 1 by
    d2 and of 2 by d1 (they are the same), of 2 by d2.
    """
    if bonded:
        return normal, 0.0, 0.0, shear, 0.0, shear
    if d0 <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    slip = np.sqrt(d1 * d1 + d2 * d2)
    cone = friction * normal * d0
    if shear * slip <= cone:
        return normal, 0.0, 0.0, shear, 0.0, shear
    x, y, across = d1 / slip, d2 / slip, cone / slip
    cross = -across * x * y
    rise = friction * normal
    return normal, rise * x, rise * y, across * y * y, cross, across * x * x


@njit(cache=True)
def put(values, target):  # type: ignore[no-untyped-def]
    """Copy ``values`` into ``target``."""
    for i in range(len(target)):
        target[i] = values[i]


@njit(cache=True)
def norm(vector):  # type: ignore[no-untyped-def]
    """Euclidean norm."""
    square = 0.0
    for value in vector:
        square += value * value
    return np.sqrt(square)


# --- faces ---------------------------------------------------------------------------------------
@njit(cache=True)
def face_motion(structure, face, unknowns, w):  # type: ignore[no-untyped-def]
    """Relative motion ``w`` (6,) of the middle of ``face``."""
    w[:] = 0.0
    for side in range(2):
        begin = structure.begin[face, side]
        if begin >= 0:
            for i in range(6):
                for j in range(6):
                    w[i] += structure.motion[face, side, i, j] * unknowns[begin + j]


@njit(cache=True)
def node_displacement(structure, node, slip, w):  # type: ignore[no-untyped-def]
    """Relative displacement (m) of ``node``, less its slip, when its face moves by ``w``."""
    p, q = structure.place[node]
    d1, d2 = w[1] - q * w[3] - slip[node, 0], w[2] + p * w[3] - slip[node, 1]
    return w[0] + q * w[4] - p * w[5], d1, d2


@njit(cache=True)
def node_law(structure, node):  # type: ignore[no-untyped-def]
    """Stiffnesses (N/m) and friction coefficient of ``node``."""
    normal, shear = structure.normal_stiffness[node], structure.shear_stiffness[node]
    return normal, shear, structure.friction[node]


@njit(cache=True)
def unbalanced(structure, slip, bonded, unknowns, target, residual):  # type: ignore[no-untyped-def]
    """Put ``target`` less the nodes' forces into ``residual``; returns its norm (N)."""
    w, force = np.empty(6), np.empty(6)
    put(target, residual)
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        force[:] = 0.0
        for node in range(structure.start[face], structure.start[face + 1]):
            normal, shear, friction = node_law(structure, node)
            d0, d1, d2 = node_displacement(structure, node, slip, w)
            f0, f1, f2 = node_force(normal, shear, friction, bonded[node], d0, d1, d2)
            p, q = structure.place[node]
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


@njit(cache=True)
def face_stiffness(structure, face, slip, bonded, w, k):  # type: ignore[no-untyped-def]
    """Put the derivative of the face's forces by its motion ``w`` into ``k``, (6, 6)."""
    k[:] = 0.0
    for node in range(structure.start[face], structure.start[face + 1]):
        normal, shear, friction = node_law(structure, node)
        d0, d1, d2 = node_displacement(structure, node, slip, w)
        t00, t10, t20, t11, t12, t22 = node_tangent(
            normal, shear, friction, bonded[node], d0, d1, d2
        )
        p, q = structure.place[node]
        t30 = p * t20 - q * t10  # moment about the normal
        k[0, 0] += t00
        k[0, 4] += t00 * q
        k[0, 5] -= t00 * p
        k[4, 4] += t00 * q * q
        k[4, 5] -= t00 * p * q
        k[5, 5] += t00 * p * p
        k[1, 0] += t10
        k[1, 4] += t10 * q
        k[1, 5] -= t10 * p
        k[2, 0] += t20
        k[2, 4] += t20 * q
        k[2, 5] -= t20 * p
        k[3, 0] += t30
        k[3, 4] += t30 * q
        k[3, 5] -= t30 * p
        k[1, 1] += t11
        k[1, 2] += t12
        k[2, 2] += t22
        k[1, 3] += p * t12 - q * t11
        k[2, 3] += p * t22 - q * t12
        k[3, 3] += p * p * t22 - 2.0 * p * q * t12 + q * q * t11
    k[4, 0], k[5, 0], k[5, 4] = k[0, 4], k[0, 5], k[4, 5]
    k[2, 1], k[3, 1], k[3, 2] = k[1, 2], k[1, 3], k[2, 3]


@njit(cache=True)
def tangent_stiffness(structure, slip, bonded, unknowns, matrix):  # type: ignore[no-untyped-def]
    """Put the derivative of the nodes' forces on the pieces into ``matrix``."""
    w, k, moved, block = np.empty(6), np.empty((6, 6)), np.empty((6, 6)), np.empty((6, 6))
    matrix.band[:], matrix.right[:], matrix.below[:] = 0.0, 0.0, 0.0
    motion = structure.motion
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        face_stiffness(structure, face, slip, bonded, w, k)
        for right in range(2):
            column = structure.begin[face, right]
            if column < 0:
                continue
            for i in range(6):
                for j in range(6):
                    value = 0.0
                    for n in range(6):
                        value += k[i, n] * motion[face, right, n, j]
                    moved[i, j] = value
            for left in range(2):
                row = structure.begin[face, left]
                if row < 0:
                    continue
                for i in range(6):
                    for j in range(6):
                        value = 0.0
                        for n in range(6):
                            value += motion[face, left, n, i] * moved[n, j]
                        block[i, j] = value
                add(structure, matrix, row, column, block)


@njit(cache=True)
def add(structure, matrix, row, column, block):  # type: ignore[no-untyped-def]
    """Add ``block``, (6, 6), to ``matrix`` where its first element is at ``row``, ``column``."""
    inner, width = structure.inner, structure.band
    if row >= inner:
        for i in range(6):
            for j in range(6):
                matrix.below[row - inner + i, column + j] += block[i, j]
    elif column >= inner:
        for i in range(6):
            for j in range(6):
                matrix.right[row + i, column - inner + j] += block[i, j]
    else:
        for i in range(6):
            for j in range(6):
                matrix.band[row + i, width + column - row - i + j] += block[i, j]


# --- linear equations ----------------------------------------------------------------------------
@njit(cache=True)
def add_diagonal(structure, matrix, value):  # type: ignore[no-untyped-def]
    """Add ``value`` to the diagonal of ``matrix``."""
    for i in range(structure.inner):
        matrix.band[i, structure.band] += value
    for i in range(structure.outer):
        matrix.below[i, structure.inner + i] += value


@njit(cache=True)
def largest(structure, matrix):  # type: ignore[no-untyped-def]
    """The largest element on the diagonal of ``matrix``."""
    value = 0.0
    for i in range(structure.inner):
        value = max(value, matrix.band[i, structure.band])
    for i in range(structure.outer):
        value = max(value, matrix.below[i, structure.inner + i])
    return value


@njit(cache=True)
def solve_linear(structure, matrix, x):  # type: ignore[no-untyped-def]
    """Turn the right side ``x`` into the solution, and destroy ``matrix``.

    Gaussian elimination; rows are exchanged within the band, and within the border after it.
    Returns whether there is one.
    """
    inner, outer, width = structure.inner, structure.outer, structure.band
    band, right, below = matrix.band, matrix.right, matrix.below
    reach = np.empty(inner, np.int64)  # last column of each row
    for i in range(inner):
        reach[i] = min(i + width, inner - 1)
    for j in range(inner):
        last = min(j + width, inner - 1)  # row with an element in this column
        pivot = j
        for i in range(j + 1, last + 1):
            if abs(band[i, width + j - i]) > abs(band[pivot, width + j - pivot]):
                pivot = i
        if band[pivot, width + j - pivot] == 0.0:
            return False
        if pivot != j:
            shift = pivot - j
            for c in range(width, width + max(reach[j], reach[pivot]) - j + 1):
                band[j, c], band[pivot, c - shift] = band[pivot, c - shift], band[j, c]
            for c in range(outer):
                right[j, c], right[pivot, c] = right[pivot, c], right[j, c]
            x[j], x[pivot] = x[pivot], x[j]
            reach[j], reach[pivot] = reach[pivot], reach[j]
        count = reach[j] - j + 1
        own = band[j, width : width + count]
        for i in range(j + 1, last + 1):
            row = band[i, width + j - i : width + j - i + count]
            factor = row[0] / own[0]
            reach[i] = max(reach[i], reach[j])
            for c in range(count):
                row[c] -= factor * own[c]
            for c in range(outer):
                right[i, c] -= factor * right[j, c]
            x[i] -= factor * x[j]
        for i in range(outer):
            row = below[i, j : j + count]
            factor = row[0] / own[0]
            for c in range(count):
                row[c] -= factor * own[c]
            for c in range(outer):
                below[i, inner + c] -= factor * right[j, c]
            x[inner + i] -= factor * x[j]
    if not solve_dense(below[:, inner:], x[inner:]):
        return False
    for j in range(inner - 1, -1, -1):
        for c in range(outer):
            x[j] -= right[j, c] * x[inner + c]
        for c in range(1, reach[j] - j + 1):
            x[j] -= band[j, width + c] * x[j + c]
        x[j] /= band[j, width]
    return True


@njit(cache=True)
def solve_dense(matrix, x):  # type: ignore[no-untyped-def]
    """`solve_linear` without a band."""
    size = len(x)
    for j in range(size):
        pivot = j
        for i in range(j + 1, size):
            if abs(matrix[i, j]) > abs(matrix[pivot, j]):
                pivot = i
        if matrix[pivot, j] == 0.0:
            return False
        if pivot != j:
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


# --- equilibrium ---------------------------------------------------------------------------------
@njit(cache=True)
def elastic(structure, matrix, target, slip, bonded):  # type: ignore[no-untyped-def]
    """Displacements (m) under ``target`` (N) where all nodes are ``bonded``.

    Returns them and the stiffness (N/m) that is added to the diagonal here and in `newton`. It
    keeps pieces that nothing holds from flying off and changes no equilibrium.
    """
    unknowns = np.zeros(len(target))
    tangent_stiffness(structure, slip, bonded, unknowns, matrix)
    floor = FLOOR * largest(structure, matrix)
    add_diagonal(structure, matrix, floor)
    put(target, unknowns)
    solve_linear(structure, matrix, unknowns)
    return unknowns, floor


@njit(cache=True)
def stepped(  # type: ignore[no-untyped-def]
    structure, slip, bonded, unknowns, step, share, target, trial, residual
):
    """Put ``unknowns`` after a ``share`` of ``step`` into ``trial``; see `unbalanced`."""
    for i in range(len(trial)):
        trial[i] = unknowns[i] + share * step[i]
    return unbalanced(structure, slip, bonded, trial, target, residual)


@njit(cache=True)
def newton(  # type: ignore[no-untyped-def]
    structure, matrix, target, guess, slip, bonded, floor, allowed, farthest, least_share
):
    """Displacements (m) at which the nodes carry ``target`` (N), from ``guess``.

    ``slip``, ``bonded``: of the nodes. ``floor``: see `elastic` (N/m). ``allowed``: largest norm of
    the unbalanced forces (N); ``farthest``: of a step (m). Where a whole step would not bring
    equilibrium closer it is halved, down to ``least_share``. Returns whether equilibrium was found,
    and the displacements.
    """
    unknowns, trial = guess.copy(), np.empty_like(guess)
    residual, step = np.empty_like(guess), np.empty_like(guess)
    size = unbalanced(structure, slip, bonded, unknowns, target, residual)
    for _ in range(STEPS):
        if size <= allowed:
            return True, unknowns
        tangent_stiffness(structure, slip, bonded, unknowns, matrix)
        add_diagonal(structure, matrix, floor)
        if not solve_linear(structure, matrix, residual):
            break
        put(residual, step)
        if not norm(step) <= farthest:  # or no number
            break
        before, share = size, 2.0
        while share == 2.0 or (size > before and share > least_share):
            share /= 2.0
            size = stepped(structure, slip, bonded, unknowns, step, share, target, trial, residual)
        if size > before:
            size = stepped(structure, slip, bonded, unknowns, step, 1.0, target, trial, residual)
        put(trial, unknowns)
    return False, unknowns


@njit(cache=True)
def settled(structure, slip, bonded, unknowns):  # type: ignore[no-untyped-def]
    """Forces (N) of all nodes, (N, 3), and their slip (m) from here on, (N, 2)."""
    w = np.empty(6)
    force, after = np.empty((len(slip), 3)), slip.copy()
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        for node in range(structure.start[face], structure.start[face + 1]):
            normal, shear, friction = node_law(structure, node)
            d0, d1, d2 = node_displacement(structure, node, slip, w)
            f0, f1, f2 = node_force(normal, shear, friction, bonded[node], d0, d1, d2)
            force[node, 0], force[node, 1], force[node, 2] = f0, f1, f2
            if not bonded[node]:
                after[node, 0] += d1 - f1 / shear
                after[node, 1] += d2 - f2 / shear
    return force, after


@njit(cache=True)
def equilibrium(  # type: ignore[no-untyped-def]
    structure, matrix, target, guess, slip, bonded, floor, allowed, farthest
):
    """`newton` and then `settled`: whether there is equilibrium, displacements, forces, slip."""
    for least_share in LEAST_SHARES:
        found, unknowns = newton(
            structure,
            matrix,
            target,
            guess,
            slip,
            bonded,
            floor,
            allowed,
            farthest,
            least_share,
        )
        if found:
            break
    force, after = settled(structure, slip, bonded, unknowns)
    return found, unknowns, force, after
