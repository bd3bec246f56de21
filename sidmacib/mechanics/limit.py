"""Limit analysis of an assembly: the pieces and nodes of the distinct elements, rigid-plastic.

The static theorem: the largest load for which node forces exist that keep every piece in
equilibrium and exceed no strength. At inner nodes |s_t| <= tau A + mu_b s_n and s_n >= -sigma A,
where mu_b, the friction of bonds, is 0 in the paper. Dry nodes carry no tension, and shear only if
friction is asked for, |s_t| <= mu s_n (associated: sliding would dilate, so it overestimates); the
torque of a face is limited by a linear pressure, see `sidmacib.mechanics.twist`. Contact points in
place of locks carry no tension, friction along the locks if that is asked for, and up to tau A
across them. Forces redistribute freely: the geometry alone decides how far each lock is used,
without a reduction rule.

A first programme finds the load. Many states of forces carry it; a second programme, with a small
penalty on the sum of s^2 / A, picks the one for which that sum is least, which is unique.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cvxpy as cp
import numpy as np
import scipy.sparse as sp
from scipy.sparse import csr_array

from sidmacib.errors import DOES_NOT_STAND, CapacityError, InfeasibleError, SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import free_rows, row_units
from sidmacib.mechanics.equilibrium_matrix import equilibrium_matrix
from sidmacib.mechanics.optimisation import solve
from sidmacib.mechanics.polygons import CondensedLocks, ResultantLimits
from sidmacib.mechanics.twist import Twist

# Accuracy of the load, over itself or the loads' scale if that is larger, and digits that are then
# kept. With an even number of locks, rounding loses the last ones; bonds without friction
# beside dry faces lose more.
ACCURACIES = {1e-9: 9, 1e-7: 7, 1e-5: 5}
MANY = 5000  # nodes from which the highest accuracy is not asked for: it takes twice as long
# Penalty of the second programme: so small that it decides between equal loads only.
SMALL = (1e-5, 1e-7, 1e-9)
OF_ROUNDS = 1e-6  # penalty of the only programme of a round, whose load settles to less than that
LOST = 1e-8  # relative loss of load by the penalty, at most
LARGEST = 10.0  # approximate force of a node over its share of the scale, where forces concentrate
MOTION_DIGITS = 9  # of the mechanism
WHAT = "limit analysis"
ROUNDS = 30  # at most, with limits of torque
QUICK = 8  # rounds after which places of pressure are taken from the round before in part
KEPT = 0.6  # that part
NEARER = 5  # times that pressure is taken nearer to the middle where nothing balances the weight
FALLS = 1e-6  # of the scale of the loads: a load that is negative, not 0
SHORT = 1e-5  # of all permanent loads: what may be missing where a structure stands
SETTLED = 1e-3  # change of the load over itself in such rounds
CALM = 3  # rounds in a row that must have settled
NODE_MEMORY = 12_000  # bytes a node that the programme takes, solver included; measured on walls
MOST_MEMORY = 2**31  # bytes; so large a programme takes some twenty minutes


@dataclass(frozen=True)
class LimitState:
    """The limit load, and the forces that carry it with the least sum of s^2 / A.

    ``load``: along the direction, in N. ``force``: (N, 3) in N, what the piece below each node
    exerts on the piece above, in the frame of the face (normal, two tangents). ``mechanism``: how
    the pieces move when the load exceeds its limit, from the multipliers of the equations of
    equilibrium: displacements (m) and rotations (rad) for 1 m along the load, (P, 6). Several
    motions may be possible; this is one of them. ``twisted``: how many faces' torque is limited.
    """

    load: float
    force: Floats
    mechanism: Floats
    twisted: int = 0


@dataclass(frozen=True)
class Sliding:
    """Friction limits of rough nodes: ``limit`` (N) plus ``slope`` times compression, both (N,)."""

    limit: Floats
    slope: Floats


def limit_load(
    assembly: Assembly,
    loads: Loads,
    *,
    friction: bool = False,
    most: float | None = None,
) -> LimitState:
    """The largest multiple of the variable ``loads`` that ``assembly`` carries.

    ``friction``: whether rough faces resist sliding; friction is associated, so that sliding
    dilates. Dry faces then carry no more torque than a linear pressure over the part that is
    pressed allows, see `sidmacib.mechanics.twist`; where one would, the programme is repeated with
    that limit until the load no longer changes, and the lowest of the last loads counts. ``most``
    (N): the load is not raised beyond this; if it is reached, nothing moves. Accurate to 1e-9,
    sometimes 1e-7 or 1e-5, of the load or of ``loads.scale``, whichever is larger, and rounded to
    that; to 1e-3 where torque is limited. ValueError for ``friction`` under a fixed plate, whose
    force has no limit: use a given force instead, see `sidmacib.HoldDown`.
    `sidmacib.errors.CapacityError` if there is no largest load.
    """
    if friction and any(face.kind is Kind.PLATE for face in assembly.faces):
        raise ValueError(
            "friction: must be false under a fixed plate, where associated friction has no limit; "
            "or replace the plate by a force"
        )
    free = solved(assembly, loads, friction, most=most)
    return free if not friction else _with_torque_limited(assembly, loads, free, most)


def _with_torque_limited(
    assembly: Assembly, loads: Loads, free: LimitState, most: float | None
) -> LimitState:
    """`limit_load` from the state without limits of torque, ``free``."""
    twist = Twist.of(assembly, free.force)
    if not twist.motions:
        return free
    found, nearer = [free], 0
    while len(found) <= ROUNDS and not _settled(found):
        try:
            found.append(solved(assembly, loads, True, twist=twist, most=most))
        except InfeasibleError:
            nearer += 1
            if nearer > NEARER:
                raise InfeasibleError(DOES_NOT_STAND) from None
            twist = twist.nearer()
            continue
        kept = KEPT if len(found) > QUICK else 0.0
        twist = twist.after(assembly, found[-1].force, kept)
    # The first rounds have the pressure elsewhere; where rounds alternate, the lower load counts.
    lowest = min(found[-CALM:], key=lambda each: each.load)
    if lowest.load < -FALLS * loads.scale <= free.load:
        raise InfeasibleError(DOES_NOT_STAND)
    return replace(lowest, twisted=len(twist.motions))


def _settled(found: Sequence[LimitState]) -> bool:
    """Whether the load of the last rounds no longer changes."""
    loads = [each.load for each in found[-CALM - 1 :]]
    return len(loads) > CALM and max(loads) - min(loads) <= SETTLED * abs(loads[-1])


def solved(
    assembly: Assembly,
    loads: Loads,
    friction: bool,
    *,
    sliding: Sliding | None = None,
    twist: Twist | None = None,
    most: float | None = None,
) -> LimitState:
    """One round of `limit_load`, or of `sidmacib.mechanics.sliding`.

    ``sliding``: in place of the friction cones. ``twist``: limits of torque.
    """
    _require_room(assembly)
    programme = _Programme(assembly, loads, friction, sliding, twist)
    load, force = cp.Variable(), cp.Variable((len(assembly.nodes.area), 3))
    constraints = programme.constraints(load, force)
    if most is not None:
        constraints.append(load <= most / programme.scale)
    # In the norm of the areas: the same state however fine the mesh.
    size = cp.sum_squares(cp.multiply(LARGEST * np.sqrt(programme.share)[:, None], force))
    small = 0.0 if sliding is None and twist is None else OF_ROUNDS
    accuracies = tuple(ACCURACIES)[small > 0.0 or force.shape[0] >= MANY :]
    met = solve(cp.Problem(cp.Maximize(load - small * size), constraints), WHAT, *accuracies)
    largest = float(load.value)
    of_load = ACCURACIES[met]
    carried = most is not None and most - largest * programme.scale <= met * programme.scale
    multipliers = constraints[0].dual_value
    mechanism = np.zeros((programme.pieces, 6)) if carried else programme.mechanism(multipliers)
    penalties = iter(SMALL)
    while not small or largest - float(load.value) > max(LOST, met) * max(abs(largest), 1.0):
        small = next(penalties, 0.0)
        if not small:
            raise SolverError(
                f"{WHAT}: the second programme found no forces that carry the limit load"
            )
        objective = cp.Maximize(load - small * size)
        met = max(met, solve(cp.Problem(objective, constraints), WHAT, *accuracies))
    digits = ACCURACIES[met]
    return LimitState(
        _rounded(largest * programme.scale, programme.scale, of_load),
        # Rounded to remove noise; plus 0 turns -0 into 0.
        programme.unit[:, None] / LARGEST * (np.round(LARGEST * force.value, digits) + 0.0),
        mechanism,
    )


def require_standing(assembly: Assembly, loads: Loads, *, friction: bool = False) -> None:
    """`InfeasibleError` if no forces balance the permanent ``loads`` alone.

    `limit_load` then still has an answer if the variable loads hold ``assembly`` up.
    """
    _require_room(assembly)
    programme = _Programme(assembly, loads, friction)
    share, force = cp.Variable(), cp.Variable((len(assembly.nodes.area), 3))
    # The part of the loads that is carried has a value even where forces do not exist.
    carried = [*programme.constraints(0.0, force, share), share <= 1.0]
    try:
        solve(cp.Problem(cp.Maximize(share), carried), WHAT, *ACCURACIES)
    except InfeasibleError:  # not even without weight, as a rule wants locks to be pressed
        raise InfeasibleError(DOES_NOT_STAND) from None
    if float(share.value) < 1.0 - SHORT:
        raise InfeasibleError(DOES_NOT_STAND)


def _require_room(assembly: Assembly) -> None:
    """`CapacityError` if the programme of ``assembly`` takes too much memory."""
    pieces, nodes = len(assembly.pieces), len(assembly.nodes.area)
    size = NODE_MEMORY * nodes
    if size > MOST_MEMORY:
        raise CapacityError(
            f"{WHAT}: {pieces:,} pieces with {nodes:,} nodes would take {size / 2**30:.1f} GiB; at "
            f"most {MOST_MEMORY / 2**30:g} GiB are allowed: use fewer locks or a coarser mesh"
        )


class _Programme:
    """The constraints that both programmes share, in units in which their numbers are about 1."""

    def __init__(
        self,
        assembly: Assembly,
        loads: Loads,
        friction: bool,
        sliding: Sliding | None = None,
        twist: Twist | None = None,
    ) -> None:
        loads.require_proportional()
        contact_law, rows = ContactLaw.of(assembly), free_rows(assembly)
        area = assembly.nodes.area
        self.share = area / area.sum()
        # If nothing has strength, permanent loads are the only measure.
        self.scale = loads.scale or float(np.abs(loads.permanent).max()) or 1.0
        # Unit of a node's force: its share of the scale on a face of mean area, times `LARGEST`.
        self.unit = LARGEST * self.scale * self.share * len(assembly.faces)
        # Forces over the scale, and moments over the scale times the length, are about 1.
        size = row_units(assembly) * self.scale
        columns = np.repeat(self.unit, 3)
        self.rows, self.size, self.pieces = rows, size, len(assembly.pieces)
        self.balance = _scaled(equilibrium_matrix(assembly)[rows], size, columns)
        self.permanent = loads.permanent.ravel()[rows] / size
        self.variable = loads.variable.ravel()[rows] / size * self.scale
        self.shear, self.tension = (
            contact_law.shear_strength / self.unit,
            contact_law.tensile_strength / self.unit,
        )
        self.friction = contact_law.friction
        self.bond_friction = contact_law.bond_friction
        locked = np.array([face.kind is Kind.LOCKED for face in assembly.faces])
        of_locks = locked[assembly.nodes.face]
        dry = ~contact_law.cohesive & ~of_locks
        rough = dry & friction & (contact_law.friction > 0.0)
        self.inner, self.rough = np.flatnonzero(contact_law.cohesive), np.flatnonzero(rough)
        self.smooth, self.locked = np.flatnonzero(dry & ~rough), np.flatnonzero(of_locks)
        self.along = friction * contact_law.friction[of_locks]
        self.assembly, self.sliding, self.twist = assembly, sliding, twist
        self.resultants = _resultants(assembly)

    def constraints(
        self, load: cp.Variable | float, force: cp.Variable, share: cp.Variable | float = 1.0
    ) -> list[cp.Constraint]:
        """Equilibrium under ``load`` and a ``share`` of the permanent loads; strengths of nodes."""
        normal, shear = force[:, 0], force[:, 1:]
        inner, rough, smooth = self.inner, self.rough, self.smooth

        limit = self._friction_limit(rough, normal)

        def size(nodes: Integers) -> cp.Expression:
            return cp.norm(shear[nodes], 2, axis=1)

        return [
            # ``force`` acts on the pieces above, the matrix is for those below: hence no minus.
            self.balance @ cp.vec(force, order="C")
            == share * self.permanent + load * self.variable,
            size(inner) <= self._held(inner, normal),
            normal[inner] >= -self.tension[inner],
            size(rough) <= limit,
            shear[smooth] == 0,
            normal[smooth] >= 0,
            *([] if self.sliding is None else [normal[rough] >= 0]),
            *self._twist(limit, shear[rough]),
            *self._locks(normal, shear),
            *self._limited(normal, shear),
        ]

    def _friction_limit(self, rough: Integers, normal: cp.Expression) -> cp.Expression:
        if self.sliding is None:
            return cp.multiply(self.friction[rough], normal[rough])
        given = self.sliding.limit[rough] / self.unit[rough]
        return given + cp.multiply(self.sliding.slope[rough], normal[rough])

    def _twist(self, limit: cp.Expression, shear: cp.Expression) -> list[cp.Constraint]:
        if self.twist is None or not self.twist.motions:
            return []
        forces, limits = self.twist.rows(self.assembly, self.rough)
        unit = self.unit[self.rough]
        largest = float(unit.max())
        forces, limits = (
            each @ sp.diags_array(np.repeat(unit / largest, count))
            for each, count in ((forces, 2), (limits, 1))
        )
        return [forces @ cp.vec(shear, order="C") <= limits @ limit]

    def mechanism(self, multipliers: Floats) -> Floats:
        """Motion of the pieces, (P, 6), from the multipliers of the equations of equilibrium."""
        motion = np.zeros(6 * self.pieces)
        work = float(np.sum(multipliers * self.variable))
        motion[self.rows] = multipliers / work * (self.scale / self.size)
        return np.round(motion.reshape(-1, 6), MOTION_DIGITS) + 0.0

    def _locks(self, normal: cp.Expression, shear: cp.Expression) -> list[cp.Constraint]:
        """The limits of contact points in place of locks: along these and across them."""
        if not len(self.locked):
            return []
        pressed, along, across = (f[self.locked] for f in (normal, shear[:, 0], shear[:, 1]))
        limit = cp.multiply(self.along, pressed)
        strength = self.shear[self.locked]
        return [
            pressed >= 0,
            along <= limit,
            -along <= limit,
            across <= strength,
            -across <= strength,
        ]

    def _limited(self, normal: cp.Expression, shear: cp.Expression) -> list[cp.Constraint]:
        """The limits of the resultants of locks that a rule speaks for, and what these rest on."""
        constraints = []
        for nodes, limits, along, across in self.resultants:
            unit = self.unit[nodes]
            used = (along * unit) @ shear[nodes, 0] + (across * unit) @ shear[nodes, 1]
            constraints.append(used <= 1.0)
            if limits.compression > 0.0:
                constraints.append(unit / limits.compression @ normal[nodes] >= 1.0)
        return constraints

    def _held(self, inner: Integers, normal: cp.Expression) -> Floats | cp.Expression:
        """Shear strength of inner nodes, which may depend on their normal force."""
        if not self.bond_friction[inner].any():
            return np.asarray(self.shear[inner])
        return self.shear[inner] + cp.multiply(self.bond_friction[inner], normal[inner])


def _resultants(assembly: Assembly) -> list[tuple[Integers, ResultantLimits, Floats, Floats]]:
    """Of each face whose resultant is limited its nodes, and their coefficients in the limits.

    Coefficients of the forces along and across the locks, (K, nodes) in 1/N.
    """
    found = []
    for number, face in enumerate(assembly.faces):
        if isinstance(face, CondensedLocks) and (limits := face.limits):
            nodes = np.flatnonzero(assembly.nodes.face == number)
            run, row = face.places.T
            shear, torque = limits.shear[:, None], limits.torque[:, None]
            # What the block below exerts on that above is opposite to V and M.
            found.append((nodes, limits, torque * row, -shear - torque * run))
    return found


def _scaled(matrix: csr_array, rows: Floats, columns: Floats) -> csr_array:
    """``matrix`` over a unit of each of its ``rows``, times one of each of its ``columns``."""
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    data = matrix.data / rows[row] * columns[matrix.indices]
    return csr_array((data, matrix.indices, matrix.indptr), matrix.shape)


def _rounded(load: float, scale: float, digits: int) -> float:
    """``load`` to so many ``digits``, of itself or of ``scale`` if that is larger; never -0."""
    largest = max(abs(load), scale)
    return round(load, digits - 1 - math.floor(math.log10(largest))) + 0.0
