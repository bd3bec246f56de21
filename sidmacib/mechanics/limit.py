"""Limit analysis of an assembly: the pieces and nodes of the distinct elements, rigid-plastic.

The static theorem: the largest load for which node forces exist that keep every piece in
equilibrium and exceed no strength, see `admissible`. Friction is associated: sliding would dilate,
so it overestimates; the torque of a face is limited by a linear pressure, see
`sidmacib.mechanics.twist`. Forces redistribute freely: the geometry alone decides how far each lock
is used, without a reduction rule.

A first programme finds the load. Many states of forces carry it; a second programme, with a small
penalty on the sum of s^2 / A, picks the one for which that sum is least, which is unique.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cvxpy as cp
import numpy as np
from scipy.sparse import csr_array

from sidmacib.errors import DOES_NOT_STAND, CapacityError, InfeasibleError, SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, Loads
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.crushing import Limited, crushing_rows
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, motion_of, row_units
from sidmacib.mechanics.optimisation import solve
from sidmacib.mechanics.polygons import CondensedLocks
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
TORQUE_ROUNDS = 30  # at most, with limits of torque
QUICK_ROUNDS = 8  # rounds after which places of pressure are taken from the round before in part
KEPT = 0.6  # that part
NEARER = 5  # times that pressure is taken nearer to the middle where nothing balances the weight
FALLS = 1e-6  # of the scale of the loads: a load that is negative, not 0
SHORT = 1e-5  # of all permanent loads: what may be missing where a structure stands
TORQUE_SETTLED = 1e-3  # change of the load over itself in such rounds
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
    motions may be possible; this is one of them. ``untwisted``: the load (N) without limits of
    torque; None where no face reaches them.
    """

    load: float
    force: Floats
    mechanism: Floats
    untwisted: float | None = None


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
    cone, limited = ContactLaw.of(assembly).cone(friction=friction), Limited()
    free = solved(assembly, loads, cone, limited, most=most)
    if not friction or not (twist := Twist.of(assembly, free.force)).motions:
        return free
    found, nearer = [free], 0
    while len(found) <= TORQUE_ROUNDS and not _settled(found):
        try:
            found.append(solved(assembly, loads, cone, limited, twist=twist, most=most))
        except InfeasibleError:
            nearer += 1
            if nearer > NEARER:
                raise InfeasibleError(DOES_NOT_STAND) from None
            twist = twist.nearer()
            continue
        kept = KEPT if len(found) > QUICK_ROUNDS else 0.0
        twist = twist.after(assembly, found[-1].force, kept)
    # The first rounds have the pressure elsewhere; where rounds alternate, the lower load counts.
    lowest = min(found[-CALM:], key=lambda each: each.load)
    if lowest.load < -FALLS * loads.scale <= free.load:
        raise InfeasibleError(DOES_NOT_STAND)
    return replace(lowest, untwisted=free.load)


def _settled(found: Sequence[LimitState]) -> bool:
    """Whether the load of the last rounds no longer changes."""
    loads = [each.load for each in found[-CALM - 1 :]]
    return len(loads) > CALM and max(loads) - min(loads) <= TORQUE_SETTLED * abs(loads[-1])


def solved(
    assembly: Assembly,
    loads: Loads,
    cone: Cone,
    limited: Limited,
    *,
    twist: Twist | None = None,
    most: float | None = None,
) -> LimitState:
    """One round of `limit_load`, or of `sidmacib.mechanics.sliding`.

    ``cone``: of the nodes. ``limited``: faces that are known to be crushed otherwise, to which
    others may be added. ``twist``: limits of torque, which rounds have.
    """
    _require_room(assembly)
    given = assembly, loads, cone, limited, twist, most
    return limited.kept(assembly, lambda: _solved(*given), lambda state: state.force)


def _solved(
    assembly: Assembly,
    loads: Loads,
    cone: Cone,
    limited: Limited,
    twist: Twist | None,
    most: float | None,
) -> LimitState:
    """`solved` with the limits of these faces alone."""
    units = _Scales.of(assembly, loads)
    load, s = cp.Variable(), cp.Variable((len(assembly.nodes.area), 3))
    constraints = admissible(assembly, loads, cone, load, s, limited, twist=twist)
    if most is not None:
        constraints.append(load <= most / units.load)
    # In the norm of the areas: the same state however fine the mesh.
    size = cp.sum_squares(cp.multiply(LARGEST * np.sqrt(units.share)[:, None], s))
    small = 0.0 if twist is None else OF_ROUNDS
    accuracies = tuple(ACCURACIES)[small > 0.0 or s.shape[0] >= MANY :]
    met = solve(cp.Problem(cp.Maximize(load - small * size), constraints), WHAT, *accuracies)
    largest = float(load.value)
    of_load = ACCURACIES[met]
    carried = most is not None and most - largest * units.load <= met * units.load
    mechanism = np.zeros((len(assembly.pieces), 6))
    if not carried:
        mechanism = _mechanism(assembly, loads, units, constraints[0].dual_value)
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
        _rounded(largest * units.load, units.load, of_load),
        # Rounded to remove noise; plus 0 turns -0 into 0.
        units.node[:, None] / LARGEST * (np.round(LARGEST * s.value, digits) + 0.0),
        mechanism,
    )


