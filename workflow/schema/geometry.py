"""Sizes of the joints, and their locks."""

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from sidmacib.joint import Block, Joint, OwnLock
from workflow.schema.materials import InnerFaceChanges, InnerFaceSection, face_material
from workflow.schema.section import Section, changes_to, section_of
from workflow.schema.values import Density, Length, Number

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
    inner: InnerFaceChanges = InnerFaceChanges()

    def own_lock(self, inner: InnerFaceSection) -> OwnLock:
        """The section as the models take it, where other locks have this ``inner`` face."""
        changed = self.inner.changed(inner)
        material = None if changed == inner else face_material(changed)
        return OwnLock(self.width, self.density, material)


class SampleSection(_OWN_SIZES):
    """A joint of the study; sizes in m, those of the study's geometry where None.

    ``first``: the block that lock 1 belongs to. ``different``: locks that differ, by number.
    """

    locks: _NUMBER
    first: Block = Block.UPPER
    different: dict[_NUMBER, LockSection] = Field(default_factory=dict)

    def joint(self, geometry: GeometrySection, inner: InnerFaceSection, **others: Any) -> Joint:
        """The joint, its sizes from ``geometry`` and its inner faces ``inner`` if not its own."""
        sizes = {key: getattr(self, key) or size for key, size in geometry.model_dump().items()}
        return Joint(
            self.locks,
            **sizes,
            first=self.first,
            different={lock: own.own_lock(inner) for lock, own in self.different.items()},
            inner=face_material(inner),
            **others,
        )
