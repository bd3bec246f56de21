"""SiDMACIB: capacity of the joint by limit analysis on contact points (the paper, section 2).

The paper raises V in steps and checks feasibility; the linear programme here, see `programme`,
maximises the load, with the same result.
"""

import math
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import cvxpy as cp
import numpy as np

from sidmacib.contact_points import ContactOption, contact_points
from sidmacib.joint import Direction, Joint
from sidmacib.joint.pieces import cut_pieces, upper_block
from sidmacib.mechanics.assembly import Floats, Kind
from sidmacib.mechanics.equilibrium import wrenches
from sidmacib.mechanics.optimisation import solve
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
class Admissible:
    """The loads that a joint carries: variables, in ``units``, and the constraints on them.

    ``loads``: V and M. ``forces``: r_t1, r_t2, r_n at every point.
    """

    units: _Units
    loads: cp.Variable
    forces: cp.Variable
    constraints: list[cp.Constraint]


def programme(model: Sidmacib) -> Admissible:
    r"""The constraints of SiDMACIB on the loads V and M and the forces r at the contact points.

    .. math::

        \begin{aligned}
        \max_{\lambda, r} \quad & \lambda \\
        \text{subject to} \quad & C_{eq} r + E = 0, \quad (V, M) = \lambda (v, m) \\
        & r_n \ge 0, \quad |r_{t1}| \le \mu r_n, \quad |r_{t2}| \le w_j p_{ij} T_{0j}
        \end{aligned}

    At point i of lock j, :math:`r_n` is normal, :math:`r_{t1}` along the lock and :math:`r_{t2}`
    across it. E contains the self-weight of the upper block, the force that presses it, the shear V
    at its centroid and the torque M. :math:`T_{0j}` is the strength of lock j, without the friction
    that its bond may have, of which the point has the portion :math:`p_{ij}`; :math:`w_j` is 1, or
    less if a reduction applies to the lock.
    """
    joint, option = model.joint, model.option
    points = contact_points(joint, option)
    count = len(points)
    weight, centroid = block_above(joint)
    pressure = weight + model.pressing_force
    w, p = np.array(model.strength or (1.0,) * joint.locks)[:, None], np.array(option.portions)
    limit = (w * p * np.array(joint.strengths)[:, None]).ravel()
    units = _Units.of(model, limit, pressure, float(centroid[2] - joint.h / 2))
    loads, r = cp.Variable(2), cp.Variable((count, 3))
    r_t1, r_t2, r_n = r[:, 0], r[:, 1], r[:, 2]

    axes = np.broadcast_to(np.eye(3), (count, 3, 3))
    along, across, normal = units.forces
    shear, torque = units.plane
    # Largest terms in the equations of force x, y, z and moment x, y, z.
    width = joint.total_width
    size = np.array([along, shear, normal, normal * width, normal * joint.a, torque])
    C_eq = wrenches(points, axes, centroid) * np.tile(units.forces, count) / size[:, None]
    rocking = -pressing_lever(joint, centroid) * model.pressing_force
    permanent = np.array([0.0, 0.0, -pressure, rocking, 0.0, 0.0]) / size
    lateral = np.zeros((6, 2))
    lateral[1, 0] = lateral[5, 1] = 1.0
    E = permanent + lateral @ loads

    mu = friction_along(model) * normal / along
    constraints = [
        C_eq @ cp.vec(r, order="C") + E == 0,
        r_n >= 0,
        # Two inequalities each, as absolute values would add unknowns.
        r_t1 <= mu * r_n,
        -r_t1 <= mu * r_n,
        r_t2 <= limit / across,
        -r_t2 <= limit / across,
    ]
    return Admissible(units, loads, r, constraints)


def pressing_lever(joint: Joint, centroid: Floats) -> float:
    """Distance in y of the pressing force from the upper block's centroid, in m.

    A given force acts in the middle of the top, the overload at the centroid.
    """
    return 0.0 if joint.pressing_force is None else joint.total_width / 2 - float(centroid[1])


def friction_along(model: Sidmacib) -> float:
    """Friction coefficient along the locks, 0 if the model leaves it out."""
    coefficient = model.joint.material_of(Kind.DRY).friction
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
def _directed(
    model: Sidmacib, thread: int
) -> tuple[Admissible, cp.Problem, cp.Variable, cp.Parameter]:
    """The programme of the largest load along a direction, that load, and the direction (v, m).

    Cached, because building it takes longer than solving it; each ``thread`` fills a separate one.
    """
    admissible = programme(model)
    load, direction = cp.Variable(), cp.Parameter(2)
    along = [*admissible.constraints, load >= 0, admissible.loads == direction * load]
    return admissible, cp.Problem(cp.Maximize(load), along), load, direction