def require_standing(assembly: Assembly, loads: Loads, *, friction: bool = False) -> None:
    """`InfeasibleError` if no forces balance the permanent ``loads`` alone.

    `limit_load` then still has an answer if the variable loads hold ``assembly`` up.
    """
    _require_room(assembly)
    share, s = cp.Variable(), cp.Variable((len(assembly.nodes.area), 3))
    cone, limited = ContactLaw.of(assembly).cone(friction=friction), Limited()
    node = _Scales.of(assembly, loads).node[:, None]

    def force() -> Floats:
        # The part of the loads that is carried has a value even where forces do not exist.
        carried = [*admissible(assembly, loads, cone, 0.0, s, limited, share), share <= 1.0]
        solve(cp.Problem(cp.Maximize(share), carried), WHAT, *ACCURACIES)
        return np.asarray(node * s.value)

    try:
        limited.kept(assembly, force, np.asarray)
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


@dataclass(frozen=True)
class _Scales:
    """Units in which the numbers of the programme are about 1.

    ``load``: N. ``node``: of the force at each node, N, (N,): ten times its ``share`` of that by
    area on a face of mean area. ``row``: of forces (N) and moments (N m) on the free pieces, (R,).
    """

    load: float
    share: Floats
    node: Floats
    row: Floats

    @classmethod
    def of(cls, assembly: Assembly, loads: Loads) -> "_Scales":
        """ValueError if gravity turns."""
        loads.require_proportional()
        share = assembly.nodes.area / assembly.nodes.area.sum()
        node = LARGEST * loads.scale * share * len(assembly.faces)
        # Forces over the load, and moments over the load times the length, are about 1.
        return cls(loads.scale, share, node, row_units(assembly) * loads.scale)


def admissible(
    assembly: Assembly,
    loads: Loads,
    cone: Cone,
    load: cp.Variable | float,
    s: cp.Variable,
    limited: Limited,
    permanent: cp.Variable | float = 1.0,
    twist: Twist | None = None,
) -> list[cp.Constraint]:
    r"""The constraints of limit analysis on the ``load`` and the node forces ``s``, in `_Scales`.

    .. math::

        \begin{aligned}
        \max_{\lambda, s} \quad & \lambda \\
        \text{subject to} \quad & C s = \kappa p + \lambda q & \text{free pieces} \\
        & |s_t| \le \tau A + \mu_b s_n, \quad s_n \ge -\sigma A & \text{bonded nodes} \\
        & |s_t| \le \mu s_n & \text{rough dry nodes} \\
        & s_t = 0, \quad s_n \ge 0 & \text{smooth nodes} \\
        & |s_{t1}| \le \mu s_n, \quad |s_{t2}| \le \tau A, \quad s_n \ge 0 & \text{locks}
        \end{aligned}

    :math:`\lambda` is the load and :math:`\kappa` the part of the ``permanent`` loads p that acts.
    The ``cone`` of the nodes gives tau A, mu and sigma A; a node that is not bonded is rough if its
    mu is above 0. Locks are contact points in their place, t1 along them and t2 across. Added are
    limits of torque by a ``twist``, those of a rule for condensed locks, and those of pressed parts
    of ``limited`` faces by `sidmacib.mechanics.crushing`.
    """
    law, units = ContactLaw.of(assembly), _Scales.of(assembly, loads)
    dry = ~law.cohesive & ~law.locked
    bonded, locks = np.flatnonzero(law.cohesive), np.flatnonzero(law.locked)
    rough = np.flatnonzero(dry & (cone.slope > 0.0))
    smooth = np.flatnonzero(dry & (cone.slope <= 0.0))
    C = _scaled(equilibrium_matrix(assembly)[free_rows(assembly)], units)
    p, q = _scaled_loads(assembly, loads, units)
    tau, mu, sigma = cone.held / units.node, cone.slope, cone.torn / units.node
    s_n, s_t = s[:, 0], s[:, 1:]

    def size(nodes: Integers) -> cp.Expression:
        return cp.norm(s_t[nodes], 2, axis=1)

    def limit(nodes: Integers) -> Floats | cp.Expression:
        by_pressure = cp.multiply(mu[nodes], s_n[nodes]) if mu[nodes].any() else 0.0
        return tau[nodes] + by_pressure

    constraints = [
        # ``s`` acts on the pieces above, C is for those below: hence no minus.
        C @ cp.vec(s, order="C") == permanent * p + load * q,
        size(bonded) <= limit(bonded),
        s_n[bonded] >= -sigma[bonded],
        size(rough) <= limit(rough),
        s_t[smooth] == 0,
        s_n[smooth] >= 0,
    ]
    if tau[rough].any():
        constraints.append(s_n[rough] >= 0)
    if twist is not None and twist.motions:
        forces, limits = twist.rows(assembly, rough, units.node)
        constraints.append(forces @ cp.vec(s_t[rough], order="C") <= limits @ limit(rough))
    if len(locks):
        along, across = mu[locks], tau[locks]
        constraints += [
            s_n[locks] >= 0,
            s_t[locks, 0] <= cp.multiply(along, s_n[locks]),
            -s_t[locks, 0] <= cp.multiply(along, s_n[locks]),
            s_t[locks, 1] <= across,
            -s_t[locks, 1] <= across,
        ]
    return [
        *constraints,
        *_of_rules(assembly, units, s_n, s_t),
        *_of_crushing(assembly, units, limited, s_n, np.where(law.cohesive, sigma, 0.0)),
    ]


