"""Limit analysis of sliding without dilation, by rounds of associated problems.

Limit analysis assumes associated friction: what slides also opens, and so is held more firmly than
by Coulomb's friction. Gilbert, Casapulla & Ahmed (Limit analysis of masonry block structures with
non-associative frictional joints using linear programming, Computers and Structures 84, 2006,
doi:10.1016/j.compstruc.2006.02.005) replace each friction cone by a limit that hardly depends on
the normal force, and which passes through the friction cone at the normal force of the round
before. Sliding then opens next to nothing. Rounds end when the load no longer changes.

The load that they end with is one at which the structure moves with sliding that does not dilate.
Such loads are not unique, and this one is no strict bound: it lies below the associated load, and
above or below what a path of loading with its history of friction reaches.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import LimitState, Sliding, limit_load

SLOPE = 0.01  # of the limit, over the friction coefficient
KEPT = 0.6  # weight of the last round's normal forces, against those of the round before
ROUNDS = 60  # at most
SETTLED = 1e-4  # change of the load over itself in one round
CALM = 3  # rounds in a row that must have settled
LAST = 10  # rounds whose loads are named where they have not
OFF_CONE = 0.02  # largest shear beyond friction at the end, over the largest normal force


@dataclass(frozen=True)
class SlidingLimit:
    """The limit state of sliding without dilation, and that of associated friction."""

    state: LimitState
    associated: LimitState
    rounds: int

    @property
    def overestimate(self) -> float:
        """By how much associated friction is higher, over the load without dilation."""
        return self.associated.load / self.state.load - 1.0


def sliding_limit(assembly: Assembly, loads: Loads) -> SlidingLimit:
    """The load at which ``assembly`` moves with sliding on dry faces that does not dilate.

    Errors of `limit_load`; `sidmacib.errors.SolverError` if the rounds do not settle.
    """
    dry = np.array([face.kind is Kind.DRY for face in assembly.faces])[assembly.nodes.face]
    friction = np.where(dry, ContactLaw.of(assembly).friction, 0.0)
    associated = state = limit_load(assembly, loads, friction=True)
    normal, calm = associated.force[:, 0], 0
    found: list[float] = []
    for number in range(1, ROUNDS + 1):
        before = state.load
        slope = SLOPE * friction
        state = limit_load(
            assembly,
            loads,
            friction=True,
            sliding=Sliding((1.0 - SLOPE) * friction * np.maximum(normal, 0.0), slope),
        )
        found.append(state.load)
        normal = KEPT * state.force[:, 0] + (1.0 - KEPT) * normal
        calm = calm + 1 if abs(state.load - before) <= SETTLED * abs(state.load) else 0
        if calm == CALM and _off_cone(friction, state.force) <= OFF_CONE:
            return SlidingLimit(state, associated, number)
    low, high = min(found[-LAST:]), max(found[-LAST:])
    raise SolverError(
        f"limit analysis without dilation: {ROUNDS} rounds do not settle, as such loads are not "
        f"unique; the last ones are from {low:.5g} to {high:.5g} N"
    )


def _off_cone(friction: Floats, force: Floats) -> float:
    """Largest shear beyond Coulomb's friction, over the largest normal force."""
    rough = friction > 0.0
    shear = np.hypot(force[rough, 1], force[rough, 2])
    beyond = shear - friction[rough] * force[rough, 0]
    largest = float(np.abs(force[:, 0]).max())
    return float(beyond.max(initial=0.0)) / largest if largest > 0.0 else 0.0
