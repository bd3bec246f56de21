"""Sets of joints: samplings, seeded over spans of parameters, and the grid of the calibration."""

from typing import Annotated, Any

from sidmacib.quantities import Friction, Number, Share, Span
from sidmacib.reading import Section, Some, section_of
from workflow.sampling import Sampling
from workflow.schema.joint import MOST_LOCKS
from workflow.schema.values import Eccentricities, Lengths, Positive

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


class CalibrationSection(Section):
    """A grid of geometries and frictions, meshes (m), and how many of the best the engines run."""

    a: Lengths = (0.03, 0.06, 0.1)
    height_share: Annotated[tuple[Share, ...], Some] = (
        *(0.2, 0.21, 0.22, 0.23),
        *(0.24, 0.25, 0.26),
    )  # h / (h + H)
    height_over_b: Annotated[tuple[Positive, ...], Some] = (
        *(0.3, 0.5, 0.7, 0.9, 1.0),
        *(1.1, 1.2, 1.3, 1.4),
    )  # (h + H) / b
    friction: Annotated[tuple[Friction, ...], Some] = (
        *(0.0, 0.005236, 0.01, 0.02, 0.03),
        *(0.05, 0.1, 0.2, 0.3, 0.4),
    )  # of dry faces
    meshes: Lengths = (0.02, 0.005)
    confirmed: Annotated[int, Number(at_least=1, at_most=20, whole=True)] = 3