def _of_crushing(
    assembly: Assembly, units: _Scales, limited: Limited, s_n: cp.Expression, sigma: Floats
) -> Iterator[cp.Constraint]:
    """Limits of what presses faces; ``sigma``: tensile strengths of the nodes, (N,).

    Where bonds pull at one side of a face, more presses the other.
    """
    found = crushing_rows(assembly, units.node, units.load, limited.faces)
    if found is None:
        return
    rows, limits = found
    pull = np.zeros(len(sigma))
    if sigma.any():
        pull = cp.Variable(len(sigma), nonneg=True)
        yield pull <= sigma
        yield s_n + pull >= 0.0
    yield rows @ (s_n + pull) <= limits


def _of_rules(
    assembly: Assembly, units: _Scales, s_n: cp.Expression, s_t: cp.Expression
) -> Iterator[cp.Constraint]:
    """The limits of V and M of condensed locks, and the compression that these rest on."""
    for number, face in enumerate(assembly.faces):
        if isinstance(face, CondensedLocks) and (limits := face.limits):
            nodes = np.flatnonzero(assembly.nodes.face == number)
            unit, (run, row) = units.node[nodes], face.places.T
            shear, torque = limits.shear[:, None], limits.torque[:, None]
            # What the block below exerts on that above is opposite to V and M.
            along, across = torque * row * unit, (-shear - torque * run) * unit
            yield along @ s_t[nodes, 0] + across @ s_t[nodes, 1] <= 1.0
            if limits.compression > 0.0:
                yield unit / limits.compression @ s_n[nodes] >= 1.0


def _mechanism(assembly: Assembly, loads: Loads, units: _Scales, multipliers: Floats) -> Floats:
    """Motion of the pieces, (P, 6), from the multipliers of the equations of equilibrium."""
    work = float(np.sum(multipliers * _scaled_loads(assembly, loads, units)[1]))
    motion = motion_of(assembly, multipliers / work * (units.load / units.row))
    return np.round(motion, MOTION_DIGITS) + 0.0


def _scaled_loads(assembly: Assembly, loads: Loads, units: _Scales) -> tuple[Floats, Floats]:
    """Permanent and variable loads on the free pieces in ``units``, both (R,)."""
    rows = free_rows(assembly)
    p, q = (each.ravel()[rows] / units.row for each in (loads.permanent, loads.variable))
    return p, q * units.load


def _scaled(matrix: csr_array, units: _Scales) -> csr_array:
    """The ``matrix`` of equilibrium, (R, 3 N), in ``units``."""
    row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    data = matrix.data / units.row[row] * np.repeat(units.node, 3)[matrix.indices]
    return csr_array((data, matrix.indices, matrix.indptr), matrix.shape)


def _rounded(load: float, scale: float, digits: int) -> float:
    """``load`` to so many ``digits``, of itself or of ``scale`` if that is larger; never -0."""
    largest = max(abs(load), scale)
    return round(load, digits - 1 - math.floor(math.log10(largest))) + 0.0
