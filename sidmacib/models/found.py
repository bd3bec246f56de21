"""The outcome of a model for a structure, before it is checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sidmacib.answers.structure import Counts
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.outcome import Outcome, State
from sidmacib.structure.analysis.mesh_error import UNKNOWN, Failures, MeshErrors

AT_THE_LOAD = "at the load"
MECHANISM = "mechanism"  # velocities at the limit load, for 1 m along the load


@dataclass(frozen=True)
class Found:
    """An outcome, and how the pieces move: displacement (m) and rotation (rad), (P, 6).

    ``kind``: of the motion, `AT_THE_LOAD` or `MECHANISM`. Both are None if the model gives none.
    ``broken_at``: the load (N) at which the first bond of a face fails, by the face's index, in the
    order in which they fail; faces whose bonds hold to the end are not there. ``mesh_errors``: of
    the first failure and the peak. ``counts``: which of the two does; None where the model does not
    say, and its last load counts. ``cells``: the structure on the cells that all of this is from,
    where they are not those of its file; ``given``: the failures (N) on the cells of the file.
    """

    outcome: Outcome
    motion: Floats | None = None
    kind: str | None = None
    broken_at: Mapping[int, float] = field(default_factory=dict)
    mesh_errors: MeshErrors = UNKNOWN
    counts: Counts | None = None
    cells: Assembly | None = None
    given: Failures | None = None

    @property
    def state(self) -> State:
        """The state at the load that counts."""
        first = self.outcome.first_failure_load
        if self.counts is None or self.counts.peak or first is None:
            return self.outcome.path[-1]
        return next(state for state in self.outcome.path if state.load >= first)
