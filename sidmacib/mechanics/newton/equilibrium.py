"""Newton's method: displacements at which contact nodes carry given forces."""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.newton.compilation import compiled
from sidmacib.mechanics.newton.elimination import solve_linear
from sidmacib.mechanics.newton.faces import (
    FRICTION,
    GIVEN,
    NORMAL,
    SHEAR,
    P,
    Q,
    face_motion,
    node_displacement,
    norm,
    tangent_stiffness,
    unbalanced,
)
from sidmacib.mechanics.newton.node_law import node_force

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


@compiled
def node_forces(structure, slip, whole, unknowns):
    """Forces (N) of all nodes, (N, 3), and their slip (m) after this equilibrium, (N, 2)."""
    w, force, after = np.empty(6), np.empty((len(slip), 3)), slip.copy()
    nodes = structure.nodes
    for face in range(len(structure.begin)):
        face_motion(structure, face, unknowns, w)
        for node in range(structure.start[face], structure.start[face + 1]):
            normal, shear = nodes[node, NORMAL], nodes[node, SHEAR]
            friction, given = nodes[node, FRICTION], nodes[node, GIVEN]
            d0, d1, d2 = node_displacement(nodes[node, P], nodes[node, Q], slip, node, w)
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
