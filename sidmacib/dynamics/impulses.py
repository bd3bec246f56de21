"""Steps of impulses in time (Moreau 1988; Jean 1999): compiled.

In a step of h, blocks move for h / 2 with the velocities they have; contacts are found there; the
impulses of loads and contacts change the velocities, with which blocks move for the other half. At
a contact with the gap g the normal velocity u and impulse r obey

    r >= 0,  u + max(g, 0) / h >= 0,  r (u + max(g, 0) / h) = 0

so that a gap may close and a closed contact may not be pressed in: impacts are inelastic. With a
coefficient of restitution e, a contact that closes leaves with e times its velocity before (Newton,
Moreau). Friction opposes sliding, by at most mu r. Contacts are solved one after the other, again
and again, beginning with the impulses of the step before (nonlinear Gauss and Seidel).

M. Jean, The non-smooth contact dynamics method, Computer Methods in Applied Mechanics and
Engineering 177, 1999, 235-257, doi:10.1016/S0045-7825(98)00383-1.
"""

# mypy: allow-untyped-defs

from collections import namedtuple

import numpy as np

from sidmacib.dynamics.bodies import Frames, accelerate, advance, put_frames
from sidmacib.dynamics.contacts import Places, find_contacts, put_solids
from sidmacib.dynamics.roots import note_used
from sidmacib.mechanics.compilation import compiled

FEWEST, MOST = 100, 5_000  # sweeps over the contacts in a step
UPDATES = 1_000_000  # of contacts in a step, unless these are more
TOLERANCE = 1e-6  # over the largest velocity: changes at which all impulses are found

# Of contacts: `arms` from both centroids times the axes, and `turned` by the inverse inertia, both
# (K, 2, 3, 3); `yields`: impulses for a normal and a tangential velocity of 1; `wanted`: the least
# normal velocity.
Work = namedtuple("Work", "arms turned yields wanted")
# What acts: `forces`, `levers`, accelerations of the `ground` in each step, see `accelerate`; `h`:
# the step, s; `restitution`; `unit`: what gravity adds to velocities, m/s.
Acting = namedtuple("Acting", "forces levers ground h restitution unit")


@compiled
def _velocity(state, contacts, work, c, k):
    """Of the other body from the one along the axis ``k`` of a contact."""
    a, b, f = contacts.one[c], contacts.other[c], contacts.frame[c, k]
    one, other = work.arms[c, 0, k], work.arms[c, 1, k]
    u = 0.0
    for i in range(3):
        u += f[i] * (state.speed[b, i] - state.speed[a, i])
        u += other[i] * state.spin[b, i] - one[i] * state.spin[a, i]
    return u


@compiled
def _arms(bodies, state, frames, contacts, work, c, w):
    """Fill the arms of a contact, and the velocities ``w`` along its axes that impulses give."""
    for side in range(2):
        p = contacts.one[c] if side == 0 else contacts.other[c]
        x = contacts.place[c, 0] - state.centre[p, 0]
        y = contacts.place[c, 1] - state.centre[p, 1]
        z = contacts.place[c, 2] - state.centre[p, 2]
        for k in range(3):
            d, arm = contacts.frame[c, k], work.arms[c, side, k]
            arm[0], arm[1] = y * d[2] - z * d[1], z * d[0] - x * d[2]
            arm[2] = x * d[1] - y * d[0]
            for i in range(3):
                work.turned[c, side, k, i] = 0.0
                if bodies.mass[p] > 0.0:
                    for j in range(3):
                        work.turned[c, side, k, i] += frames.inverse[p, i, j] * arm[j]
        for k in range(3):
            for n in range(3):
                for i in range(3):
                    w[k, n] += work.arms[c, side, k, i] * work.turned[c, side, n, i]
            w[k, k] += 0.0 if bodies.mass[p] == 0.0 else 1.0 / bodies.mass[p]


@compiled
def _prepare(bodies, state, frames, contacts, acting):
    """The work of contacts; velocities are those before the step."""
    count = contacts.count[0]
    work = Work(
        np.empty((count, 2, 3, 3)),
        np.empty((count, 2, 3, 3)),
        np.empty((count, 2)),
        np.empty(count),
    )
    for c in range(count):
        w = np.zeros((3, 3))
        _arms(bodies, state, frames, contacts, work, c, w)
        apart = np.sqrt((0.5 * (w[1, 1] - w[2, 2])) ** 2 + w[1, 2] ** 2)
        work.yields[c, 0] = 1.0 / w[0, 0]
        work.yields[c, 1] = 1.0 / (0.5 * (w[1, 1] + w[2, 2]) + apart)
        gap, u = contacts.gap[c], _velocity(state, contacts, work, c, 0)
        work.wanted[c] = -max(gap, 0.0) / acting.h
        if acting.restitution > 0.0 and u < 0.0 and gap + acting.h * u <= 0.0:
            work.wanted[c] = -acting.restitution * u
    return work


@compiled
def _apply(speed, spin, a, b, shares, frame, turned, c, r0, r1, r2):
    """Add the velocities that an impulse at a contact gives to both bodies."""
    one, other = shares[a], shares[b]
    for i in range(3):
        r = r0 * frame[c, 0, i] + r1 * frame[c, 1, i] + r2 * frame[c, 2, i]
        speed[a, i] -= one * r
        speed[b, i] += other * r
        spin[a, i] -= r0 * turned[c, 0, 0, i] + r1 * turned[c, 0, 1, i] + r2 * turned[c, 0, 2, i]
        spin[b, i] += r0 * turned[c, 1, 0, i] + r1 * turned[c, 1, 1, i] + r2 * turned[c, 1, 2, i]


