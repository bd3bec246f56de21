"""A sampling: a seeded set of joints over spans of their parameters."""

from typing import Annotated, Any

from sidmacib.quantities import Number, Span
from workflow.sampling import Sampling
from workflow.schema.joint import MOST_LOCKS
from workflow.schema.section import section_of
from workflow.schema.values import Eccentricities

MOST_JOINTS = 1_000_000

_Count = Annotated[int, Number(at_least=1, at_most=MOST_JOINTS, whole=True)]
_Locks = Annotated[tuple[int, int], Span(Number(at_least=2, at_most=MOST_LOCKS, whole=True))]
_Cells = Annotated[tuple[int, int], Span(Number(at_least=1, at_most=8, whole=True))]
_SAMPLING: Any = section_of(Sampling, joints=_Count, locks=_Locks)


class SamplingSection(_SAMPLING):
    """Number of joints and ranges of a sampling; see `workflow.sampling.Sampling`.

    Width, strengths and normal stiffness are those of the study. ``cells``: numbers of cells along
    the shorter side of a lock, of the two meshes. ``limited``: one in so many joints is solved by
    limit analysis too.
    """

    eccentricities: Eccentricities | None = None
    cells: _Cells = (1, 2)
    limited: _Count = 16

    def sampling(self) -> Sampling:
        """The sampling, without the keys about solving its joints."""
        return Sampling(**self.model_dump(exclude={"eccentricities", "cells", "limited"}))
