"""Sizes of the joints."""

from typing import Annotated, Any

from pydantic import BeforeValidator

from sidmacib.joint import Joint
from workflow.schema.materials import DryFaceSection, InnerFaceSection
from workflow.schema.section import changes_to, section_of
from workflow.schema.values import Length, Number, Some

_SIZES: Any = section_of(Joint(locks=3), a=Length, b=Length, h=Length, H=Length)


class GeometrySection(_SIZES):
    """Length, width and height of a lock, and height of the upper main body, in m."""


_OWN_SIZES: Any = changes_to(GeometrySection)
_INNER: Any = changes_to(InnerFaceSection)
_DRY: Any = changes_to(DryFaceSection)


class InnerChanges(_INNER):
    """Changes to the study's inner faces; None means no change."""


class DryChanges(_DRY):
    """Changes to the study's dry faces; None means no change."""


class SampleSection(_OWN_SIZES):
    """A joint of the study: sizes (m) and faces where they are not the study's.

    ``models``: those of the study's models and engines that run on it; None: all of them.
    """

    locks: Annotated[int, BeforeValidator(Number(at_least=2, at_most=101, whole=True))]
    inner: InnerChanges = InnerChanges()
    dry: DryChanges = DryChanges()
    models: Annotated[tuple[str, ...], Some] | None = None
