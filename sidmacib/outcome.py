"""The outcome of a model, before it is checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Flags

PEAK, FIRST_FAILURE = "peak", "first failure"
AT_THE_LOAD = "at the load"
MECHANISM = "mechanism"  # velocities at the limit load, for 1 m along the load


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
    """Whether the peak counts, or the first failure, and ``why``."""

    peak: bool
    why: str

    @property
    def name(self) -> str:
        """Which of the two counts."""
        return PEAK if self.peak else FIRST_FAILURE

    def __str__(self) -> str:
        return f"the {self.name} counts: {self.why}"


@dataclass(frozen=True)
class State:
    """A ``load`` (N, along the direction of loading) that is carried.

    ``displacement``: the one that the load does work on, in m. ``force``: (N, 3) in N, on the piece
    above in the frame of the face, see `sidmacib.mechanics.equilibrium.face_frames`. ``bonded``:
    (N,). Each is None if the model does not give it.
    """

    load: float
    displacement: float | None = None
    force: Floats | None = None
    bonded: Flags | None = None


@dataclass(frozen=True)
class Outcome:
    """States on the way, the last of them the capacity, and loads in N.

    ``failed_load``: the smallest load known not to be carried. ``first_failure_load``: where the
    first node fails; None in a model without failure. ``mode``: how the joint gives way; None if
    the model does not say. ``peak_spread``: of the peaks that were found, see
    `sidmacib.mechanics.static.lowest_peak`. ``peak_load``: of the peak; None in a model without
    one.

    ``motion``: displacement (m) and rotation (rad) of each piece, (P, 6), and its ``motion_kind``,
    `AT_THE_LOAD` or `MECHANISM`; both None if the model gives none. ``broken_at``: the load (N) at
    which the first bond of a face fails, by the face's index, in the order in which they fail;
    faces whose bonds hold to the end are not there. ``mesh_errors``: of the first failure and the
    peak. ``counts``: which of the two does; None where the model does not say, and its last load
    counts. ``cells``: the pieces on the cells that all of this is from, where they are not those of
    the problem; ``given``: the failures (N) on the cells of the problem.
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

    @property
    def state(self) -> State:
        """The state at the load that counts."""
        first = self.first_failure_load
        if self.counts is None or self.counts.peak or first is None:
            return self.path[-1]
        return next(state for state in self.path if state.load >= first)
