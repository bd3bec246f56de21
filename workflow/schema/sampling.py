"""A sampling: a seeded set of joints over spans of their parameters."""

from typing import Annotated, Any

from pydantic import BeforeValidator

from sidmacib.mechanics.assembly import Failure
from workflow.sampling import Sampling
from workflow.schema.geometry import MOST_LOCKS
from workflow.schema.section import Section
from workflow.schema.values import Eccentricities, Number, shown

MOST_JOINTS = 1_000_000


def span(number: Number) -> BeforeValidator:
    """A list of the least and the largest value."""

    def checked(value: Any) -> tuple[float, float]:
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise ValueError(
                f"{shown(value)} is not allowed; it must be a list of the least and the largest "
                "value"
            )
        least, largest = map(number, value)
        if least > largest:
            raise ValueError(f"[{least:g}, {largest:g}] is not allowed; the first must not be more")
        return least, largest

    return BeforeValidator(checked)


_Ratios = Annotated[tuple[float, float], span(Number(above=0))]
_Locks = Annotated[tuple[int, int], span(Number(at_least=2, at_most=MOST_LOCKS, whole=True))]
_Frictions = Annotated[tuple[float, float], span(Number(at_least=0))]
_Cells = Annotated[tuple[int, int], span(Number(at_least=1, at_most=8, whole=True))]
_Part = Annotated[float, BeforeValidator(Number(at_least=0, at_most=1))]
_Count = Annotated[int, BeforeValidator(Number(at_least=1, at_most=MOST_JOINTS, whole=True))]
_Seed = Annotated[int, BeforeValidator(Number(at_least=0, at_most=2**31, whole=True))]


class SamplingSection(Section):
    """How many joints, and over which spans; see `workflow.sampling.Sampling`.

    Width, strengths and normal stiffness are those of the study. ``cells``: numbers of cells along
    the shorter side of a lock, of the two meshes. ``limited``: one in so many joints is solved by
    limit analysis too.
    """

    joints: _Count
    seed: _Seed = 1
    eccentricities: Eccentricities | None = None
    failure: Failure = Failure.BRITTLE
    locks: _Locks = (2, 31)
    a_over_b: _Ratios = (0.5, 3.0)
    h_over_b: _Ratios = (0.06, 0.6)
    H_over_b: _Ratios = (0.3, 3.0)
    shear_over_normal: _Ratios = (0.003, 3.0)
    dry_over_inner: _Ratios = (0.03, 30.0)
    friction: _Frictions = (0.0, 0.8)
    pressure_over_cohesion: _Ratios = (0.03, 1.0)
    stiffness_ratio: _Ratios | None = None
    energy_ratio: _Ratios = (1.0, 1000.0)
    smooth: _Part = 0.3
    one_piece: _Part = 0.5
    pressed: _Part = 0.2
    cells: _Cells = (1, 2)
    limited: _Count = 16

    def sampling(self) -> Sampling:
        """The section without what is asked of each joint."""
        return Sampling(**self.model_dump(exclude={"eccentricities", "cells", "limited"}))
