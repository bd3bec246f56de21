"""Limit analysis of sliding without dilation, by rounds of associated problems.

Limit analysis assumes associated friction: what slides also opens, and so is held more firmly than
by Coulomb's friction. Gilbert, Casapulla & Ahmed (Limit analysis of masonry block structures with
non-associative frictional joints using linear programming, Computers and Structures 84, 2006,
doi:10.1016/j.compstruc.2006.02.005) replace each friction cone by a limit that hardly depends on
the normal force, and which passes through the friction cone at the normal force of the round
before. Sliding then opens next to nothing. Rounds end when the load no longer changes.

The load that they end with is one at which the structure moves with sliding that does not dilate.
Such loads are not unique, and this one is no strict bound: it lies below the associated load, and
above or below what a path of loading with its history of friction reaches. Rounds that alternate
take ever smaller steps; where they do not settle even so, there is no answer.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.errors import DOES_NOT_STAND, CapacityError, InfeasibleError, SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law import Cone, ContactLaw, Flags
from sidmacib.mechanics.in_plane import Reduced
from sidmacib.mechanics.limit import CALM, FALLS, LimitState, limit_load, solved
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.twist import Resultants, Twist
from sidmacib.quantities import four_digits

SLOPE = 0.01  # of the limit, over the friction coefficient
STEP = 0.6  # weight of the last round's normal forces, against those of the round before
SHORTER = 0.7  # its factor after a round in which the load turned back, else its divisor
LEAST_WEIGHT, MOST_WEIGHT = 0.05, 1.0  # of it
SLIDING_ROUNDS = 30  # at most
SLIDING_SETTLED = 3e-4  # change of the load over itself in one round
LAST = 10  # rounds in a row whose loads differ by no more than
ALIKE = 3e-3  # over the lowest, which then counts, have settled too
OFF_CONE = 0.02  # largest shear beyond friction at the end, over the largest normal force
MOST_NODES = 6000  # or places in a plane: the rounds of a larger assembly take many minutes
WITHOUT_DILATION = "limit analysis without dilation"


@dataclass(frozen=True)
class SlidingLimit:
    """The limit state of sliding without dilation, and that of associated friction."""

    state: LimitState
    associated: LimitState
    rounds: int


def sliding_limit(
    assembly: Assembly, loads: Loads, associated: LimitState | None = None
) -> SlidingLimit:
    """The load at which ``assembly`` moves with sliding on dry faces that does not dilate.

    ``associated``: by `limit_load` with friction, if it is known. Torque of dry faces is limited as
    there. Errors of that, and `sidmacib.errors.InfeasibleError` if the structure then does not
    stand under its permanent loads; `sidmacib.errors.SolverError` where the rounds do not settle;
    `sidmacib.errors.CapacityError` for too large an assembly, at once.
    """
    nodes = len(Reduced.of(assembly, loads, ContactLaw.of(assembly).cone()).nodes)
    if nodes > MOST_NODES:
        raise CapacityError(
            f"{WITHOUT_DILATION}: {nodes:,} nodes; at most {MOST_NODES:,} are allowed"
        )
    associated = associated or limit_load(assembly, loads, friction=True)
    found = _rounds(assembly, loads, associated)
    if found.state.load < -FALLS * loads.scale:
        raise InfeasibleError(f"{DOES_NOT_STAND} where sliding does not dilate")
    return found


def _rounds(assembly: Assembly, loads: Loads, associated: LimitState) -> SlidingLimit:
    """The rounds from the state with ``associated`` friction on."""
    slides = np.array([face.kind is not Kind.LOCKED for face in assembly.faces])
    slides = slides[assembly.nodes.face]  # by friction, also where it is bonded
    cone = ContactLaw.of(assembly).cone()
    normal, twist = associated.force[:, 0], Twist.of(assembly, associated.force)
    limited: set[int] = set()
    held, found, calm, step, change = normal, [associated], 0, STEP, 0.0
    for number in range(1, SLIDING_ROUNDS + 1):
        given = cone.held + (1.0 - SLOPE) * cone.slope * normal  # tension weakens bonds
        flat = Cone(
            np.where(slides, np.maximum(given, 0.0), cone.held),
            np.where(slides, SLOPE * cone.slope, cone.slope),
            cone.torn,
        )
        try:
            state = solved(assembly, loads, flat, limited, twist=twist)
        except (InfeasibleError, SolverError):
            # Too little friction for the weight: half way back.
            normal, step, twist = (normal + held) / 2.0, SHORTER * step, twist.nearer()
            continue
        held = normal
        before, change = change, state.load - found[-1].load
        found.append(state)
        turned = before * change < 0.0
        step = max(LEAST_WEIGHT, SHORTER * step) if turned else min(MOST_WEIGHT, step / SHORTER)
        normal = step * state.force[:, 0] + (1.0 - step) * normal
        twist = twist.after(Resultants.of(assembly, state.force), max(0.0, 1.0 - step))
        calm = calm + 1 if abs(change) <= SLIDING_SETTLED * abs(state.load) else 0
        if calm >= CALM and _off_cone(cone, slides, state.force) <= OFF_CONE:
            return SlidingLimit(state, associated, number)
        last = sorted(found[-LAST:], key=lambda each: each.load)
        close = last[-1].load - last[0].load <= ALIKE * abs(last[0].load)
        if len(found) > LAST and close:
            return SlidingLimit(last[0], associated, number)
    if len(found) == 1:
        raise SolverError(
            f"{WITHOUT_DILATION}: {SLIDING_ROUNDS} rounds find no forces that balance the weight"
        )
    raise SolverError(
        f"{WITHOUT_DILATION}: rounds do not settle; the last {len(last)} go from "
        f"{four_digits(last[0].load)} to {four_digits(last[-1].load)} N"
    )


def _off_cone(cone: Cone, slides: Flags, force: Floats) -> float:
    """Largest shear of rough ``slides`` beyond their ``cone``, over the largest normal force."""
    beyond = np.hypot(force[:, 1], force[:, 2]) - cone.shear(force[:, 0])
    beyond = beyond[slides & (cone.slope > 0.0)]
    largest = float(np.abs(force[:, 0]).max())
    return float(beyond.max(initial=0.0)) / largest if largest > 0.0 else 0.0
