"""SiDMACIB: capacity of the joint by limit analysis on contact points (the paper, section 2).

At point i of lock j act a normal force r_n, a force along the lock r_t1 and one across it r_t2,

    r_n >= 0,    |r_t1| <= mu r_n,    |r_t2| <= w_j p_ij T0_j,

in equilibrium with the loads on the upper block, C_eq r + E = 0. E contains the self-weight of the
block, an overload against rocking, the shear V at the block's centroid and the torque M. T0_j is
the strength of lock j, without the friction that its bond may have; w_j is 1, or less if a
reduction applies to the lock. The paper raises V in steps and checks feasibility; the linear
programme here maximises the load, with the same result.
"""

import math
import threading
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import cvxpy as cp
import numpy as np

from sidmacib.contact_points.options import ContactOption, contact_points
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.pieces import cut_pieces, upper_block
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.equilibrium import wrenches
from sidmacib.mechanics.optimisation import Family
from sidmacib.validation import refused, require_not_negative

LEAST_FRICTION = 1e-300  # less counts as none: products with it are no normal numbers
KEPT = 16  # programmes that are asked again, such as those of a loop over directions


@dataclass(frozen=True)
class Sidmacib:
    """The limit model of a joint.

    ``strength``: factor w_j on the strength of each lock, one per lock; None for 1 everywhere.
    ``overload``: in N, downwards; it represents a fixed plate, which this model lacks. A joint with
    another hold-down has that load instead. ``friction``: whether dry friction resists along the
    locks. ValueError unless strengths and overload are finite and not negative, and unless there
    are at least two locks, which bear against each other.
    """

    joint: Joint
    option: ContactOption
    strength: tuple[float, ...] | None = None
    friction: bool = True
    overload: float = 1000.0

    def __post_init__(self) -> None:
        require_not_negative(overload=self.overload)
        if not self.joint.interlocking:
            raise ValueError(
                f"locks: {self.joint.locks} is not allowed with SiDMACIB, in which locks bear "
                "against each other; it must be at least 2"
            )
        if not isinstance(self.friction, bool | np.bool_):
            raise refused("friction", self.friction, "true or false")
        if self.strength is None:
            return
        if len(self.strength) != self.joint.locks:
            raise ValueError(
                f"strength: must be one factor for each of the {self.joint.locks} locks "
                f"(got {len(self.strength)})"
            )
        require_not_negative(**{f"strength of lock {i}": w for i, w in enumerate(self.strength, 1)})

    @property
    def pressing_force(self) -> float:
        """Force on the top of the upper block, besides its weight, in N."""
        force = self.joint.pressing_force
        return self.overload if force is None else force


@dataclass(frozen=True)
class Capacity:
    """The largest load in a direction, and the forces at the contact points under it."""

    load: float  # N, along the direction
    shear: float  # V in N
    torque: float  # M in N m
    forces: Floats  # (N, 3): r_t1, r_t2, r_n on the upper block at each contact point, in N


@dataclass(frozen=True)
class _Units:
    """Units of the programme, in which its numbers are about 1 for any joint.

    Forces in N along the locks, across them and normal to them; ``plane``: V in N and M in N m.
    """

    forces: Floats  # (3,)
    plane: Floats  # (2,)

    @classmethod
    def of(cls, model: Sidmacib, limit: Floats, pressure: float, lever: float) -> "_Units":
        """Units from the points' strengths (N), the pressing force (N) and the lever of V (m)."""
        joint = model.joint
        across, width = float(limit.sum()), joint.total_width
        pressure = abs(pressure) or across or 1.0
        along = friction_along(model) * pressure
        rocking = pressure * width / lever
        shear = min(across, rocking) or pressure
        torque = float(limit @ np.abs(np.tile(model.option.positions, joint.locks))) * joint.a
        return cls(
            np.array([along or pressure, across or pressure, pressure]),
            np.array([shear, (torque + along * width) or pressure * width]),
        )


@dataclass(frozen=True)
class _Programme:
    """The feasible set: variables, in ``units``, and the constraints common to all programmes.

    ``loads``: V and M. ``forces``: r_t1, r_t2, r_n at every point.
    """

    units: _Units
    loads: cp.Variable
    forces: cp.Variable
    constraints: list[cp.Constraint]


