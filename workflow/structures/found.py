"""What a model finds for a structure, before it is checked."""

from dataclasses import dataclass

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.mesh_error import UNKNOWN, MeshErrors
from workflow.outcome import Outcome

AT_THE_PEAK = "at the peak"
MECHANISM = "mechanism"  # velocities at the limit load, for 1 m along the load


@dataclass(frozen=True)
class Found:
    """An outcome, and how the pieces move: displacement (m) and rotation (rad), (P, 6).

    ``kind``: of the motion, `AT_THE_PEAK` or `MECHANISM`. Both are None if the model gives none.
    ``first_face``: index of the face whose bond fails first; None if none does. ``mesh_errors``: of
    the first failure and the peak.
    """

    outcome: Outcome
    motion: Floats | None = None
    kind: str | None = None
    first_face: int | None = None
    mesh_errors: MeshErrors = UNKNOWN
