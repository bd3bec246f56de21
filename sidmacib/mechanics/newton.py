"""Newton's method on contact nodes, compiled: the contact law, sums over faces, elimination.

All compiled functions are in this one file because numba's cache of a function notices changes of
its own file only, not of the functions that it calls. No library for linear algebra is called, so
results are the same on every processor.

The unknowns (m) are those of `sidmacib.mechanics.springs`, in the order that
`sidmacib.mechanics.rigid.ordering` finds; forces are in N. The unknowns of a piece are a slice that
begins at ``Structure.begin``; its faces move by six components of it.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np
from numba import njit

from sidmacib.mechanics.assembly import Floats, Integers

STEPS = 60  # of Newton's method, at most
# The least fraction of a step, and how many steps may be longer than allowed.
QUICK, PATIENT = (0.1, 0), (0.01, 3)
# Line search along a step, where friction is given.
TRIALS = 40  # places, at most
ENOUGH = 0.5  # slope over that at the start of a step: the line search ends below it
RESISTED = 0.99  # slope over that at the start: above it nothing resists, and the step is extended
LONGER = 10.0  # by this factor
NEAREST = 0.02  # distance of the next trial to either end of the bracket, over its length
ROUNDING = 1e-14  # unbalanced force over stiffest face times displacement: rounding error
MOST_ROUNDING = 100.0  # over the tolerance: its upper bound, as pieces may move away


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


class Matrix(NamedTuple):
    """A square matrix with a band and a border.

    ``band``: element (i, j) of the inner rows and columns is at (i, width + j - i), (inner,
    3 width + 1): elimination with row exchanges fills twice the width above the diagonal.
    ``right``: inner rows of the outer columns, (inner, outer). ``below``: outer rows, (outer, all).
    """

    band: Floats
    right: Floats
    below: Floats


compiled = njit(cache=True, error_model="numpy")  # division by zero gives inf, as in numpy


# --- contact law of a node -----------------------------------------------------------------------
@compiled
def node_force(normal, shear, friction, given, whole, d0, d1, d2):
    """Force (N) of a node at displacement d less its slip (m): return mapping to the friction cone.

    ``normal``, ``shear``: stiffness in N/m; ``whole``: the fraction of it that the bond still has,
    0 without a bond. Under compression a bond has its full stiffness. ``given``: friction limit in
    N, added to that of the normal force.
    """
    if whole > 0.0:
        return (
            normal * d0 if d0 > 0.0 else whole * normal * d0,
            whole * shear * d1,
            whole * shear * d2,
        )
    if d0 <= 0.0 and given == 0.0:
        return 0.0, 0.0, 0.0
    pressed = max(d0, 0.0)
    size, cone = shear * np.sqrt(d1 * d1 + d2 * d2), friction * normal * pressed + given
    share = shear if size <= cone else shear * (cone / size)
    return normal * pressed, share * d1, share * d2


@compiled
def node_tangent(normal, shear, friction, given, whole, d0, d1, d2):
    """Derivatives (N/m) of `node_force`.

    In this order: of the normal force by d0, of the shear forces (1, 2) by d0, of 1 by d1, of 1 by
    d2 (the same as of 2 by d1), of 2 by d2.
    """
    if whole > 0.0:
        along = whole * shear
        return normal if d0 > 0.0 else whole * normal, 0.0, 0.0, along, 0.0, along
    if d0 <= 0.0:
        if given == 0.0:
            return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        normal = 0.0
    slip, cone = np.sqrt(d1 * d1 + d2 * d2), friction * normal * d0 + given
    if shear * slip <= cone:
        return normal, 0.0, 0.0, shear, 0.0, shear
    x, y, across, rise = d1 / slip, d2 / slip, cone / slip, friction * normal
    return normal, rise * x, rise * y, across * y * y, -across * x * y, across * x * x


@compiled
def forces_and_tangents(stiffness, friction, whole, displacement):
    """Forces (N), (N, 3), and tangents (N/m), (N, 3, 3), of nodes at ``displacement`` (m), (N, 3).

    ``stiffness``: normal and shear (N/m), (N, 2). Displacements are less the slip.
    """
    count = len(friction)
    force, tangent = np.empty((count, 3)), np.zeros((count, 3, 3))
    for n in range(count):
        normal, shear = stiffness[n]
        d0, d1, d2 = displacement[n]
        contact_law = normal, shear, friction[n], 0.0, whole[n], d0, d1, d2
        force[n, 0], force[n, 1], force[n, 2] = node_force(*contact_law)
        t = tangent[n]
        t[0, 0], t[1, 0], t[2, 0], t[1, 1], t[1, 2], t[2, 2] = node_tangent(*contact_law)
        t[2, 1] = t[1, 2]
    return force, tangent


@compiled
def norm(vector):
    """Euclidean norm."""
    square = 0.0
    for value in vector:
        square += value**2
    return np.sqrt(square)


# --- faces ---------------------------------------------------------------------------------------
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
    k[:], resists = 0.0, False
    for node in range(structure.start[face], structure.start[face + 1]):
        normal, shear, friction, given, p, q = structure.nodes[node]
        d0, d1, d2 = node_displacement(p, q, slip, node, w)
        if d0 <= 0.0 and whole[node] == 0.0 and given == 0.0:  # open
            continue
        resists = True
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
                    multiply(structure.motion[face, left].T, moved, blocks[left, right])


@compiled
def add_face(structure, matrix, face, blocks):
    """Add ``blocks`` of the pieces below and above ``face``, (2, 2, 6, 6), to ``matrix``."""
    for right in range(2):
        for left in range(2):
            row, column = structure.begin[face, left], structure.begin[face, right]
            if row >= 0 and column >= 0:
                add(structure, matrix, row, column, blocks[left, right])


@compiled
def multiply(one, other, product):
    """Put ``one`` times ``other``, both (6, 6), into ``product``; written out, it is vectorised."""
    for i in range(6):
        a, b, c, d, e, f = one[i, 0], one[i, 1], one[i, 2], one[i, 3], one[i, 4], one[i, 5]
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
def add(structure, matrix, row, column, block):
    """Add ``block``, (6, 6), to ``matrix`` where its first element is at ``row``, ``column``."""
    inner, width = structure.inner, structure.band
    for i in range(6):
        for j in range(6):
            if row >= inner:
                matrix.below[row - inner + i, column + j] += block[i, j]
            elif column >= inner:
                matrix.right[row + i, column - inner + j] += block[i, j]
            else:
                matrix.band[row + i, width + column - row - i + j] += block[i, j]


# --- linear equations ----------------------------------------------------------------------------
@compiled
def solve_linear(structure, matrix, x):
    """Turn the right side ``x`` into the solution, and destroy ``matrix``.

    Gaussian elimination with row exchanges, within the band and then within the border. Returns
    whether there is a solution.
    """
    inner, outer, width = structure.inner, structure.outer, structure.band
    band, right, below = matrix.band, matrix.right, matrix.below
    reach = np.empty(inner, np.int64)  # last nonzero column of each row
    for i in range(inner):
        reach[i] = min(i + width, inner - 1)
    for j in range(inner):
        exchange(structure, matrix, x, reach, j)
        count = reach[j] - j + 1
        pivot_row = band[j, width : width + count]
        if pivot_row[0] == 0.0:
            return False
        for i in range(j + 1, min(j + width, inner - 1) + 1):
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
    substitute(structure, matrix, x, reach)
    return True


@compiled
def substitute(structure, matrix, x, reach):
    """Back substitution: the inner part of the solution, after elimination."""
    inner, width = structure.inner, structure.band
    for j in range(inner - 1, -1, -1):
        for c in range(structure.outer):
            x[j] -= matrix.right[j, c] * x[inner + c]
        for c in range(1, reach[j] - j + 1):
            x[j] -= matrix.band[j, width + c] * x[j + c]
        x[j] /= matrix.band[j, width]


@compiled
def exchange(structure, matrix, x, reach, j):
    """Exchange row ``j`` with the row of the band that has the largest element in column ``j``."""
    width, band, right = structure.band, matrix.band, matrix.right
    pivot = j
    for i in range(j + 1, min(j + width, structure.inner - 1) + 1):
        if abs(band[i, width + j - i]) > abs(band[pivot, width + j - pivot]):
            pivot = i
    if pivot == j:
        return
    shift = pivot - j
    for c in range(width, width + max(reach[j], reach[pivot]) - j + 1):
        band[j, c], band[pivot, c - shift] = band[pivot, c - shift], band[j, c]
    for c in range(structure.outer):
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


# --- equilibrium ---------------------------------------------------------------------------------
@compiled
def elastic(structure, matrix, target, slip, whole, floor):
    """Displacements (m) under the forces ``target`` (N) with all nodes closed and ``whole``."""
    tangent_stiffness(structure, slip, whole, np.zeros(len(target)), floor, matrix)
    unknowns = target.copy()
    solve_linear(structure, matrix, unknowns)
    return unknowns


@compiled
def stepped(structure, slip, whole, unknowns, step, share, target, trial, residual):
    """Put ``unknowns`` after a fraction of ``step`` into ``trial``; see `unbalanced`."""
    for i in range(len(trial)):
        trial[i] = unknowns[i] + share * step[i]
    return unbalanced(structure, slip, whole, trial, target, residual)


@compiled
def newton(structure, matrix, target, guess, slip, whole, limits, patience):
    """Displacements (m) at which the nodes carry ``target`` (N), from ``guess``.

    ``slip``, ``whole``: of the nodes. ``limits``: the floor of `tangent_stiffness` (N/m) and the
    largest norms of unbalanced forces (N) and of a step (m). A step that does not reduce the
    unbalanced forces is halved. ``patience``: the least fraction of a step, and the number of steps
    that may exceed the limit, as pieces that come loose may return. Returns whether equilibrium was
    found, and the displacements.
    """
    (floor, allowed, largest_step), (least_share, most_far), far = limits, patience, 0
    unknowns, trial, residual = guess.copy(), np.empty_like(guess), np.empty_like(guess)
    size = unbalanced(structure, slip, whole, unknowns, target, residual)
    for _ in range(STEPS):
        if size <= allowed:
            return True, unknowns
        tangent_stiffness(structure, slip, whole, unknowns, floor, matrix)
        if not solve_linear(structure, matrix, residual):
            break
        step = residual.copy()
        far += not norm(step) <= largest_step  # true for NaN as well
        if far > most_far:
            break
        before, share = size, 2.0
        while share == 2.0 or (size > before and share > least_share):
            share /= 2.0
            size = stepped(structure, slip, whole, unknowns, step, share, target, trial, residual)
        if size > before:
            size = stepped(structure, slip, whole, unknowns, step, 1.0, target, trial, residual)
        unknowns, trial = trial, unknowns
    return False, unknowns


# --- given friction limits: the minimum of a convex energy ---------------------------------------
@compiled
def product(one, other):
    """Inner product, with what is lost to rounding in its sum (Neumaier, 1974)."""
    total, lost = 0.0, 0.0
    for i in range(len(one)):
        value = one[i] * other[i]
        larger = total + value
        if abs(total) >= abs(value):
            lost += (total - larger) + value
        else:
            lost += (value - larger) + total
        total = larger
    return total + lost


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
def allowed_at(unknowns, stiffness, allowed):
    """Norm of unbalanced forces (N) that counts as zero, rounding at ``stiffness`` included."""
    inside = stiffness * farthest(unknowns, np.zeros_like(unknowns))
    return min(max(allowed, ROUNDING * inside), MOST_ROUNDING * allowed)


@compiled
def least_energy(structure, matrix, target, guess, slip, whole, limits):
    """Displacements (m) of least energy from ``guess``, where all friction is given.

    ``limits``: of the stiffest face and of the floor (N/m), the norm of unbalanced forces (N), and
    the distance (m) beyond which a piece moves away. Returns whether they were found, and the
    displacements: if the loads push pieces away, these are then some way off.
    """
    stiffness, floor, allowed, far = limits
    unknowns, trial, residual = guess.copy(), np.empty_like(guess), np.empty_like(guess)
    size = unbalanced(structure, slip, whole, unknowns, target, residual)
    for _ in range(STEPS):
        if not farthest(unknowns, guess) <= far:  # true for NaN as well
            break
        if size <= allowed_at(unknowns, stiffness, allowed):
            return True, unknowns
        tangent_stiffness(structure, slip, whole, unknowns, floor, matrix)
        step = residual.copy()
        if not solve_linear(structure, matrix, step):
            break
        start, part, tried = product(residual, step), 1.0, 0
        low, low_slope, high, high_slope = 0.0, start, np.inf, 0.0
        while True:
            size = stepped(structure, slip, whole, unknowns, step, part, target, trial, residual)
            slope, tried = product(residual, step), tried + 1
            if abs(slope) <= ENOUGH * start or tried == TRIALS or not np.isfinite(slope):
                break
            if slope > 0.0 and not farthest(trial, guess) <= far:
                break
            # False position in the Illinois variant, which halves the slope at an end that stays.
            if slope > 0.0 and high == np.inf:
                if slope < RESISTED * start and part == 1.0:
                    break  # a plain step
                low, low_slope, part = part, slope, LONGER * part
                continue
            if slope > 0.0:
                low, low_slope, high_slope = part, slope, high_slope / 2.0
            else:
                low_slope /= 1.0 if high == np.inf else 2.0
                high, high_slope = part, slope
            share = low_slope / (low_slope - high_slope)
            part = low + (high - low) * min(max(share, NEAREST), 1.0 - NEAREST)
        unknowns, trial = trial, unknowns
    return False, unknowns


# --- results -------------------------------------------------------------------------------------
@compiled
def node_forces(structure, slip, whole, unknowns):
    """Forces (N) of all nodes, (N, 3), and their slip (m) after this equilibrium, (N, 2)."""
    w, force, after = np.empty(6), np.empty((len(slip), 3)), slip.copy()
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        for node in range(structure.start[face], structure.start[face + 1]):
            normal, shear, friction, given, p, q = structure.nodes[node]
            d0, d1, d2 = node_displacement(p, q, slip, node, w)
            f0, f1, f2 = node_force(normal, shear, friction, given, whole[node], d0, d1, d2)
            force[node, 0], force[node, 1], force[node, 2] = f0, f1, f2
            if whole[node] == 0.0:
                after[node, 0] += d1 - f1 / shear
                after[node, 1] += d2 - f2 / shear
    return force, after


@compiled
def equilibrium(structure, matrix, target, guess, slip, whole, limits):
    """`newton`, then `node_forces`: whether equilibrium was found, displacements, forces, slip."""
    converged, unknowns = newton(structure, matrix, target, guess, slip, whole, limits, QUICK)
    if not converged:
        converged, unknowns = newton(structure, matrix, target, guess, slip, whole, limits, PATIENT)
    force, after = node_forces(structure, slip, whole, unknowns)
    return converged, unknowns, force, after
