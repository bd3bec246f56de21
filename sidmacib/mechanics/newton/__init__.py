"""Newton's method: displacements at which contact nodes carry given forces."""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import all_bonded
from sidmacib.mechanics.newton.faces import (
    Applied,
    add_turned,
    advance,
    put_pieces,
    unbalanced,
)
from sidmacib.mechanics.newton.linear import solve_linear
from sidmacib.mechanics.newton.stiffness import tangent_stiffness
from sidmacib.mechanics.newton.vectors import norm

STEPS = 60  # at most
STALLED = 30  # steps in which the unbalanced forces must halve
LOST = 10.0  # times the unbalanced forces at first: pieces that bonds keep near do not come back
# The least fraction of a step, and how many steps may be longer than allowed.
QUICK, PATIENT = (0.1, 0), (0.01, 3)
CONTROLLED = 1e-9  # of a motion that is given: how far an equilibrium may be from it


class Start(NamedTuple):
    """What a step starts from, see `sidmacib.mechanics.newton.faces.Point`."""

    unknowns: Floats
    turn: Floats
    apart: Floats


@compiled
def elastic(contacts, matrix, here, target, floor):
    """Displacements (m) under the forces ``target`` (N) with all nodes closed and bonded."""
    unknowns = target.copy()
    slip, whole = all_bonded(contacts.places.shape[1])
    here.unknowns[:] = 0.0
    put_pieces(contacts, here)
    here.sums[:] = 0.0
    none = Applied(target, np.zeros_like(here.turn))
    tangent_stiffness(contacts, slip, whole, none, here, floor, matrix, 1.0)
    solve_linear(contacts, matrix, unknowns)
    return unknowns


@compiled
def start_at(here):
    """A copy of where ``here`` is."""
    return Start(here.unknowns.copy(), here.turn.copy(), here.apart.copy())


@compiled
def stepped(contacts, slip, whole, target, here, start, step, share):
    """Put ``here`` a fraction of ``step`` after ``start``, a `Start`; see `unbalanced`."""
    advance(contacts, here, start, step, share)
    return unbalanced(contacts, slip, whole, target, here)


@compiled
def put_at(contacts, slip, whole, target, here, unknowns):
    """Put ``here`` at ``unknowns`` (m); see `unbalanced`."""
    here.unknowns[:] = unknowns
    put_pieces(contacts, here)
    return unbalanced(contacts, slip, whole, target, here)


@compiled
def newton(contacts, matrix, here, target, guess, slip, whole, limits, patience):
    """Move ``here`` to where the nodes carry ``target``, from the displacements ``guess`` (m).

    ``matrix`` and ``here`` are overwritten. ``slip``, ``whole``: of the nodes. ``limits``: the
    floor of `tangent_stiffness` (N/m) and the largest norms of unbalanced forces (N) and of a step
    (m). A step that does not reduce the unbalanced forces is halved. ``patience``: the least
    fraction of a step, the number of steps that may exceed the limit, as pieces that come loose may
    return, and how far unbalanced forces may grow, over those at first. Returns whether equilibrium
    was found.
    """
    (floor, allowed, largest_step), (least_share, most_far, lost), far = limits, patience, 0
    size = put_at(contacts, slip, whole, target, here, guess)
    step = np.empty_like(here.unknowns)
    best, first, stalled = size, size, 0
    for _ in range(STEPS):
        if size <= allowed:
            return True
        if size <= best / 2.0:
            best, stalled = size, 0
        elif stalled == STALLED:
            break
        stalled += 1
        tangent_stiffness(contacts, slip, whole, target, here, floor, matrix, 1.0)
        step[:] = here.residual
        if not solve_linear(contacts, matrix, step):
            break
        far += not norm(step) <= largest_step  # true for NaN as well
        if far > most_far:
            break
        before, share, start = size, 2.0, start_at(here)
        while share == 2.0 or (size > before and share > least_share):
            share /= 2.0
            size = stepped(contacts, slip, whole, target, here, start, step, share)
        if size > before:
            size = stepped(contacts, slip, whole, target, here, start, step, 1.0)
            if not size <= lost * first:
                break
    return False


@compiled
def controlled(bordered, matrix, here, loads, guess, load, moved, slip, whole, limits):
    """Move ``here`` to equilibrium where the pieces have ``moved`` (m) along the raised load.

    Its size is an unknown more: ``bordered`` contacts have one more outer unknown, behind all
    others. ``loads``: the permanent and the raised ones, per newton, both `Applied`; ``guess`` and
    ``load``: unknowns (m) and size (N) to begin with. ``limits``: floor, unbalanced forces and
    longest step of `newton`. Returns whether equilibrium was found, and the size.
    """
    (permanent, raised), (floor, allowed, largest_step) = loads, limits
    size, inner = len(guess), bordered.inner
    target = Applied(np.empty_like(permanent.wrench), np.empty_like(permanent.levers))
    put_raised(target, permanent, raised, load)
    left = put_at(bordered, slip, whole, target, here, guess)
    pull, step = np.empty(size), np.empty(size + 1)
    for _ in range(STEPS):
        ahead = moved
        for i in range(size):
            ahead -= raised.wrench[i] * here.unknowns[i]
        if left <= allowed and abs(ahead) <= CONTROLLED * abs(moved):
            return True, load
        tangent_stiffness(bordered, slip, whole, target, here, floor, matrix, 1.0)
        pull[:] = raised.wrench
        for piece in range(len(here.turn)):
            levers, turn = raised.levers[piece], here.turn[piece]
            add_turned(levers, turn, 6 * piece + 3, bordered.length, pull)
        matrix.right[:, -1] = -pull[:inner]
        matrix.below[:-1, -1] = -pull[inner:]
        matrix.below[-1, :-1] = raised.wrench
        matrix.below[-1, -1] = 0.0
        step[:size], step[size] = here.residual, ahead
        if not solve_linear(bordered, matrix, step) or not norm(step[:size]) <= largest_step:
            break
        before, share, at, start = left, 2.0, load, start_at(here)
        while share == 2.0 or (left > before and share > QUICK[0]):
            share /= 2.0
            load = at + share * step[size]
            put_raised(target, permanent, raised, load)
            left = stepped(bordered, slip, whole, target, here, start, step, share)
    return False, load


@compiled
def put_raised(target, permanent, raised, load):
    """Fill in the ``permanent`` loads and ``load`` times the ``raised`` ones."""
    target.wrench[:] = permanent.wrench + load * raised.wrench
    target.levers[:] = permanent.levers + load * raised.levers
