"""How the joint is cut, loaded and fails, in every model of its pieces."""

from enum import StrEnum
from typing import Any

from sidmacib.joint import UpperBody
from sidmacib.loading import LoadShare, Push
from sidmacib.mechanics.assembly import Failure, NodeLayout
from workflow.schema.numerics import NumericsChanges
from workflow.schema.section import Section, changes_to
from workflow.schema.values import Eccentricities, Lengths


class Pieces(StrEnum):
    """What the pieces of the joint are."""

    RIGID = "rigid"
    ELASTIC = "elastic"  # with the material of the block


class AssemblySection(Section):
    """How the joint is cut, loaded and fails."""

    pieces: Pieces = Pieces.RIGID
    failure: Failure = Failure.BRITTLE
    load_share: LoadShare = LoadShare.FACE
    upper_body: UpperBody = UpperBody.COLUMNS
    push: Push = Push.PLUS_Y


_CHANGES: Any = changes_to(AssemblySection)


class VariantSection(_CHANGES):
    """What differs from the study, and at which meshes and eccentricities (None: at all)."""

    numerics: NumericsChanges = NumericsChanges()
    nodes: NodeLayout | None = None
    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None

    def assembly(self, study: AssemblySection) -> AssemblySection:
        """The assembly of this variant."""
        own = self.model_dump(include=set(AssemblySection.model_fields), exclude_none=True)
        return study.model_copy(update=own)
