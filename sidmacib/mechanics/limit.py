"""Limit analysis of an assembly: the pieces and nodes of the distinct elements, rigid-plastic.

The static theorem: the largest load for which node forces exist that keep every piece in
equilibrium and exceed no strength, see `sidmacib.mechanics.admissible`. Friction is associated:
sliding would dilate, so it overestimates; the torque of a face is limited by a linear pressure, see
`sidmacib.mechanics.twist`. Forces redistribute freely: the geometry alone decides how far each lock
is used, without a reduction rule.

A first programme finds the load. Many states of forces carry it; a second programme, with a small
penalty on the sum of s^2 / A, picks the one for which that sum is least, which is unique. With
limits of torque, or many nodes, one programme with that penalty does both.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import cvxpy as cp
import numpy as np

from sidmacib.errors import (
    DOES_NOT_STAND,
    CapacityError,
    InfeasibleError,
    SolverError,
    UnboundedError,
)
from sidmacib.mechanics.admissible import LARGEST, Scales, admissible, scaled_loads, square_sum
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.crushing import crushed_faces, crushing_use
from sidmacib.mechanics.equilibrium import motion_of
from sidmacib.mechanics.in_plane import Reduced
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.optimisation import solve
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.mechanics.twist import EXCESS, Resultants, Twist

# Accuracy of the load, over itself or the loads' scale if that is larger, and digits that are then
# kept. With an even number of locks, rounding loses the last ones; bonds without friction
# beside dry faces lose more.
ACCURACIES = {1e-9: 9, 1e-7: 7, 1e-5: 5}
MANY = 5000  # nodes from which one programme must do, and not with the highest accuracy
# Penalty of the second programme: so small that it decides between equal loads only.
SMALL = (1e-5, 1e-7, 1e-9)
ONLY = 1e-6  # penalty of an only programme: of a round, whose load settles to less, or of `MANY`
LOST = 1e-8  # relative loss of load by the penalty, at most
MOTION_DIGITS = 9  # of the mechanism
WHAT = "limit analysis"
NOT_PRESSED = "Condensed locks are pressed by less than their hold_down under the permanent loads"
TORQUE_ROUNDS = 30  # at most, with limits of torque
QUICK_ROUNDS = 8  # rounds after which places of pressure are taken from the round before in part
KEPT = 0.6  # that part
NEARER = 5  # times that pressure is taken nearer to the middle where nothing balances the weight
EXCEEDED = 1e-7  # of the limit of a face that may be crushed, by which forces may exceed it
FALLS = 1e-6  # of the scale of the loads: a load that is negative, not 0
SHORT = 1e-5  # of all permanent loads: what may be missing where a structure stands
TORQUE_SETTLED = 1e-3  # change of the load over itself in such rounds
CALM = 3  # rounds in a row that must have settled
NEARLY = 0.01  # over the limits of torque: less is left by rounds that have settled
FAR, NEAR = 1e3, 1.0 - 1e-6  # load over their scale that is as good as unlimited; part to reach it
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
    driven: Floats | None = None,
) -> LimitState:
    """The largest multiple of the variable ``loads`` that ``assembly`` carries.

    ``friction``: whether rough faces resist sliding; friction is associated, so that sliding
    dilates. Dry faces then carry no more torque than a linear pressure over the part that is
    pressed allows, see `sidmacib.mechanics.twist`; where one would, the programme is repeated with
    that limit, until the torques are allowed by the pressure that they are found with and the load
    rises no more, or until it no longer changes. ``most`` (N): the load is not raised beyond this;
    if it is reached, nothing moves. ``driven``: a motion (m and rad) of fixed pieces per m or rad,
    (P, 6), in which the load acts on them, in N or N m; no mechanism is found then.

    Accurate to 1e-9, sometimes 1e-7 or 1e-5, of the load or of ``loads.scale``, whichever is
    larger, and rounded to that; to 1e-3 where torque is limited. ValueError for ``friction`` under
    a fixed plate, whose force has no limit: use a given force instead, see `sidmacib.HoldDown`.
    `sidmacib.errors.CapacityError` if there is no largest load.
    """
    if friction and any(face.kind is Kind.PLATE for face in assembly.faces):
        raise ValueError(
            "friction: must be false under a fixed plate, where associated friction has no limit; "
            "or replace the plate by a force"
        )
    cone = ContactLaw.of(assembly).cone(friction=friction)
    given = partial(solved, assembly, loads, cone, set(), most=most, driven=driven)
    try:
        free = given()
    except UnboundedError:
        if not friction or most is not None:
            raise
        # Perhaps for the want of limits of torque alone.
        far = FAR * loads.scale
        found = limit_load(assembly, loads, friction=True, most=far, driven=driven)
        if found.load > NEAR * far:
            raise
        return replace(found, untwisted=math.inf)
    if not friction or not (twist := Twist.of(assembly, free.force)).motions:
        return free
    lowest = _with_torque(assembly, free, twist, given)
    if lowest.load < -FALLS * loads.scale <= free.load:
        raise InfeasibleError(DOES_NOT_STAND)
    return replace(lowest, untwisted=free.load)


def _with_torque(
    assembly: Assembly, free: LimitState, twist: Twist, given: Callable[..., LimitState]
) -> LimitState:
    """The state by rounds of limits of torque, from the one ``free`` of them."""
    found, nearer, use = [free], 0, math.inf
    admitted: LimitState | None = None  # the highest whose own pressure allows its torques
    while len(found) <= TORQUE_ROUNDS and not _settled([each.load for each in found], use):
        try:
            found.append(given(twist=twist))
        except InfeasibleError:
            nearer += 1
            if nearer > NEARER and admitted:
                break
            if nearer > NEARER:
                raise InfeasibleError(DOES_NOT_STAND) from None
            twist = twist.nearer()
            continue
        if admitted and found[-1].load <= (1.0 + TORQUE_SETTLED) * admitted.load:
            break
        where = Resultants.of(assembly, found[-1].force)
        use = where.most_used
        if use <= 1.0 + EXCESS:
            admitted = found[-1]
        kept = KEPT if len(found) > QUICK_ROUNDS else 0.0
        twist = twist.after(where, kept)
    # The first rounds have the pressure elsewhere; where rounds alternate, the lower load counts.
    return admitted or min(found[-CALM:], key=lambda each: each.load)


def _settled(loads: Sequence[float], use: float) -> bool:
    """Whether the load of the last rounds no longer changes.

    ``use``: of the limits of torque; where it stays above them, there are some rounds more.
    """
    last, least = loads[-CALM - 1 :], CALM if use <= 1.0 + NEARLY else QUICK_ROUNDS
    return len(loads) > least and max(last) - min(last) <= TORQUE_SETTLED * abs(last[-1])


def solved(
    assembly: Assembly,
    loads: Loads,
    cone: Cone,
    limited: set[int],
    *,
    twist: Twist | None = None,
    most: float | None = None,
    driven: Floats | None = None,
) -> LimitState:
    """One round of `limit_load`, or of `sidmacib.mechanics.sliding`.

    ``cone``: of the nodes. ``limited``: numbers of the faces whose limits by their compressive
    strength the programme has, to which those are added that it exceeds otherwise: a face has
    hundreds of rows, and few faces are pressed as much. ``twist``: limits of torque, which rounds
    have.
    """
    units = Scales.of(assembly, loads)
    planar = driven is None  # a support may move out of the plane
    reduced = Reduced.of(assembly, loads, cone) if planar else Reduced.whole(assembly)
    _require_room(assembly, len(reduced.nodes))

    def programme() -> LimitState:
        load, s = cp.Variable(), reduced.unknowns()
        constraints = admissible(
            assembly, loads, cone, load, reduced, s, limited, twist=twist, driven=driven
        )
        if most is not None:
            constraints.append(load <= most / units.load)
        size = square_sum(s, reduced)
        small = 0.0 if twist is None and len(reduced.nodes) < MANY else ONLY
        accuracies = tuple(ACCURACIES)[small > 0.0 :]
        try:
            first = cp.Problem(cp.Maximize(load - small * size), constraints)
            met = solve(first, WHAT, *accuracies)
        except SolverError:  # on the verge of standing, where corners of a linear programme tell
            linear = cp.Problem(cp.Maximize(load), constraints)
            if small or not linear.is_lp():
                raise
            met = solve(linear, WHAT, *accuracies)
        largest = float(load.value)
        of_load = ACCURACIES[met]
        carried = most is not None and most - largest * units.load <= met * units.load
        mechanism = np.zeros((len(assembly.pieces), 6))
        if not carried and driven is None:
            multipliers = reduced.multipliers(constraints[0].dual_value)
            mechanism = _mechanism(assembly, loads, units, multipliers)
        penalties = iter(SMALL)
        while not small or largest - float(load.value) > max(LOST, met) * max(abs(largest), 1.0):
            small = next(penalties, 0.0)
            if not small:
                raise SolverError(
                    f"{WHAT}: the second programme found no forces that carry the limit load"
                )
            objective = cp.Maximize(load - small * size)
            met = max(met, solve(cp.Problem(objective, constraints), WHAT, *accuracies))
        digits, forces = ACCURACIES[met], reduced.at_nodes(s).value
        return LimitState(
            _rounded(largest * units.load, units.load, of_load),
            # Rounded to remove noise; plus 0 turns -0 into 0.
            units.node[:, None] / LARGEST * (np.round(LARGEST * forces, digits) + 0.0),
            mechanism,
        )

    every = {number for number, _, _ in crushed_faces(assembly)}
    while True:
        try:
            state = programme()
            use = crushing_use(assembly, state.force)
            more = {number for number, of in use.items() if of > 1.0 + EXCEEDED}
        except UnboundedError:
            if limited == every:
                raise
            more = every
        if more <= limited:
            return state
        limited |= more


def require_standing(assembly: Assembly, loads: Loads, *, friction: bool = False) -> None:
    """`InfeasibleError` if no forces balance the permanent ``loads`` alone, and why.

    With ``friction`` they keep the limits of torque of `limit_load`. That is asked for the part of
    these loads that is carried, which has a value even where they are not.
    """
    nothing = np.zeros_like(loads.permanent)
    raised = replace(loads, permanent=nothing, variable=loads.permanent / loads.scale)
    try:
        part = limit_load(assembly, raised, friction=friction, most=loads.scale).load / loads.scale
    except InfeasibleError:  # not even without weight, as a rule wants locks to be pressed
        part = 0.0
    if part < 1.0 - SHORT:
        eased = _without_compression(assembly)
        if eased is assembly:
            raise InfeasibleError(DOES_NOT_STAND)
        require_standing(eased, loads, friction=friction)
        raise InfeasibleError(NOT_PRESSED)


def _without_compression(assembly: Assembly) -> Assembly:
    """Without the compression that condensed locks must have, if any must."""
    faces = [
        replace(face, limits=replace(face.limits, compression=0.0))
        if isinstance(face, CondensedLocks) and face.limits and face.limits.compression
        else face
        for face in assembly.faces
    ]
    unchanged = all(one is other for one, other in zip(faces, assembly.faces, strict=True))
    return assembly if unchanged else replace(assembly, faces=tuple(faces))


def _require_room(assembly: Assembly, nodes: int) -> None:
    """`CapacityError` if the programme of ``assembly`` on so many nodes takes too much memory."""
    size = NODE_MEMORY * nodes
    if size > MOST_MEMORY:
        raise CapacityError(
            f"{WHAT}: {len(assembly.pieces):,} pieces with {nodes:,} nodes would take "
            f"{size / 2**30:.1f} GiB; at most {MOST_MEMORY / 2**30:g} GiB are allowed: use fewer "
            "locks or a coarser mesh"
        )


def _mechanism(assembly: Assembly, loads: Loads, units: Scales, multipliers: Floats) -> Floats:
    """Motion of the pieces, (P, 6), from the multipliers of the equations of equilibrium."""
    work = float(np.sum(multipliers * scaled_loads(assembly, loads, units)[1]))
    motion = motion_of(assembly, multipliers / work * (units.load / units.row))
    return np.round(motion, MOTION_DIGITS) + 0.0


def _rounded(load: float, scale: float, digits: int) -> float:
    """``load`` to so many ``digits``, of itself or of ``scale`` if that is larger; never -0."""
    largest = max(abs(load), scale)
    return round(load, digits - 1 - math.floor(math.log10(largest))) + 0.0
