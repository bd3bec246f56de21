"""The outcome of a model for a structure, before it is checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.analysis.mesh_error import UNKNOWN, MeshErrors
from workflow.outcome import Outcome

AT_THE_PEAK = "at the peak"
MECHANISM = "mechanism"  # velocities at the limit load, for 1 m along the load


@dataclass(frozen=True)
class Found:
    """An outcome, and how the pieces move: displacement (m) and rotation (rad), (P, 6).

    ``kind``: of the motion, `AT_THE_PEAK` or `MECHANISM`. Both are None if the model gives none.
    ``broken_at``: the load (N) at which the first bond of a face fails, by the face's index, in the
    order in which they fail; faces whose bonds hold to the end are not there. ``mesh_errors``: of
    the first failure and the peak.
    """

    outcome: Outcome
    motion: Floats | None = None
    kind: str | None = None
    broken_at: Mapping[int, float] = field(default_factory=dict)
    mesh_errors: MeshErrors = UNKNOWN