def _programme(model: Sidmacib) -> _Programme:
    joint = model.joint
    points = contact_points(joint, model.option)
    count = len(points.lock)
    weight, centroid = block_above(joint)
    pressure = weight + model.pressing_force
    strength = np.array(model.strength if model.strength is not None else [1.0] * joint.locks)
    limit = strength[points.lock - 1] * points.portion * np.array(joint.strengths)[points.lock - 1]
    units = _Units.of(model, limit, pressure, float(centroid[2] - joint.h / 2))
    loads, forces = cp.Variable(2), cp.Variable((count, 3))

    axes = np.broadcast_to(np.eye(3), (count, 3, 3))
    along, across, normal = units.forces
    shear, torque = units.plane
    # Largest terms in the equations of force x, y, z and moment x, y, z.
    width = joint.total_width
    size = np.array([along, shear, normal, normal * width, normal * joint.a, torque])
    C_eq = wrenches(points.position, axes, centroid) * np.tile(units.forces, count) / size[:, None]
    rocking = -pressing_lever(joint, centroid) * model.pressing_force
    permanent = np.array([0.0, 0.0, -pressure, rocking, 0.0, 0.0]) / size
    lateral = np.zeros((6, 2))
    lateral[1, 0] = lateral[5, 1] = 1.0
    E = permanent + lateral @ loads

    mu = friction_along(model) * normal / along
    return _Programme(
        units,
        loads,
        forces,
        [
            C_eq @ cp.vec(forces, order="C") + E == 0,
            forces[:, 2] >= 0,
            # Two inequalities each, as absolute values would add unknowns.
            forces[:, 0] <= mu * forces[:, 2],
            -forces[:, 0] <= mu * forces[:, 2],
            forces[:, 1] <= limit / across,
            -forces[:, 1] <= limit / across,
        ],
    )


def pressing_lever(joint: Joint, centroid: Floats) -> float:
    """Distance in y of the pressing force from the upper block's centroid, in m.

    A given force acts in the middle of the top, the overload at the centroid.
    """
    return 0.0 if joint.pressing_force is None else joint.total_width / 2 - float(centroid[1])


def friction_along(model: Sidmacib) -> float:
    """Friction coefficient along the locks, 0 if the model leaves it out."""
    coefficient = model.joint.dry.friction
    return coefficient if model.friction and coefficient > LEAST_FRICTION else 0.0


def block_above(joint: Joint) -> tuple[float, Floats]:
    """Self-weight (N) and centroid (m, shape (3,)) of the upper block."""
    names = upper_block(joint)
    pieces = [piece for piece in cut_pieces(joint) if piece.name in names]
    weight = math.fsum(piece.weight for piece in pieces)
    # By volume, as there is a centroid without density too.
    volumes = [float(np.prod(piece.size)) for piece in pieces]
    moments = sum(v * piece.centre for v, piece in zip(volumes, pieces, strict=True))
    return weight, np.asarray(moments / math.fsum(volumes))


@lru_cache(maxsize=KEPT)
def _directed(model: Sidmacib, thread: int) -> tuple[_Programme, cp.Variable, Family]:
    """The programme of ``model``, its load, and the load's largest values along any direction.

    Cached, because building it takes longer than solving it; each ``thread`` fills a separate one.
    """
    programme = _programme(model)
    load, slope = cp.Variable(), cp.Parameter(2)
    along = [*programme.constraints, load >= 0, programme.loads == slope * load]
    return programme, load, Family(cp.Problem(cp.Maximize(load), along))


def capacities(model: Sidmacib, directions: Iterable[Direction]) -> list[Capacity]:
    """The largest load in each of ``directions``.

    Raises `sidmacib.errors.CapacityError` if there is none.
    """
    programme, load, family = _directed(model, threading.get_ident())

    def along(direction: Direction) -> Capacity:
        # V and M per newton of load, and the load at which they are about their units.
        each = np.array([direction.shear, direction.torque * model.joint.a])
        unit = 1.0 / float(np.abs(each / programme.units.plane).sum())
        family.solve(unit * each / programme.units.plane, f"e = {direction.eccentricity:g} a")
        value = unit * float(cast(float, load.value)) + 0.0  # no -0
        forces = programme.units.forces * programme.forces.value
        return Capacity(value, value * each[0], value * each[1], forces)

    return [along(direction) for direction in directions]


def capacity(model: Sidmacib, direction: Direction) -> Capacity:
    """The largest load in ``direction``; raises `sidmacib.errors.CapacityError` if none."""
    return capacities(model, [direction])[0]


@dataclass(frozen=True)
class SupportFunction:
    """Finds the point of the feasible set that lies furthest along a direction.

    Points and directions are of shape (2,), V and M in units of ``plane`` (N, N m).
    """

    programme: _Programme
    family: Family

    @classmethod
    def of(cls, model: Sidmacib) -> "SupportFunction":
        """Set up the programme of ``model``."""
        programme, normal = _programme(model), cp.Parameter(2)
        aim = cp.Maximize(normal @ programme.loads)
        return cls(programme, Family(cp.Problem(aim, programme.constraints)))

    @property
    def plane(self) -> Floats:
        """The units of V and M."""
        return self.programme.units.plane

    def __call__(self, normal: Floats) -> Floats:
        """The furthest point along ``normal``."""
        V, M = normal / self.plane
        self.family.solve(normal, f"outward normal (V, M) = ({V:g}, {M:g})")
        return np.array(self.programme.loads.value, dtype=float)
