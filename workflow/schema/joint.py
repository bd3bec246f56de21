"""The joints of a study: sizes, materials, and locks that differ.

Keys, ranges, units and defaults are those of `sidmacib.Joint`; narrower only where a study
requires it: joints have weight, inner faces have strength, and dry faces have none.
"""

from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field

from sidmacib.joint.joint import DRY, INNER, Joint, OwnLock, Side
from sidmacib.joint.parameters import SIZES
from sidmacib.mechanics.assembly import FaceMaterial
from sidmacib.quantities import Length, Modulus, Number, Poisson
from sidmacib.reading import Section, Some, changes_to, section_of
from workflow.schema.values import Eccentricities, Lengths, Name

MOST_LOCKS = 101
STIFFNESSES = ("normal_stiffness", "shear_stiffness")
STRENGTHS = ("cohesion", "tensile_strength")

_Weight = Annotated[float, Number(above=0, unit="kg/m3")]
_Cohesion = Annotated[float, Number(above=0, unit="Pa")]
_NoStrength = Annotated[float, Number(at_least=0, at_most=0, unit="Pa")]
_Locks = Annotated[int, Number(at_least=1, at_most=MOST_LOCKS, whole=True)]

_SIZES: Any = section_of(Joint, *SIZES)
_INNER: Any = section_of(INNER, cohesion=_Cohesion)
_DRY: Any = section_of(
    DRY, *STIFFNESSES, "friction", *STRENGTHS, **dict.fromkeys(STRENGTHS, _NoStrength)
)


class GeometrySection(_SIZES):
    """Length, width and height of a lock, and height of the upper main body, in m."""


class InnerFaceSection(_INNER):
    """Cohesive faces inside a block, see `sidmacib.mechanics.assembly.FaceMaterial`."""


class DryFaceSection(_DRY):
    """Frictional faces between the blocks; they have no strength."""


_OWN_SIZES: Any = changes_to(GeometrySection)
_INNER_CHANGES: Any = changes_to(InnerFaceSection)
_DRY_CHANGES: Any = changes_to(DryFaceSection)


class InnerChanges(_INNER_CHANGES):
    """Changes to inner faces; None means no change."""


class DryChanges(_DRY_CHANGES):
    """Changes to dry faces; None means no change."""


def changed(face: FaceMaterial, changes: InnerChanges | DryChanges) -> FaceMaterial:
    """``face`` with ``changes``."""
    return replace(face, **changes.model_dump(exclude_none=True))


class MaterialsSection(Section):
    """Density (kg/m3), Young's modulus (Pa) and Poisson's ratio of the block, and its faces."""

    density: _Weight = Joint.density
    young: Modulus = 1e10
    poisson: Poisson = 0.2
    inner: InnerFaceSection = InnerFaceSection()
    dry: DryFaceSection = DryFaceSection()

    @property
    def inner_face(self) -> FaceMaterial:
        """The inner faces as the models take them."""
        return FaceMaterial(**self.inner.model_dump())

    @property
    def dry_face(self) -> FaceMaterial:
        """The dry faces as the models take them."""
        return FaceMaterial(**self.dry.model_dump())


class LockSection(Section):
    """A lock that differs: width (m), density (kg/m3), inner face; None: as the others."""

    width: Length | None = None
    density: _Weight | None = None
    inner: InnerChanges = InnerChanges()

    def own_lock(self, inner: FaceMaterial) -> OwnLock:
        """The section as the models take it, where other locks have this ``inner`` face."""
        face = changed(inner, self.inner)
        return OwnLock(self.width, self.density, None if face == inner else face)


class PartSection(Section):
    """The parts of a sample that a model runs; None: all. The reference variant always runs."""

    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None
    variants: tuple[Name, ...] | None = None


class SampleSection(_OWN_SIZES):
    """A joint of the study: sizes (m) and faces where they are not the study's.

    ``first``: the block that lock 1 belongs to. ``different``: locks that differ, by number.
    ``models``: those of the study's models and engines that run on it; None: all of them. ``only``:
    what each of them runs of it, by name; a model that is not named runs all.
    """

    locks: _Locks
    first: Side = Side.UPPER
    different: dict[_Locks, LockSection] = Field(default_factory=dict)
    inner: InnerChanges = InnerChanges()
    dry: DryChanges = DryChanges()
    models: Annotated[tuple[str, ...], Some] | None = None
    only: dict[str, PartSection] = Field(default_factory=dict)

    def joint(self, geometry: GeometrySection, materials: MaterialsSection, **others: Any) -> Joint:
        """The joint; sizes and faces that it does not set are those of the study."""
        sizes = {key: getattr(self, key) or size for key, size in geometry.model_dump().items()}
        inner = changed(materials.inner_face, self.inner)
        return Joint(
            self.locks,
            **sizes,
            first=self.first,
            different={lock: changes.own_lock(inner) for lock, changes in self.different.items()},
            inner=inner,
            dry=changed(materials.dry_face, self.dry),
            density=materials.density,
            **others,
        )
