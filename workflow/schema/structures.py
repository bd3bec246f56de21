"""Structures of blocks that a study analyses, with or without joints."""

from typing import Annotated, Any

from pydantic import Field, WithJsonSchema

from sidmacib.reading import Section, Some, Text
from workflow.schema.values import Name

FILE = "structure.schema.json"  # beside the schema of studies; `see` becomes a reference there
_Description = Annotated[dict[Text, Any], Some, WithJsonSchema({"see": FILE})]
_Changes = Annotated[dict[Text, Any], WithJsonSchema({"type": "object"})]
_Load = Annotated[dict[Text, Any], Some, WithJsonSchema({"see": f"{FILE}#/$defs/LoadSection"})]


class StructureSection(Section):
    """A structure of blocks: a ``file`` of `multilock assembly`, or its ``description`` here.

    ``file``: beside the configuration. ``models``: which of the study's models and engines analyse
    it, by default all that can. ``loads``: by name, in place of the load in the description.
    ``variants``: by name, changes to the description, where null leaves a key out; they run beside
    the reference variant.
    """

    file: Annotated[str, Some] | None = None
    description: _Description | None = None
    models: tuple[str, ...] | None = None
    loads: dict[Name, _Load] = Field(default_factory=dict)
    variants: dict[Name, _Changes] = Field(default_factory=dict)