def capacities(model: Sidmacib, directions: Iterable[Direction]) -> list[Capacity]:
    """The largest load in each of ``directions``.

    Raises `sidmacib.errors.CapacityError` if there is none.
    """
    admissible, problem, load, slope = _directed(model, threading.get_ident())
    units = admissible.units

    def along(direction: Direction) -> Capacity:
        # V and M per newton of load, and the load at which they are about their units.
        each = np.array([direction.shear, direction.torque * model.joint.a])
        unit = 1.0 / float(np.abs(each / units.plane).sum())
        slope.value = unit * each / units.plane
        solve(problem, f"e = {direction.eccentricity:g} a")
        value = unit * float(cast(float, load.value)) + 0.0  # no -0
        forces = units.forces * admissible.forces.value
        return Capacity(value, value * each[0], value * each[1], forces)

    return [along(direction) for direction in directions]


def capacity(model: Sidmacib, direction: Direction) -> Capacity:
    """The largest load in ``direction``; raises `sidmacib.errors.CapacityError` if none."""
    (found,) = capacities(model, [direction])
    return found


class SupportFunction:
    """Finds the point of the feasible set that lies furthest along a direction.

    Points and directions are of shape (2,), V and M in units of ``plane`` (N, N m).
    """

    def __init__(self, model: Sidmacib) -> None:
        admissible, self.normal = programme(model), cp.Parameter(2)
        self.plane, self.loads = admissible.units.plane, admissible.loads
        self.problem = cp.Problem(cp.Maximize(self.normal @ self.loads), admissible.constraints)

    def __call__(self, normal: Floats) -> Floats:
        """The furthest point along ``normal``."""
        V, M = normal / self.plane
        self.normal.value = normal
        solve(self.problem, f"outward normal (V, M) = ({V:g}, {M:g})")
        return np.array(self.loads.value, dtype=float)


def pair_loads(model: Sidmacib, directions: Sequence[Direction]) -> Floats:
    r"""The largest load (N) of ``model`` in each of ``directions``, (D,), in closed form.

    For two contact points on every lock, at +-d from its centre and of half its strength each:
    forces across the locks reach every (V, M_s) with

    .. math:: |V| + |M_s| / d \le C,

    C being the sum of the strengths. The normal forces add up to N. They balance the moment of V,
    so that N acts further across the joint than the permanent loads do, at a place y_N. It must lie
    between the centrelines y_1 and y_n of the first lock and the last. Friction along the locks
    adds a torque where it acts one way in front and the other way behind. With half of N at either
    of two places whose mean is y_N, as far apart as the centrelines allow,

    .. math:: |M_f| \le \mu N \min(y_n - y_N,\ y_N - y_1).

    The torque is M_s + M_f. As every bound is linear in the load along a direction, the largest
    load is the least of a few quotients. ValueError unless the points are a `ContactOption.pair`.
    """
    joint, positions = model.joint, model.option.positions
    distance = abs(positions[-1])
    if model.option not in (ContactOption.pair(distance), ContactOption.pair(-distance)):
        raise refused("option", model.option, "a pair of contact points")
    factors = model.strength or (1.0,) * joint.locks
    strength = float(np.dot(factors, joint.strengths))
    weight, centroid = block_above(joint)
    normal = weight + model.pressing_force
    arm = float(centroid[2]) - joint.h / 2
    # Moments (N m) of the permanent loads about the two outer centrelines.
    moment = normal * float(centroid[1]) + pressing_lever(joint, centroid) * model.pressing_force
    behind = moment - normal * joint.lock_centre_y(1)
    before = normal * joint.lock_centre_y(joint.locks) - moment

    # V and M per newton of load; every bound is: load * slope <= most.
    shear = np.array([direction.shear for direction in directions])
    torque = np.abs([direction.torque * joint.a for direction in directions])
    distance, friction = distance * joint.a, friction_along(model)
    twist = torque + distance * shear
    slopes = [shear, arm * shear, twist + friction * arm * shear, twist - friction * arm * shear]
    most = [
        strength,
        before,
        distance * strength + friction * before,
        distance * strength + friction * behind,
    ]
    loads = [
        np.divide(each, slope, out=np.full_like(slope, np.inf), where=slope > 0.0)
        for each, slope in zip(most, slopes, strict=True)
    ]
    return np.asarray(np.min(loads, axis=0))
