"""Sizes of the joints, and their locks."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from sidmacib.joint import Block, Joint, OwnLock
from workflow.schema.materials import (
    DryChanges,
    InnerChanges,
    InnerFaceSection,
    MaterialsSection,
    face_material,
)
from workflow.schema.section import Section, changes_to, section_of
from workflow.schema.values import (
    Density,
    Eccentricities,
    Length,
    Lengths,
    Name,
    Number,
    Several,
    Some,
)

MOST_LOCKS = 101

_SIZES: Any = section_of(Joint(locks=3), a=Length, b=Length, h=Length, H=Length)


class GeometrySection(_SIZES):
    """Length, width and height of a lock, and height of the upper main body, in m."""


_OWN_SIZES: Any = changes_to(GeometrySection)
_NUMBER = Annotated[int, BeforeValidator(Number(at_least=1, at_most=MOST_LOCKS, whole=True))]


class LockSection(Section):
    """What a lock has of its own: width (m), density (kg/m3), inner face; None: as the others."""

    width: Length | None = None
    density: Density | None = None
    inner: InnerChanges = InnerChanges()

    def own_lock(self, inner: InnerFaceSection) -> OwnLock:
        """The section as the models take it, where other locks have this ``inner`` face."""
        changed = self.inner.changed(inner)
        material = None if changed == inner else face_material(changed)
        return OwnLock(self.width, self.density, material)


class PartSection(Section):
    """What a model runs of a sample; None: all. The reference variant runs always."""

    meshes: Lengths | None = None
    eccentricities: Eccentricities | None = None
    variants: Annotated[tuple[Name, ...], Several] | None = None


class SampleSection(_OWN_SIZES):
    """A joint of the study: sizes (m) and faces where they are not the study's.

    ``first``: the block that lock 1 belongs to. ``different``: locks that differ, by number.
    ``models``: those of the study's models and engines that run on it; None: all of them. ``only``:
    what each of them runs of it, by name; a model that is not named runs all.
    """

    locks: _NUMBER
    first: Block = Block.UPPER
    different: dict[_NUMBER, LockSection] = Field(default_factory=dict)
    inner: InnerChanges = InnerChanges()
    dry: DryChanges = DryChanges()
    models: Annotated[tuple[str, ...], Some] | None = None
    only: dict[str, PartSection] = Field(default_factory=dict)

    def joint(self, geometry: GeometrySection, materials: MaterialsSection, **others: Any) -> Joint:
        """The joint; sizes and faces that are not its own are those of the study."""
        sizes = {key: getattr(self, key) or size for key, size in geometry.model_dump().items()}
        inner = self.inner.changed(materials.inner)
        return Joint(
            self.locks,
            **sizes,
            first=self.first,
            different={lock: own.own_lock(inner) for lock, own in self.different.items()},
            inner=face_material(inner),
            dry=face_material(self.dry.changed(materials.dry)),
            density=materials.density,
            **others,
        )
