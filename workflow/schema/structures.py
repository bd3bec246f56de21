"""Structures of blocks that a study analyses, with or without joints."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from sidmacib.quantities import shown
from workflow.schema.values import Name, Section, Several, entries

NO_JOINTS: Mapping[str, Any] = {}  # the samples of a study that has structures only


def description(value: Any) -> Mapping[str, Any]:
    """A structure and its load, as in a file of `multilock assembly`."""
    if not isinstance(value, Mapping) or not value:
        raise ValueError(
            f"{shown(value)} is not allowed; it must be a mapping with blocks and load, as in a "
            "file of multilock assembly"
        )
    return dict(value)


def file(value: Any) -> str:
    """The name of a file, from the folder of the configuration on."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{shown(value)} is not allowed; it must be the name of a file")
    return value


def changes(value: Any) -> Mapping[str, Any]:
    """Keys of the description with other values; null leaves a key out."""
    if not isinstance(value, Mapping):
        raise ValueError(f"{shown(value)} is not allowed; it must be a mapping of keys to values")
    return dict(value)


def load(value: Any) -> Mapping[str, Any]:
    """A load, as in a file of `multilock assembly`."""
    if not isinstance(value, Mapping) or not value:
        raise ValueError(
            f"{shown(value)} is not allowed; it must be a mapping, such as "
            "{acceleration: [1, 0, 0]}"
        )
    return dict(value)


def samples(value: Any) -> Any:
    """At least one name, unless there are structures."""
    return {} if value is NO_JOINTS else entries(value)


SomeOrStructures = BeforeValidator(samples)
_Description = Annotated[dict[str, Any], BeforeValidator(description)]
_File = Annotated[str, BeforeValidator(file)]
_Changes = Annotated[dict[str, Any], BeforeValidator(changes)]
_Load = Annotated[dict[str, Any], BeforeValidator(load)]


class StructureSection(Section):
    """A structure of blocks: a ``file`` of `multilock assembly`, or its ``description`` here.

    ``file``: beside the configuration. ``models``: which of the study's models and engines analyse
    it, by default all that can. ``loads``: by name, in place of the load in the description.
    ``variants``: by name, changes to the description; they run beside the reference variant.
    """

    file: _File | None = None
    description: _Description | None = None
    models: Annotated[tuple[str, ...], Several] | None = None
    loads: dict[Name, _Load] = Field(default_factory=dict)
    variants: dict[Name, _Changes] = Field(default_factory=dict)
