"""Joints beside the samples: those of a designed study, and the grid of the calibration."""

from typing import Annotated, Any

from sidmacib.quantities import Friction, Number, Span
from workflow.design import Design
from workflow.schema.joint import MOST_LOCKS
from workflow.schema.section import Section, section_of
from workflow.schema.values import Eccentricities, Lengths, Positive, Share, Some

MOST_JOINTS = 1_000_000

_Count = Annotated[int, Number(at_least=1, at_most=MOST_JOINTS, whole=True)]
_Locks = Annotated[tuple[int, int], Span(Number(at_least=2, at_most=MOST_LOCKS, whole=True))]
_Cells = Annotated[tuple[int, int], Span(Number(at_least=1, at_most=8, whole=True))]
_DESIGN: Any = section_of(Design, joints=_Count, locks=_Locks)


class DesignSection(_DESIGN):
    """How many joints, and over which spans; see `workflow.design.Design`.

    Widths, strengths and normal stiffness are those of the study. ``cells``: along the shorter
    side of a lock, on two meshes. ``limited``: one joint in as many has limit analysis too.
    """

    eccentricities: Eccentricities | None = None
    cells: _Cells = (1, 2)
    limited: _Count = 16

    def design(self) -> Design:
        """The section as `workflow.design` takes it."""
        return Design(**self.model_dump(exclude={"eccentricities", "cells", "limited"}))


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
