"""The grid of joints of the calibration."""

from typing import Annotated

from sidmacib.quantities import Friction, Number, Share
from workflow.schema.section import Section
from workflow.schema.values import Lengths, Positive, Some


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
