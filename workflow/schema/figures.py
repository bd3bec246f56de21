"""What the figures show."""

from workflow.schema.section import Section
from workflow.schema.values import Length, Positive


class FiguresSection(Section):
    """Mesh (m) of the stress maps, the finest if None, and their eccentricity over a."""

    mesh: Length | None = None
    eccentricity: Positive = 0.5
