"""What every model gets, a problem, and what it returns, an outcome, with the checks of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.mechanics.loads import Loads

PEAK, FIRST_FAILURE, DRY_PEAK = "peak", "first failure", "peak of dry joints"
AT_THE_LOAD = "at the load"
MECHANISM = "mechanism"  # velocities at the limit load, for 1 m along the load
MOST_UNBALANCED = 0.05  # of the load, on a piece; found up to 0.007


class Problem(NamedTuple):
    """Pieces with their faces and nodes, and the loads on them."""

    assembly: Assembly
    loads: Loads


class Failures(NamedTuple):
    """First failure and peak: loads in N, or angles in degrees where gravity turns."""

    first: float
    peak: float


class MeshErrors(NamedTuple):
    """Errors of the first failure and the peak, each over itself; None of one that is not known."""

    first: float | None
    peak: float | None


UNKNOWN = MeshErrors(None, None)


@dataclass(frozen=True)
class Counts:
    """Whether the peak counts, or the first failure, and ``why``.

    ``dry``: whether the peak is that of dry joints, in place of bonds that fail before.
    """

    peak: bool
    why: str
    dry: bool = False

    @property
    def name(self) -> str:
        """What counts."""
        return (DRY_PEAK if self.dry else PEAK) if self.peak else FIRST_FAILURE

    def __str__(self) -> str:
        return f"the {self.name} counts: {self.why}"


@dataclass(frozen=True)
class State:
    """A ``load`` (N, along the direction of loading) that is carried.

    ``displacement``: the one that the load does work on, in m. ``force``: (N, 3) in N, on the piece
    above in the frame of the face, see `sidmacib.mechanics.equilibrium.face_frames`. ``bonded``:
    (N,). ``motion``: of the pieces since they were built, see
    `sidmacib.mechanics.equilibrium.placed`. Each is None if the model does not give it.
    """

    load: float
    displacement: float | None = None
    force: Floats | None = None
    bonded: Flags | None = None
    motion: Floats | None = None


@dataclass(frozen=True)
class Outcome:
    """States on the way, the last of them the capacity, and loads in N.

    ``failed_load``: the smallest load known not to be carried. ``first_failure_load``: where the
    first node fails; None in a model without failure. ``mode``: how the joint gives way; None if
    the model does not say. ``peak_spread``: of the peaks that were found, see
    `sidmacib.mechanics.static.peaks`. ``peak_load``: of the peak; None in a model without
    one.

    ``motion``: displacement (m) and rotation (rad) of each piece, (P, 6), and its ``motion_kind``,
    `AT_THE_LOAD` or `MECHANISM`; both None if the model gives none. ``broken_at``: the load (N) at
    which the first bond of a face fails, by the face's index, in the order in which they fail;
    faces whose bonds hold to the end are not there. ``mesh_errors``: of the first failure and the
    peak. ``counts``: which of the two does; None where the model does not say, and its last load
    counts. ``cells``: the pieces on the cells that all of this is from, where they are not those of
    the problem; ``given``: the failures (N) on the cells of the problem, with springs at nodes as
    engines have them; None where there are none. ``notes``: what it rests on, in words.
    """

    path: tuple[State, ...]
    failed_load: float
    first_failure_load: float | None = None
    mode: str | None = None
    peak_spread: float | None = None
    peak_load: float | None = None
    motion: Floats | None = None
    motion_kind: str | None = None
    broken_at: Mapping[int, float] = field(default_factory=dict)
    mesh_errors: MeshErrors = UNKNOWN
    counts: Counts | None = None
    cells: Assembly | None = None
    given: Failures | None = None
    notes: tuple[str, ...] = ()

    @property
    def state(self) -> State:
        """The state at the load that counts."""
        first = self.first_failure_load
        if self.counts is None or self.counts.peak or first is None:
            return self.path[-1]
        return next(state for state in self.path if state.load >= first)


def checked_share(problem: Problem, outcome: Outcome) -> float | None:
    """The largest force (or moment over a length) left on a piece, over the load.

    None where the model gives no forces. `ResultError` where ``outcome`` cannot be of ``problem``.
    """
    assembly, state = outcome.cells or problem.assembly, outcome.state
    check_loads(outcome)
    if state.force is None:
        return None
    if state.force.shape != (len(assembly.nodes.area), 3):
        raise ResultError(
            f"{len(state.force)} nodes have stresses, but the case has {len(assembly.nodes.area)}"
        )
    if not np.isfinite(state.force).all():
        raise ResultError("a stress is not a finite number")
    motion = outcome.motion if outcome.motion_kind == AT_THE_LOAD else state.motion
    share = unbalanced_share(assembly, problem.loads, state.load, state.force, motion)
    check_balance(share, state.load, problem.loads)
    return share


def check_loads(outcome: Outcome) -> None:
    """Raise `ResultError` where loads of ``outcome`` contradict each other."""
    peak, failed, first = outcome.path[-1].load, outcome.failed_load, outcome.first_failure_load
    if not (math.isfinite(peak) and peak > 0.0):
        raise ResultError(f"peak load {peak:g} N is not allowed; it must be finite and above 0")
    if not (math.isfinite(failed) and failed >= peak * (1.0 - 1e-12)):
        raise ResultError(
            f"failed load {failed:g} N is not allowed; it must be finite and at least {peak:g} N"
        )
    if first is not None and not 0.0 <= first <= failed:
        raise ResultError(
            f"first failure at {first:g} N is not allowed; it must be from 0 to {failed:g} N"
        )
    for state in outcome.path:
        if not math.isfinite(state.load) or state.load > peak * (1.0 + 1e-12):
            raise ResultError(
                f"load {state.load:g} N is not allowed on the path to a peak of {peak:g} N"
            )
        if state.displacement is not None and not math.isfinite(state.displacement):
            raise ResultError(
                f"displacement {state.displacement:g} m at {state.load:g} N is not allowed; "
                "it must be finite"
            )


def check_balance(share: float, load: float, loads: Loads) -> None:
    """Raise `ResultError` where stresses do not balance the loads; ``share``: of ``load`` (N)."""
    always = float(np.linalg.norm(loads.permanent[:, :3], axis=1).sum())
    allowed = MOST_UNBALANCED * max(load, always)
    if not (math.isfinite(share) and share * load <= allowed):
        raise ResultError(
            f"stresses do not balance the loads: {share:.3g} times the load is left on a piece; it "
            f"must be {MOST_UNBALANCED:g} or less"
        )
