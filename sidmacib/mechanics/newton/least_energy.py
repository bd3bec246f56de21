"""The least energy of pieces at small displacements, where friction has given limits."""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.newton import STEPS, put_at, start_at, stepped
from sidmacib.mechanics.newton.linear import solve_linear
from sidmacib.mechanics.newton.stiffness import tangent_stiffness
from sidmacib.mechanics.newton.vectors import farthest

# Line search along a step.
TRIALS = 40  # places, at most
ENOUGH = 0.5  # slope over that at the start of a step: the line search ends below it
RESISTED = 0.99  # slope over that at the start: above it nothing resists, and the step is extended
LONGER = 10.0  # by this factor
NEAREST = 0.02  # distance of the next trial to either end of the bracket, over its length
RESIDUAL_ROUNDING = 1e-14  # unbalanced force over stiffest face times displacement: rounding error
MOST_ROUNDING = 100.0  # over the tolerance: its upper bound, as pieces may move away


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
    size = put_at(contacts, slip, whole, target, here, guess)
    step = np.empty_like(here.unknowns)
    for _ in range(STEPS):
        if not farthest(here.unknowns, guess) <= far:  # true for NaN as well
            break
        if size <= allowed_at(here.unknowns, stiffness, allowed):
            return True
        tangent_stiffness(contacts, slip, whole, target, here, floor, matrix, 1.0)
        step[:] = here.residual
        if not solve_linear(contacts, matrix, step):
            break
        steepest, part, tried = product(here.residual, step), 1.0, 0
        if not steepest > 0.0:  # pieces that have turned: the energy is not convex
            break
        low, low_slope, high, high_slope = 0.0, steepest, np.inf, 0.0
        start = start_at(here)
        while True:
            size = stepped(contacts, slip, whole, target, here, start, step, part)
            slope, tried = product(here.residual, step), tried + 1
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
