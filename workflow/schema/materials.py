"""Materials of the joints."""

from typing import Any

from sidmacib.joint import DRY, INNER, Joint
from sidmacib.mechanics.assembly import FaceMaterial
from workflow.schema.section import Section, changes_to, section_of
from workflow.schema.values import (
    Density,
    FractureEnergy,
    Friction,
    Modulus,
    NoStrength,
    Poisson,
    Residual,
    Stiffness,
    Strength,
    StrengthOrNone,
)

_ELASTIC = {
    "normal_stiffness": Stiffness,
    "shear_stiffness": Stiffness,
    "friction": Friction,
}
_INNER: Any = section_of(
    INNER,
    **_ELASTIC,
    cohesion=Strength,
    tensile_strength=StrengthOrNone,
    residual=Residual,
    fracture_energy=FractureEnergy,
)
_DRY: Any = section_of(DRY, **_ELASTIC, cohesion=NoStrength, tensile_strength=NoStrength)


class InnerFaceSection(_INNER):
    """Cohesive faces inside a block, see `sidmacib.mechanics.assembly.FaceMaterial`."""


class DryFaceSection(_DRY):
    """Frictional faces between the blocks; they have no strength of their own."""


_INNER_CHANGES: Any = changes_to(InnerFaceSection)
_DRY_CHANGES: Any = changes_to(DryFaceSection)


class InnerChanges(_INNER_CHANGES):
    """What differs on inner faces; None means no change."""

    def changed(self, inner: InnerFaceSection) -> InnerFaceSection:
        """``inner`` with these changes."""
        return inner.model_copy(update=self.model_dump(exclude_none=True))


class DryChanges(_DRY_CHANGES):
    """What differs on dry faces; None means no change."""

    def changed(self, dry: DryFaceSection) -> DryFaceSection:
        """``dry`` with these changes."""
        return dry.model_copy(update=self.model_dump(exclude_none=True))


class MaterialsSection(Section):
    """Density (kg/m3), Young's modulus (Pa) and Poisson's ratio of the block, and its faces."""

    density: Density = Joint(locks=3).density
    young: Modulus = 1e10
    poisson: Poisson = 0.2
    inner: InnerFaceSection = InnerFaceSection()
    dry: DryFaceSection = DryFaceSection()


def face_material(section: InnerFaceSection | DryFaceSection) -> FaceMaterial:
    """The section as the models take it."""
    return FaceMaterial(**section.model_dump())
