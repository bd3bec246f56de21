"""The part of a record that only joints have: place, shear and torque, and lock weights."""

from dataclasses import dataclass, replace
from typing import Any

from sidmacib.joint.pieces import LockWeight, lock_weights
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.loads import Loads
from sidmacib.mesh_error import cells_of
from sidmacib.problem import Outcome
from sidmacib.quantities import clean, rounded
from workflow.case import JointCase
from workflow.results import Record

NOISE = 1e-9  # of a weight or a share: less counts as 0
NOISE_OF_BALANCE = 1e-12


@dataclass(frozen=True)
class JointPart:
    """The place of a joint's case, shear (N) and torque (N m) at the load, and lock weights."""

    sample: str
    case: str  # identity apart from model and variant; tables join on it
    locks: int
    mesh_m: float
    cells: float  # along a side of the locks' horizontal faces, see `sidmacib.mesh_error`
    nodes: str
    eccentricity_over_a: float
    eccentricity_m: float
    series: str  # digest of the subject but for the mesh
    shear_N: float | None = None
    torque_Nm: float | None = None
    weights: tuple[LockWeight, ...] = ()

    @classmethod
    def without_result(cls, case: JointCase) -> "JointPart":
        """The place of ``case``."""
        subject = case.subject
        return cls(
            sample=subject.sample,
            case=subject.key,
            locks=subject.joint.locks,
            mesh_m=subject.mesh,
            cells=rounded(cells_of(subject.joint, subject.mesh)),
            nodes=str(subject.nodes),
            eccentricity_over_a=subject.direction.eccentricity,
            eccentricity_m=subject.eccentricity_m,
            series=subject.series(),
        )

    @classmethod
    def of(cls, case: JointCase, assembly: Assembly, loads: Loads, outcome: Outcome) -> "JointPart":
        """The place of ``case``, and what its outcome says."""
        joint, direction, peak = case.subject.joint, case.subject.direction, outcome.state
        weights: tuple[LockWeight, ...] = ()
        if peak.force is not None:
            weights = lock_weights(joint, assembly, peak.force)
        return replace(
            cls.without_result(case),
            shear_N=rounded(peak.load * direction.shear),
            torque_Nm=rounded(peak.load * direction.torque * joint.a),
            weights=tuple(_rounded_weight(each, joint.T0) for each in weights),
        )

    @staticmethod
    def balance(share: float) -> float:
        """The unbalanced ``share`` without the noise of processors."""
        return clean(share, NOISE_OF_BALANCE)


PART = JointPart
JointRecord = Record[JointPart]


def _rounded_weight(each: LockWeight, strength: float) -> LockWeight:
    shares: dict[str, Any] = {
        name: clean(getattr(each, name), NOISE)
        for name in ("weight", "mean_shear_ratio", "max_shear_ratio")
    }
    forces: dict[str, Any] = {
        name: clean(getattr(each, name), NOISE * strength) for name in ("shear_x_N", "shear_y_N")
    }
    return replace(each, **shares, **forces)
