"""SiDMACIB: capacity of the joint by limit analysis on contact points (the paper, section 2).

At point i of lock j act a normal force r_n, a force along the lock r_t1 and one across it r_t2,

    r_n >= 0,    |r_t1| <= mu r_n,    |r_t2| <= w_j p_ij T0,

in equilibrium with the loads on the upper block, C_eq r + E = 0. E holds the block's self-weight,
an overload against rocking, the shear V at the block's centroid and the torque M. w_j is 1, or
less where a revision reduces a lock. The paper raises V in steps and checks feasibility; the
linear programme here maximises the load instead, which gives the same answer.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import cast

import cvxpy as cp
import numpy as np

from sidmacib.contact_points import ContactOption, contact_points
from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.equilibrium import wrenches
from sidmacib.mechanics.optimisation import solve
from sidmacib.pieces import rigid_pieces, upper_block


@dataclass(frozen=True)
class Sidmacib:
    """The limit model of a joint.

    ``strength``: factor w_j on the strength of each lock, one per lock; None for 1 everywhere.
    ``overload`` in N, down. ``friction``: whether the locks' dry friction resists along them.
    """

    joint: Joint
    option: ContactOption
    strength: tuple[float, ...] | None = None
    friction: bool = True
    overload: float = 1000.0

    def __post_init__(self) -> None:
        if self.strength is None:
            return
        if len(self.strength) != self.joint.locks or min(self.strength) < 0:
            raise ValueError(
                f"strength: got {self.strength}, allowed is one factor of at least 0 for each of "
                f"{self.joint.locks} locks"
            )


@dataclass(frozen=True)
class Capacity:
    """The largest load in a direction, and the forces at the contact points under it."""

    load: float  # N, along the direction
    shear: float  # V in N
    torque: float  # M in N m
    forces: Floats  # (N, 3): r_t1, r_t2, r_n on the upper block at each contact point, in N


@dataclass(frozen=True)
class _Programme:
    """The feasible set: variables and constraints that all programmes share."""

    shear: cp.Variable
    torque: cp.Variable
    forces: cp.Variable
    constraints: list[cp.Constraint]


def _programme(model: Sidmacib) -> _Programme:
    joint = model.joint
    points = contact_points(joint, model.option)
    count = len(points.lock)
    weight, centroid = _upper_block(joint)
    shear, torque, forces = cp.Variable(), cp.Variable(), cp.Variable((count, 3))

    axes = np.broadcast_to(np.eye(3), (count, 3, 3))
    C_eq = wrenches(points.position, axes, centroid)
    permanent = np.array([0.0, 0.0, -(weight + model.overload), 0.0, 0.0, 0.0])
    lateral = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    about_z = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    E = permanent + shear * lateral + torque * about_z

    strength = np.array(model.strength if model.strength is not None else [1.0] * joint.locks)
    limit = strength[points.lock - 1] * points.portion * joint.T0
    mu = joint.dry.friction if model.friction else 0.0
    along, across, normal = forces[:, 0], forces[:, 1], forces[:, 2]
    return _Programme(
        shear,
        torque,
        forces,
        [
            C_eq @ cp.vec(forces, order="C") + E == 0,
            normal >= 0,
            cp.abs(along) <= mu * normal,
            cp.abs(across) <= limit,
        ],
    )


def _upper_block(joint: Joint) -> tuple[float, Floats]:
    """Self-weight (N) and centroid (m, shape (3,)) of the upper block."""
    names = upper_block(joint)
    pieces = [piece for piece in rigid_pieces(joint) if piece.name in names]
    weight = sum(piece.weight for piece in pieces)
    return weight, np.asarray(sum(piece.weight * piece.centre for piece in pieces) / weight)


def capacities(model: Sidmacib, directions: Iterable[Direction]) -> list[Capacity]:
    """The largest load in each of ``directions``; raises `sidmacib.errors.CapacityError` where there is none."""
    programme = _programme(model)
    load, slope = cp.Variable(nonneg=True), cp.Parameter(2)
    problem = cp.Problem(
        cp.Maximize(load),
        [
            *programme.constraints,
            programme.shear == slope[0] * load,
            programme.torque == slope[1] * load,
        ],
    )

    def along(direction: Direction) -> Capacity:
        slope.value = np.array([direction.shear, direction.torque * model.joint.a])
        solve(problem, f"e = {direction.eccentricity:g} a")
        value = float(cast(float, load.value))
        return Capacity(
            value,
            value * direction.shear,
            value * direction.torque * model.joint.a,
            np.array(programme.forces.value),
        )

    return [along(direction) for direction in directions]


def capacity(model: Sidmacib, direction: Direction) -> Capacity:
    """The largest load in ``direction``; raises `sidmacib.errors.CapacityError` if there is none."""
    return capacities(model, [direction])[0]


@dataclass(frozen=True)
class SupportFunction:
    """Finds the point (V, M) of the feasible set that lies furthest along a direction."""

    programme: _Programme
    normal: cp.Parameter
    problem: cp.Problem

    @classmethod
    def of(cls, model: Sidmacib) -> "SupportFunction":
        """Set up the programme of ``model``."""
        programme, normal = _programme(model), cp.Parameter(2)
        aim = normal[0] * programme.shear + normal[1] * programme.torque
        return cls(programme, normal, cp.Problem(cp.Maximize(aim), programme.constraints))

    def __call__(self, normal: Floats) -> Floats:
        """The furthest point along ``normal`` (shape (2,), of V in N and M in N m)."""
        self.normal.value = normal
        solve(self.problem, f"outward normal (V, M) = ({normal[0]:g}, {normal[1]:g})")
        return np.array([self.programme.shear.value, self.programme.torque.value], dtype=float)
