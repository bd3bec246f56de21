"""Newton's method: displacements at which contact nodes carry given forces.

Its linear equations have a band and a border; they are solved by Gaussian elimination.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import all_bonded
from sidmacib.mechanics.newton.faces import move_nodes, norm, tangent_stiffness, unbalanced

STEPS = 60  # of Newton's method, at most
STALLED = 30  # steps in which the unbalanced forces must halve
# The least fraction of a step, and how many steps may be longer than allowed.
QUICK, PATIENT = (0.1, 0), (0.01, 3)
# Line search along a step, where friction is given.
TRIALS = 40  # places, at most
ENOUGH = 0.5  # slope over that at the start of a step: the line search ends below it
RESISTED = 0.99  # slope over that at the start: above it nothing resists, and the step is extended
LONGER = 10.0  # by this factor
NEAREST = 0.02  # distance of the next trial to either end of the bracket, over its length
RESIDUAL_ROUNDING = 1e-14  # unbalanced force over stiffest face times displacement: rounding error
MOST_ROUNDING = 100.0  # over the tolerance: its upper bound, as pieces may move away


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
def elastic(contacts, matrix, here, target, floor):
    """Displacements (m) under the forces ``target`` (N) with all nodes closed and bonded."""
    unknowns = target.copy()
    slip, whole = all_bonded(contacts.places.shape[1])
    tangent_stiffness(contacts, slip, whole, here, floor, matrix)
    solve_linear(contacts, matrix, unknowns)
    return unknowns


@compiled
def stepped(contacts, slip, whole, target, here, start, step, share):
    """Put ``here`` a fraction of ``step`` after ``start``, which are places; see `unbalanced`."""
    for i in range(len(start) if contacts.stiff else len(here.unknowns)):
        here.place[i] = start[i] + share * step[i]
    if not contacts.stiff:
        move_nodes(contacts, here.place)
    return unbalanced(contacts, slip, whole, target, here)


@compiled
def put_at(contacts, slip, whole, target, here, unknowns):
    """Put ``here`` at ``unknowns`` (m); see `unbalanced`."""
    here.unknowns[:] = unknowns
    move_nodes(contacts, here.place)
    return unbalanced(contacts, slip, whole, target, here)


@compiled
def newton_step(contacts, matrix, here, step):
    """Fill in the ``step`` to the next place by the tangent ``matrix``; whether there is one."""
    move = step[: len(here.residual)]
    move[:] = here.residual
    solved = solve_linear(contacts, matrix, move)
    if contacts.stiff:
        move_nodes(contacts, step)
    return solved


@compiled
def newton(contacts, matrix, here, target, guess, slip, whole, limits, patience):
    """Move ``here`` to where the nodes carry ``target`` (N), from the displacements ``guess`` (m).

    ``matrix`` and ``here`` are overwritten. ``slip``, ``whole``: of the nodes. ``limits``: the
    floor of `tangent_stiffness` (N/m) and the largest norms of unbalanced forces (N) and of a step
    (m). A step that does not reduce the unbalanced forces is halved. ``patience``: the least
    fraction of a step, and the number of steps that may exceed the limit, as pieces that come loose
    may return. Returns whether equilibrium was found.
    """
    (floor, allowed, largest_step), (least_share, most_far), far = limits, patience, 0
    start, step = np.empty_like(here.place), np.empty_like(here.place)
    size = put_at(contacts, slip, whole, target, here, guess)
    best, stalled = size, 0
    for _ in range(STEPS):
        if size <= allowed:
            return True
        if size <= best / 2.0:
            best, stalled = size, 0
        elif stalled == STALLED:
            break
        stalled += 1
        tangent_stiffness(contacts, slip, whole, here, floor, matrix)
        if not newton_step(contacts, matrix, here, step):
            break
        far += not norm(step[: len(guess)]) <= largest_step  # true for NaN as well
        if far > most_far:
            break
        before, share = size, 2.0
        start[:] = here.place
        while share == 2.0 or (size > before and share > least_share):
            share /= 2.0
            size = stepped(contacts, slip, whole, target, here, start, step, share)
        if size > before:
            size = stepped(contacts, slip, whole, target, here, start, step, 1.0)
    return False


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
    return min(max(allowed, RESIDUAL_ROUNDING * inside), MOST_ROUNDING * allowed)


@compiled
def least_energy(contacts, matrix, here, target, guess, slip, whole, limits):
    """Move ``here`` to the least energy from the displacements ``guess`` (m), with friction given.

    ``limits``: of the stiffest face and of the floor (N/m), the norm of unbalanced forces (N), and
    the distance (m) beyond which a piece moves away. Returns whether it was found: if the loads
    push pieces away, it is some way off.
    """
    stiffness, floor, allowed, far = limits
    start, step = np.empty_like(here.place), np.empty_like(here.place)
    size, move = put_at(contacts, slip, whole, target, here, guess), step[: len(guess)]
    for _ in range(STEPS):
        if not farthest(here.unknowns, guess) <= far:  # true for NaN as well
            break
        if size <= allowed_at(here.unknowns, stiffness, allowed):
            return True
        tangent_stiffness(contacts, slip, whole, here, floor, matrix)
        if not newton_step(contacts, matrix, here, step):
            break
        steepest, part, tried = product(here.residual, move), 1.0, 0
        low, low_slope, high, high_slope = 0.0, steepest, np.inf, 0.0
        start[:] = here.place
        while True:
            size = stepped(contacts, slip, whole, target, here, start, step, part)
            slope, tried = product(here.residual, move), tried + 1
            if abs(slope) <= ENOUGH * steepest or tried == TRIALS or not np.isfinite(slope):
                break
            if slope > 0.0 and not farthest(here.unknowns, guess) <= far:
                break
            # False position in the Illinois variant, which halves the slope at an end that stays.
            if slope > 0.0 and high == np.inf:
                if slope < RESISTED * steepest and part == 1.0:
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
    return False


@compiled
def equilibrium(contacts, matrix, here, target, guess, slip, whole, limits):
    """`newton`, at first with little patience; returns whether equilibrium was found."""
    nodes = target, guess, slip, whole, limits
    quickly = newton(contacts, matrix, here, *nodes, QUICK)
    return quickly or newton(contacts, matrix, here, *nodes, PATIENT)
