"""Tilts of dry blocks by methods that share no solver with the static model.

*Explicit relaxation* of one free block on fixed ones, its rotations finite, or linearised. The
contact law is that of the static model: the same nodes, stiffnesses and friction with its history.
The free block carries its nodes with it; where they press and rub, the planes of the fixed blocks
stay. Gravity turns in steps; at each the block moves, with local damping as in distinct elements,
until it rests. An angle at which it does not come to rest is beyond the critical one. With
linearised rotations this must find the angle of the static model; with finite ones it sees wedging
that small rotations bring about.

*Rigid-block equilibrium* (RBE) with a friction pyramid, as a linear programme, and in compas_cra.
In place of each friction cone there is a pyramid of eight sides around it: along its edges it
allows 8 % more shear than the cone. The programme is solved by HiGHS. compas_cra is of the extra
``peers``; there is no verdict of it where it is not installed.
"""

# mypy: allow-untyped-defs

import importlib.util
import io
import math
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from scipy.optimize import linprog
from scipy.sparse import block_diag, csr_array, diags_array, hstack

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, face_frames, free_rows, row_units
from sidmacib.mechanics.loads import Loads
from sidmacib.structure.analysis.limit import SECTOR
from sidmacib.structure.analysis.tilt import LARGEST, turned
from studies.structures.shapes import HEAVY, Sample

STEP = 0.25  # degrees
STEPS = 2_000_000  # of time, in which the block must come to rest
DAMPING = 0.7  # part of the unbalanced force, against the velocity
AT_REST = 1e-7  # unbalanced force over the weight
AWAY = 0.2  # of the length: a block that moves so far does not return
MARGIN = 2.0  # mass over the least at which time steps of 1 are stable, as a bound from row sums
PYRAMID_SIDES = 8
INFEASIBLE, UNBOUNDED = 2, 3  # of HiGHS, as SciPy has it
INSTALLED = all(map(importlib.util.find_spec, ("compas", "compas_assembly", "compas_cra")))
TENSION = 1e-3  # of the sum of compressions: more is needed only by what is unstable
NEAR, LEAST_AREA = 1e-4, 1e-6  # m and m2, of interfaces that it finds, as in its examples
STABLE, UNSTABLE = "stable", "unstable"


# --- explicit relaxation -------------------------------------------------------------------------
def relaxed_tilt(assembly: Assembly, tilt: Loads, *, finite: bool) -> float:
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
    mass = MARGIN * np.array([stiffness[:3].max(), stiffness[3:].max()])
    arms = assembly.nodes.position - block.centre
    state = np.zeros(3), np.zeros(3), np.zeros((len(arms), 2))
    sign = np.where(above, 1.0, -1.0)
    still = 0.0
    for angle in np.arange(0.0, LARGEST + STEP / 2, STEP).tolist():
        gravity = turned(tilt, angle).permanent[free[0], :3]
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


# --- rigid-block equilibrium ---------------------------------------------------------------------
def pyramid_tilt(assembly: Assembly, tilt: Loads) -> float | None:
    """The smallest angle (degrees) beyond which no forces in the pyramids carry gravity.

    For dry assemblies and level axes. None if there are none upright.
    """
    if _tangent(assembly, tilt, 0.0, most=0.0) is None:
        return None
    for begin in np.arange(0.0, LARGEST, SECTOR).tolist():
        tangent = _tangent(assembly, tilt, begin)
        if tangent is None:  # at the very end of the sector before
            return float(begin)
        further = math.degrees(math.atan(tangent))
        if further < SECTOR:
            return float(begin + further)
    return LARGEST


def _tangent(assembly: Assembly, tilt: Loads, begin: float, most: float = math.inf) -> float | None:
    """The largest tangent, at most ``most``, of an angle beyond ``begin`` that is carried."""
    rows, units = free_rows(assembly), row_units(assembly)
    ahead = turned(tilt, begin)
    beside = turned(tilt, begin + 90.0)
    weight, across = (load.permanent.ravel()[rows] / units / load.scale for load in (ahead, beside))
    balance = diags_array(1.0 / units) @ equilibrium_matrix(assembly)[rows]
    count = len(assembly.nodes.area)
    limits = _pyramids(ContactLaw.of(assembly).friction)
    found = linprog(
        np.append(np.zeros(3 * count), -1.0),
        A_ub=hstack([limits, csr_array((limits.shape[0], 1))]),
        b_ub=np.zeros(limits.shape[0]),
        A_eq=hstack([balance, csr_array(-across[:, None])]),
        b_eq=weight,
        bounds=[*[(0.0, None), (None, None), (None, None)] * count, (0.0, most)],
        method="highs",
    )
    if found.status == UNBOUNDED:
        return math.inf
    return None if found.status == INFEASIBLE else float(found.x[-1])


def _pyramids(friction: Floats) -> csr_array:
    """Rows that are 0 at most where shear is inside the pyramid, (8 N, 3 N)."""
    angle = 2.0 * np.pi * np.arange(PYRAMID_SIDES) / PYRAMID_SIDES
    sides = np.column_stack([np.cos(angle), np.sin(angle)])
    blocks = np.zeros((len(friction), PYRAMID_SIDES, 3))
    blocks[:, :, 0], blocks[:, :, 1:] = -friction[:, None], sides
    return csr_array(block_diag(blocks))


def rbe_verdict(path: Path, sample: Sample) -> str | None:
    """Whether rigid-block equilibrium of compas_cra needs no tension; None without compas_cra."""
    if not INSTALLED:
        return None
    from compas_cra.equilibrium import rbe_solve

    with redirect_stdout(io.StringIO()):  # it prints its progress
        assembly = _assembly(path, sample)
        try:
            rbe_solve(assembly, mu=sample.friction, density=1.0)
        except ValueError as error:
            return f"no answer ({error})"
    pull = push = 0.0
    for edge in assembly.graph.edges():
        for interface in assembly.graph.edge_attribute(edge, "interfaces"):
            pull += sum(force["c_nn"] for force in interface.forces)
            push += sum(force["c_np"] for force in interface.forces)
    return STABLE if pull <= TENSION * push else UNSTABLE


def _assembly(path: Path, sample: Sample) -> Any:
    """The sample as compas_cra has it, with supports, densities and interfaces."""
    import compas
    from compas_cra.algorithms import assembly_interfaces_numpy
    from compas_cra.datastructures import CRA_Assembly
    from compas_cra.equilibrium import density_setup

    assembly = compas.json_load(str(path)).copy(cls=CRA_Assembly)
    if sample.fixed is not None:
        assembly.set_boundary_conditions(list(sample.fixed))
    if sample.heavy:
        nodes = assembly.graph.nodes()
        density_setup(assembly, {n: HEAVY if n in sample.heavy else 1.0 for n in nodes})
    if not sample.own_interfaces:
        assembly_interfaces_numpy(assembly, nmax=10, amin=LEAST_AREA, tmax=NEAR)
    return assembly