@compiled
def _solve(bodies, state, contacts, work, unit):
    """Find all impulses, and the velocities that they leave: the change that is left.

    In one function, on arrays, as it takes nearly all of the time.
    """
    count, shares = contacts.count[0], np.zeros(len(bodies.mass))
    for p in range(len(shares)):
        if bodies.mass[p] > 0.0:
            shares[p] = 1.0 / bodies.mass[p]
    speed, spin = state.speed, state.spin
    one, other, frame, impulse = contacts.one, contacts.other, contacts.frame, contacts.impulse
    arms, turned, yields, wanted = work.arms, work.turned, work.yields, work.wanted
    for c in range(count):
        r0, r1, r2 = impulse[c, 0], impulse[c, 1], impulse[c, 2]
        _apply(speed, spin, one[c], other[c], shares, frame, turned, c, r0, r1, r2)
    sweeps = min(max(FEWEST, UPDATES // max(count, 1)), MOST)
    for sweep in range(sweeps):
        change, largest = 0.0, unit  # of impulses, by the velocities that they give alone
        for k in range(count):
            c = count - 1 - k if sweep % 2 else k
            a, b = one[c], other[c]
            u0 = u1 = u2 = 0.0
            for i in range(3):
                v, x, y = speed[b, i] - speed[a, i], spin[b, i], spin[a, i]
                u0 += frame[c, 0, i] * v + arms[c, 1, 0, i] * x - arms[c, 0, 0, i] * y
            r0 = max(impulse[c, 0] - yields[c, 0] * (u0 - wanted[c]), 0.0)
            if r0 == 0.0 and impulse[c, 0] == 0.0:
                continue  # open
            for i in range(3):
                v, x, y = speed[b, i] - speed[a, i], spin[b, i], spin[a, i]
                u1 += frame[c, 1, i] * v + arms[c, 1, 1, i] * x - arms[c, 0, 1, i] * y
                u2 += frame[c, 2, i] * v + arms[c, 1, 2, i] * x - arms[c, 0, 2, i] * y
            r1, r2 = impulse[c, 1] - yields[c, 1] * u1, impulse[c, 2] - yields[c, 1] * u2
            most, size = contacts.mu[c] * r0, np.sqrt(r1 * r1 + r2 * r2)
            if size > most:
                r1, r2 = r1 * most / size, r2 * most / size
            d0, d1, d2 = r0 - impulse[c, 0], r1 - impulse[c, 1], r2 - impulse[c, 2]
            if d0 != 0.0 or d1 != 0.0 or d2 != 0.0:
                _apply(speed, spin, a, b, shares, frame, turned, c, d0, d1, d2)
                impulse[c, 0], impulse[c, 1], impulse[c, 2] = r0, r1, r2
                change = max(change, abs(d0) / yields[c, 0], max(abs(d1), abs(d2)) / yields[c, 1])
            largest = max(largest, r0 / yields[c, 0])
        if change <= TOLERANCE * largest:
            break
    return change / largest


@compiled
def _farthest(one, other):
    """The largest distance between points of the same number, squared."""
    most = 0.0
    for k in range(len(one)):
        apart = 0.0
        for i in range(3):
            apart += (one[k, i] - other[k, i]) ** 2
        most = max(most, apart)
    return most


@compiled
def steps(solids, built, bodies, state, pairs, contacts, acting, near, start, told, roots, used):
    """Steps, one for each row of the ground's accelerations: the number of steps made.

    Until a vertex has moved by more than ``near`` (m) from where it was at the ``start``, (V, 3),
    so that other pairs may come together. ``contacts``: those of the step before, and room for the
    next; after an odd number of steps they have changed places. ``told``: has the largest change
    that was left, over the largest impulse, the least gap (m), and 1 if a vertex has moved so far.
    ``used``: of the strength of ``roots``, see `note_used`.
    """
    count = len(bodies.mass)
    frames = Frames(np.empty((count, 3, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3, 3)))
    places = Places(
        np.empty_like(built.vertices), np.empty_like(built.normals), np.empty_like(built.edges)
    )
    before, now = contacts
    velocities = np.empty_like(state.speed), np.empty_like(state.spin)
    bonded = len(roots.body) > 0
    for step in range(len(acting.ground)):
        advance(bodies, state, 0.5 * acting.h)
        put_frames(bodies, state, frames)
        put_solids(solids, built, state.centre, frames.turn, places)
        find_contacts(solids, places, pairs, near, before, now)
        work = _prepare(bodies, state, frames, now, acting)
        if bonded:
            velocities[0][:], velocities[1][:] = state.speed, state.spin
        accelerate(
            bodies, state, frames, acting.forces, acting.levers, acting.ground[step], acting.h
        )
        left = _solve(bodies, state, now, work, acting.unit)
        if bonded:
            ground = acting.ground[step]
            note_used(roots, pairs, now, state, frames, velocities, acting, ground, used)
        before, now = now, before
        advance(bodies, state, 0.5 * acting.h)
        told[0] = max(told[0], left)
        for c in range(before.count[0]):
            told[1] = min(told[1], before.gap[c])
        if _farthest(places.vertices, start) > near * near:
            told[2] = 1.0
            return step + 1
    return len(acting.ground)
