"""Cuts, loads, hold-down and failure of the joint, in every model of its pieces."""

from enum import StrEnum
from typing import Any

from sidmacib.joint.joint import HeldDown, HoldDown, UpperBody
from sidmacib.joint.loading import LoadShare, Push
from sidmacib.mechanics.assembly import Failure, NodeLayout
from sidmacib.quantities import FractureEnergy, Modulus
from sidmacib.reading import Section, changes_to
from workflow.schema.dem import NumericsChanges
from workflow.schema.values import Eccentricities, Lengths


class Pieces(StrEnum):
    """Rigid or elastic pieces of the joint."""

    RIGID = "rigid"
    ELASTIC = "elastic"  # with the material of the block


class AssemblySection(Section):
    """Cuts, loads, hold-down and failure of the joint."""

    pieces: Pieces = Pieces.RIGID
    failure: Failure = Failure.BRITTLE
    load_share: LoadShare = LoadShare.FACE
    upper_body: UpperBody = UpperBody.COLUMNS
    push: Push = Push.PLUS_Y
    hold_down: HeldDown = HoldDown()


_CHANGES: Any = changes_to(AssemblySection)


class VariantSection(_CHANGES):
    """Changes to the study, and the meshes and eccentricities at which it runs (None: all).

    ``young``: of the block (Pa). ``fracture_energy``: of the inner faces (J/m2).
    """

    numerics: NumericsChanges = NumericsChanges()
    nodes: NodeLayout | None = None
    young: Modulus | None = None
    fracture_energy: FractureEnergy | None = None
    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None

    @property
    def material(self) -> tuple[float | None, float | None]:
        """Its changes to the materials."""
        return self.young, self.fracture_energy

    def assembly(self, study: AssemblySection) -> AssemblySection:
        """The assembly of this variant."""
        changes = {key: getattr(self, key) for key in AssemblySection.model_fields}
        return study.model_copy(update={k: v for k, v in changes.items() if v is not None})
