"""One free block on fixed ones by explicit relaxation: its rotations finite, or linearised.

The contact law is that of the static model: the same nodes, stiffnesses and friction with its
history. The free block carries its nodes with it; where they press and rub, the planes of the
fixed blocks stay. Gravity turns in steps; at each the block moves, with local damping as in
distinct elements, until it rests. An angle at which it does not come to rest is beyond the critical
one. All this shares no solver with the static model, and with linearised rotations must find its
angle; with finite ones it sees wedging that small rotations bring about.
"""

# mypy: allow-untyped-defs

import math

import numpy as np
from numba import njit

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, face_frames
from sidmacib.structure.analysis.tilt import LARGEST, Tilt

STEP = 0.25  # degrees
STEPS = 2_000_000  # of time, in which the block must come to rest
DAMPING = 0.7  # part of the unbalanced force, against the velocity
AT_REST = 1e-7  # unbalanced force over the weight
AWAY = 0.2  # of the length: a block that moves so far does not return
HEAVY = 2.0  # mass over the least at which time steps of 1 are stable, as a bound from row sums


def relaxed_tilt(assembly: Assembly, tilt: Tilt, *, finite: bool) -> float:
    """The last angle (degrees, in steps of 0.25) at which the only free block comes to rest.

    ValueError unless one block is free and every face is dry.
    """
    law = ContactLaw.of(assembly)
    free = [number for number, piece in enumerate(assembly.pieces) if not piece.fixed]
    if len(free) != 1 or law.cohesive.any():
        raise ValueError("relaxation: one block must be free, and all faces dry")
    block = assembly.pieces[free[0]]
    above = np.array([face.above == free[0] for face in assembly.faces])[assembly.nodes.face]
    springs = np.column_stack([law.normal_stiffness, law.shear_stiffness, law.friction])
    rows = equilibrium_matrix(assembly)[6 * free[0] : 6 * free[0] + 6].toarray()
    stiffness = np.abs(rows * springs[:, [0, 1, 1]].ravel() @ rows.T).sum(axis=1)
    mass = HEAVY * np.array([stiffness[:3].max(), stiffness[3:].max()])
    arms = assembly.nodes.position - block.centre
    state = np.zeros(3), np.zeros(3), np.zeros((len(arms), 2))
    sign = np.where(above, 1.0, -1.0)
    still = 0.0
    for angle in np.arange(0.0, LARGEST + STEP / 2, STEP).tolist():
        gravity = block.weight * tilt.gravity(angle)
        frames = np.ascontiguousarray(face_frames(assembly))
        if not _rests(springs, frames, sign, arms, mass, gravity, assembly.length, finite, state):
            return still
        still = angle
    return LARGEST


@njit(cache=True)
def _cross(a, b):
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


@njit(cache=True)
def _turned(arm, rotation):
    """The ``arm`` (3,) turned by a rotation vector (Rodrigues)."""
    angle = math.sqrt((rotation * rotation).sum())
    if angle == 0.0:
        return arm.copy()
    axis = rotation / angle
    along = (axis * arm).sum()
    return (
        arm * math.cos(angle)
        + _cross(axis, arm) * math.sin(angle)
        + axis * along * (1.0 - math.cos(angle))
    )


@njit(cache=True)
def _rests(springs, frames, sign, arms, mass, gravity, length, finite, state):
    """Whether the block comes to rest under ``gravity`` (N); ``state`` goes on from where it is."""
    place, rotation, slip = state
    velocity, spin = np.zeros(3), np.zeros(3)
    weight = math.sqrt((gravity * gravity).sum())
    for _ in range(STEPS):
        force, moment = gravity.copy(), np.zeros(3)
        for node in range(len(arms)):
            normal, shear, friction = springs[node]
            arm = arms[node]
            if finite:
                now = _turned(arm, rotation)
                moved = place + now - arm
            else:
                now = arm
                moved = place + _cross(rotation, arm)
            frame = frames[node]
            d0 = -sign[node] * (frame[0] * moved).sum()
            d1 = -sign[node] * (frame[1] * moved).sum()
            d2 = -sign[node] * (frame[2] * moved).sum()
            pressed = normal * max(d0, 0.0)
            t1, t2 = shear * (d1 - slip[node, 0]), shear * (d2 - slip[node, 1])
            size = math.sqrt(t1 * t1 + t2 * t2)
            if size > friction * pressed:
                t1 *= friction * pressed / size
                t2 *= friction * pressed / size
            slip[node, 0], slip[node, 1] = d1 - t1 / shear, d2 - t2 / shear
            on = sign[node] * (frame[0] * pressed + frame[1] * t1 + frame[2] * t2)
            force += on
            moment += _cross(now, on)
        off = math.sqrt((force * force).sum()) + math.sqrt((moment * moment).sum()) / length
        if off <= AT_REST * weight:
            return True
        velocity += (force - DAMPING * np.abs(force) * np.sign(velocity)) / mass[0]
        spin += (moment - DAMPING * np.abs(moment) * np.sign(spin)) / mass[1]
        place += velocity
        rotation += spin
        if np.abs(place).max() > AWAY * length:
            return False
    return False
