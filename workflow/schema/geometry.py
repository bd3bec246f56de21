"""Sizes of the joints."""

from typing import Annotated, Any

from pydantic import BeforeValidator

from sidmacib.joint import Joint
from workflow.schema.section import changes_to, section_of
from workflow.schema.values import Length, Number

_SIZES: Any = section_of(Joint(locks=3), a=Length, b=Length, h=Length, H=Length)


class GeometrySection(_SIZES):
    """Length, width and height of a lock, and height of the upper main body, in m."""


_OWN_SIZES: Any = changes_to(GeometrySection)


class SampleSection(_OWN_SIZES):
    """A joint of the study; sizes in m, those of the study's geometry where None."""

    locks: Annotated[int, BeforeValidator(Number(at_least=2, at_most=101, whole=True))]
