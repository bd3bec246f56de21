"""The part of a record that only cases in time have: the motion, and what falls."""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.answers.in_time import TimeAnswer
from sidmacib.quantities import rounded
from sidmacib.structure.shaking import TimeLoads
from workflow.case import EarthquakeCase
from workflow.results import Record


@dataclass(frozen=True)
class EarthquakePart:
    """Structure, record and factor of a case, and what happens.

    ``peak_acceleration_m_s2`` and ``peak_velocity_m_s``: the largest of the ground, of all its
    components together. ``falls``: None if that is open. ``first_block``: the one that falls first,
    at ``falls_at_s``. Displacements and rotations are those of the block that has the largest.
    ``note``: what the answer rests on.
    """

    structure: str
    record: str
    factor: float
    peak_acceleration_m_s2: float | None = None
    peak_velocity_m_s: float | None = None
    falls: bool | None = None
    first_block: str | None = None
    falls_at_s: float | None = None
    displacement_m: float | None = None
    rotation_degrees: float | None = None
    last_displacement_m: float | None = None
    last_rotation_degrees: float | None = None
    note: str | None = None

    @classmethod
    def without_result(cls, case: EarthquakeCase) -> "EarthquakePart":
        """The names of ``case``."""
        of = case.subject
        return cls(of.structure, of.record, of.factor)

    @classmethod
    def moved(cls, case: EarthquakeCase, answer: TimeAnswer) -> "EarthquakePart":
        """What an answer in time says."""
        of, found = case.subject, answer.history
        loads, first = answer.problem.loads, found.first_fallen
        assert isinstance(loads, TimeLoads), "loads in time"
        ground = loads.accelerations(of.factor)
        velocity = loads.step * np.cumsum(ground, axis=0)
        degrees = math.degrees(1.0)
        return cls(
            *(of.structure, of.record, of.factor),
            peak_acceleration_m_s2=_largest(ground),
            peak_velocity_m_s=_largest(velocity),
            falls={"No": True, "Yes": False}.get(answer.said),
            first_block=None if first is None else answer.problem.assembly.pieces[first].name,
            falls_at_s=None if first is None else rounded(float(found.fallen[first])),
            displacement_m=rounded(answer.largest_shift.size),
            rotation_degrees=rounded(degrees * answer.largest_turn.size),
            last_displacement_m=rounded(answer.last_shift.size),
            last_rotation_degrees=rounded(degrees * answer.last_turn.size),
            note=answer.words if answer.said == "Open" else answer.note,
        )


def _largest(vectors: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]") -> float:
    return rounded(float(np.linalg.norm(vectors, axis=1).max()))


PART = EarthquakePart
EarthquakeRecord = Record[EarthquakePart]
