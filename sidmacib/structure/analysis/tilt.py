"""Gravity that turns: the angle at which a structure that is tilted has no equilibrium.

Other permanent loads stay as they are while gravity turns, as forces between the tilted blocks and
what is tilted with them do. What is heavy itself, such as a surcharge of earth, is a block.

Gravity turns about a horizontal or any other axis, from straight down, by the right-hand rule. To
turn a structure about an axis by an angle is to turn gravity by the opposite angle. Blocks weigh
the same throughout; as everywhere in the models, they are where they were built, so that only
motions much smaller than the blocks are described.

`static_tilt` follows the history of friction; `limit_tilt` asks only whether any admissible forces
carry gravity at an angle.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sidmacib.errors import DOES_NOT_STAND, NoEquilibriumError, NoStiffnessError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.equilibrium import equilibrium_matrix, motion_of, row_units
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.raised import A_LOAD, Tilt
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium, Mode, OtherSearches
from sidmacib.mechanics.static import brittle_path
from sidmacib.mechanics.static.path import INCREMENT
from sidmacib.structure.loads import Permanent, beside_of, free_weight, permanent_only

LARGEST = 180.0  # degrees
STEP = 0.25  # degrees: largest increment, or a hundredth of the angle where that is more
PRECISION = 1e-4  # of an angle, over itself
# Degrees beyond the critical angle at which the motion of the blocks is looked for, in this order.
BEYOND = (0.1, 0.03, 0.3, 0.01, 1.0)
LOOSE = 100.0  # motion over the displacements of the last equilibrium, at least
STILL = 1e-6  # least motion of centroids that counts, over the rotations times the length
CLOSED = 1e-3  # of the largest relative motion: a node that opens by less stays closed
EQUAL = 1e-3  # of sliding and opening: they count as equally far
LEVEL = 1e-9  # of an axis: its part along gravity that counts as none


class Motion(StrEnum):
    """Motion of the blocks where equilibrium is lost."""

    SLIDING = "sliding"  # where blocks stay in contact they slide, at least as far as others open
    ROCKING = "rocking"  # joints open further than any that stays closed slides
    BONDS = "bonds"  # bonds fail, and no equilibrium follows


@dataclass(frozen=True)
class StaticTilt:
    """The path of the static model as gravity turns; angles in degrees.

    ``first_failure``: where the first bond fails, or the critical angle if none does. ``path``:
    equilibria, whose ``load`` is the angle. ``motion``: how the blocks move beyond the last.
    ``mechanism``: these motions, displacements (m) and rotations (rad), (P, 6), the largest
    displacement or rotation times the assembly's length being 1 m; None where bonds fail.
    """

    first_failure: float
    path: tuple[Equilibrium, ...]
    motion: Motion
    mechanism: Floats | None

    @property
    def angle(self) -> float:
        """The critical angle: of the last equilibrium."""
        return self.path[-1].load


def tilting(assembly: Assembly, axis: Sequence[float], beside: Permanent | None = None) -> Loads:
    """The weight of all free pieces under gravity that turns about ``axis``, as a raised load.

    In N: the angle in radians times the weight. ``beside``: permanent loads that do not turn.
    """
    x, y, z = (np.array(axis) / np.linalg.norm(axis)).tolist()
    upright, weight = permanent_only(assembly, beside), free_weight(assembly)
    raised = Tilt(math.radians(weight), (x, y, z))
    return replace(turning(replace(upright, scale=weight, raised=raised), 0.0), raised=raised)


def turned(loads: Loads, angle: float) -> Loads:
    """The permanent part of ``loads`` by `tilting`, at an ``angle`` (degrees)."""
    permanent = loads.at(loads.raised.newtons(angle))
    return replace(loads, permanent=permanent, variable=np.zeros_like(permanent), raised=A_LOAD)


def turning(loads: Loads, angle: float) -> Loads:
    """Gravity at ``angle`` (degrees); the variable load, per newton, is how it goes on to turn."""
    assert loads.raised.axis, "gravity turns"
    on = turned(loads, angle)
    gravity = on.permanent - beside_of(loads).wrenches
    change = np.zeros_like(gravity)
    change[:, :3] = np.cross(loads.raised.axis, gravity[:, :3]) / on.scale
    return replace(on, variable=change)


def static_tilt(assembly: Assembly, loads: Loads) -> StaticTilt:
    """Turn gravity until the static model of ``assembly``, of rigid pieces, has no equilibrium.

    ``loads``: by `tilting`.
    Accurate to 1e-4 of the angle for the path with friction that the increments follow; these are
    halved until the first failure converges. `NoEquilibriumError` if the assembly does not stand
    upright, `UnboundedError` if it is in equilibrium up to 180 degrees, `NoStiffnessError` for
    contact points in place of locks.
    """
    if reason := assembly.without_stiffness:
        raise NoStiffnessError(reason)
    solver = Turning(assembly, loads)
    found, last = brittle_path(solver)
    if found.mode is Mode.BONDS:
        return StaticTilt(found.first_failure_load, found.path, Motion.BONDS, None)
    mechanism = solver.mechanism(last)
    motion = _kind_of_motion(assembly, mechanism)
    return StaticTilt(found.first_failure_load, found.path, motion, mechanism)


class Turning(OtherSearches):
    """Equilibria under gravity that turns; the load is the angle in degrees.

    ``loads``: by `tilting`.
    """

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        self.assembly, self.loads = assembly, loads
        self.upright = RigidSolver(assembly, turned(loads, 0.0))
        super().__init__(self.upright)
        self.scale, self.precision = STEP / INCREMENT, PRECISION

    def at(self, angle: float) -> RigidSolver:
        """The solver under gravity that has turned by an ``angle``."""
        return self.upright.under(turned(self.loads, angle))

    def start(self) -> Equilibrium:
        """Upright; `NoEquilibriumError` if it does not stand."""
        try:
            return super().start()
        except NoEquilibriumError:
            raise NoEquilibriumError(DOES_NOT_STAND) from None

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """At the angle ``load``; `UnboundedError` beyond `LARGEST`."""
        if load > LARGEST:
            raise UnboundedError(f"in equilibrium up to {LARGEST:g} degrees")
        point = self.at(load).solve(0.0, guess, state, thorough=thorough)
        return replace(point, load=load)

    def stable(self, point: Equilibrium) -> bool:
        """See `Solver`."""
        return self.at(point.load).stable(replace(point, load=0.0))

    def mechanism(self, point: Equilibrium) -> Floats:
        """Motions of the pieces beyond the last equilibrium, (P, 6), see `StaticTilt`."""
        units = row_units(self.assembly)
        loose = LOOSE * float(np.abs(point.unknowns * units).max())
        largest, found = 0.0, np.zeros_like(point.unknowns)
        for excess in BEYOND:  # as the solver may not move at all from one of them
            motion = self.at(point.load + excess).motion(point, 0.0)
            size = float(np.abs(motion * units).max())
            if size > largest:
                largest, found = size, motion / size
            if size > loose:
                break
        return motion_of(self.assembly, found)


def _kind_of_motion(assembly: Assembly, mechanism: Floats) -> Motion:
    """Whether blocks that move as a ``mechanism``, (P, 6), slide or rock."""
    apart = (equilibrium_matrix(assembly).T @ mechanism.ravel()).reshape(-1, 3)
    opening, sliding = -apart[:, 0], np.hypot(apart[:, 1], apart[:, 2])
    largest = float(np.hypot(opening, sliding).max())
    closed = opening <= CLOSED * largest
    slides = float(sliding[closed].max(initial=0.0))
    opens = (1.0 - EQUAL) * float(opening.max())
    return Motion.SLIDING if slides >= opens else Motion.ROCKING


def moves_most(assembly: Assembly, mechanism: Floats) -> str:
    """The piece whose centroid moves most in a ``mechanism``, (P, 6); if none does, turns most."""
    moved, turned_by = np.linalg.norm(mechanism.reshape(-1, 2, 3), axis=2).T
    seen = moved if moved.max() > STILL * assembly.length * turned_by.max() else turned_by
    return assembly.pieces[int(np.argmax(seen))].name
