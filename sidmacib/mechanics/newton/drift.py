"""Pieces that drift against drag: to rest where Newton's method finds none, or away.

Where an equilibrium is lost, pieces move on until they rest elsewhere: a loose brick that is pushed
out of its place, while the wall stands. Drag in place of inertia leads to the same rest, if there
is one nearby, with friction that follows the way there.
"""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.newton import QUICK, STEPS, put_at, start_at, stepped
from sidmacib.mechanics.newton.faces import put_slips
from sidmacib.mechanics.newton.linear import negative_pivots, solve_linear
from sidmacib.mechanics.newton.stiffness import tangent_stiffness
from sidmacib.mechanics.newton.vectors import farthest, norm

DRIFTS = 300  # steps of time, at most
# Steps of Newton's method after which the next step of time is much longer, or longer; and how much
# shorter the next is where it fails.
AT_ONCE, FASTER = 4, 8.0
SOON, SLOWER = 12, 2.0
NEARLY = 1e-3  # of the unbalanced forces before a step of time: what it may leave of them
TRIES = 20  # of a step: of Newton's method
MOST_DRAG = 1e4  # over that at the start: more hold nothing that less does not


@compiled
def settled(contacts, matrix, here, target, guess, slip, whole, limits):
    """Let the pieces drift from ``guess`` (m) until they rest; whether they do.

    Drag holds them: c times the displacement in a step of time, as in a viscous fluid. Friction has
    its history from step to step: ``slip`` (m), (2, N), is that of the last one. Steps that
    Newton's method solves at once are followed by longer ones (less drag), others are shorter; so
    are those that would end at rest where it is not stable. Where pieces rest without drag there
    is equilibrium. ``limits``: drag at the start and floor (N/m), norm of unbalanced forces (N),
    and the distance (m) beyond which a piece moves away.
    """
    drag, floor, allowed, most = limits
    put_at(contacts, slip, whole, target, here, guess)
    drift = np.empty_like(guess)
    for _ in range(DRIFTS):
        rest = start_at(here)
        enough = max(allowed, NEARLY * norm(here.residual)) if drag > floor else allowed
        tries = drifted(contacts, matrix, here, target, slip, whole, drift, (drag, enough, most))
        if not farthest(here.unknowns, guess) <= most or drag > MOST_DRAG * limits[0]:
            return False
        if tries == TRIES or falls(contacts, slip, whole, target, matrix, here, drag):
            stepped(contacts, slip, whole, target, here, rest, drift, 0.0)
            drag *= SLOWER
            continue
        if drag <= floor:
            return True
        put_slips(contacts, slip, whole, here, slip)
        if norm(here.residual) <= allowed:
            drag = floor
        elif tries <= AT_ONCE:
            drag = max(drag / FASTER, floor)
        elif tries <= SOON:
            drag = max(drag / SLOWER, floor)
    return False


@compiled
def drifted(contacts, matrix, here, target, slip, whole, drift, limits):
    """Move ``here`` on by a step of time, and put that way into ``drift`` (m).

    ``limits``: drag (N/m), norm of unbalanced forces (N), the longest step (m). Returns the number
    of steps of Newton's method, `TRIES` where it fails.
    """
    drag, allowed, most = limits
    step, before = np.empty_like(drift), np.empty_like(drift)
    drift[:] = 0.0
    left = norm(here.residual)
    for tries in range(1, TRIES):
        tangent_stiffness(contacts, slip, whole, target, here, drag, matrix, 1.0)
        for i in range(len(step)):
            step[i] = here.residual[i] - drag * drift[i]
        solved = solve_linear(contacts, matrix, step)
        if not (solved and farthest(step, np.zeros_like(step)) <= most):
            break
        start = start_at(here)
        before[:] = drift
        share, last = 2.0, left
        while share == 2.0 or (left > last and share > QUICK[0]):
            share /= 2.0
            stepped(contacts, slip, whole, target, here, start, step, share)
            left = 0.0
            for i in range(len(step)):
                drift[i] = before[i] + share * step[i]
                left += (here.residual[i] - drag * drift[i]) ** 2
            left = np.sqrt(left)
        if left <= allowed:
            return tries
    return TRIES


@compiled
def falls(contacts, slip, whole, target, matrix, here, drag):
    """Whether pieces ``here`` move away from rest against ``drag`` (N/m).

    Where friction rises with pressure the matrix is not symmetric, and negative pivots may be false
    alarms. With friction as it is they are eigenvalues, but pieces that are wedged the more
    the further they go seem to fall. So both are asked.
    """
    for rise in (0.0, 1.0):
        tangent_stiffness(contacts, slip, whole, target, here, drag, matrix, rise)
        if not negative_pivots(contacts, matrix):
            return False
    return True


@compiled
def pushed(contacts, matrix, here, target, guess, slip, whole, drag, most):
    """Move ``here`` on from ``guess`` (m) under forces that nothing but ``drag`` (N/m) carries.

    As far as ``most`` (m) in one unknown. Where nothing resists, every step is long.
    """
    put_at(contacts, slip, whole, target, here, guess)
    step = np.empty_like(here.unknowns)
    for _ in range(STEPS):
        tangent_stiffness(contacts, slip, whole, target, here, drag, matrix, 1.0)
        step[:] = here.residual
        if not solve_linear(contacts, matrix, step):
            break
        longest = farthest(step, np.zeros_like(step))
        if not np.isfinite(longest):
            break
        start = start_at(here)
        left = most - farthest(here.unknowns, guess)
        if longest >= left:
            stepped(contacts, slip, whole, target, here, start, step, left / longest)
            break
        stepped(contacts, slip, whole, target, here, start, step, 1.0)
