"""Values of the configuration that no joint has, with range and message; the base of sections.

A bad value raises a ValueError whose text follows the key's name: "-1 is not allowed; it must
be ...".
"""

import math
import os
import re
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainSerializer, create_model

from sidmacib.fields import kinds_of
from sidmacib.quantities import Length, Number, shown

NAME_LENGTH = 64  # a folder's name, at most 255 letters, is made of two names and more
PATH_LENGTH, PART_LENGTH = 1000, 200


def shown_key(key: Any) -> str:
    """A key as shown in a message: unchanged if it is a short word."""
    plain = isinstance(key, int) or (isinstance(key, str) and re.fullmatch(r"[\w.+-]{1,80}", key))
    return str(key) if plain else shown(key)


Positive = Annotated[float, Number(above=0)]


def switch(value: Any) -> bool:
    """``value`` if it is true or false; ValueError if it is neither."""
    if not isinstance(value, bool):
        raise ValueError(f"{shown(value)} is not allowed; it must be true or false")
    return value


Switch = Annotated[bool, BeforeValidator(switch)]


def eccentricity(value: Any) -> float:
    """The ratio e / a as a number; "torsion" is infinity."""
    if isinstance(value, str | float) and value in ("torsion", math.inf):
        return math.inf
    try:
        return Number(at_least=0).read(value)
    except ValueError:
        raise ValueError(
            f"{shown(value)} is not allowed; it must be a number of at least 0 (e / a), or torsion"
        ) from None


def _spelled(value: float) -> float | str:
    return "torsion" if math.isinf(value) else value


Eccentricity = Annotated[
    float, BeforeValidator(eccentricity), PlainSerializer(_spelled, when_used="json")
]


def name(value: Any) -> str:
    """A name, which becomes part of the names of files and columns."""
    if not isinstance(value, str) or not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.]*", value):
        raise ValueError(
            f"{shown(value)} is not allowed as a name; it must be made of letters, digits, _ and "
            "., and begin with a letter or digit"
        )
    if len(value) > NAME_LENGTH:
        raise ValueError(
            f"{shown(value)} is too long; a name must have at most {NAME_LENGTH} letters"
        )
    return value


Name = Annotated[str, BeforeValidator(name)]


def folder(value: Any) -> str:
    """A folder's name in its shortest form; numbers are names too."""
    text = str(value) if isinstance(value, int | float) and not isinstance(value, bool) else value
    if not isinstance(text, str) or not text.strip():
        raise ValueError(f"{shown(value)} is not allowed; it must be the name of a folder")
    path = os.path.normpath(text)
    if not re.fullmatch(r"[\w/. ,+=@%-]+", path) or path[0] in "- " or path[-1] == " ":
        raise ValueError(
            f"{shown(text)} is not allowed; a folder's name must be made of letters, digits, "
            "spaces and _ . , + - = @ %, and not begin with - or a space or end with one"
        )
    parts = path.split("/")
    if parts[-1] in ("", ".", ".."):
        raise ValueError(f"{shown(text)} is not allowed; it must name a folder, not /, . or ..")
    if max(len(p.encode()) for p in parts) > PART_LENGTH or len(path.encode()) > PATH_LENGTH:
        raise ValueError(
            f"{shown(text)} is too long; each part must have at most {PART_LENGTH} bytes, "
            f"the whole at most {PATH_LENGTH}"
        )
    return path


Folder = Annotated[str, BeforeValidator(folder)]


def some(value: Any) -> Any:
    """A list with at least one item."""
    if not isinstance(value, list | tuple) or not value:
        raise ValueError(f"{shown(value)} is not allowed; it must be a list of at least one value")
    return value


def several(value: Any) -> Any:
    """A list, perhaps empty."""
    if not isinstance(value, list | tuple):
        raise ValueError(f"{shown(value)} is not allowed; it must be a list")
    return value


def entries(value: Any) -> Any:
    """A mapping of at least one name."""
    if not isinstance(value, Mapping) or not value:
        raise ValueError(
            f"{shown(value)} is not allowed; it must be a mapping of at least one name"
        )
    return value


Some = BeforeValidator(some)
Several = BeforeValidator(several)
Entries = BeforeValidator(entries)
Lengths = Annotated[tuple[Length, ...], Some]
Eccentricities = Annotated[tuple[Eccentricity, ...], Some]


class Section(BaseModel):
    """A part of the configuration, without unknown keys; it does not change after reading."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings")


def section_of(source: Any, *keys: str, **kinds: Any) -> Any:
    """A section of some fields of the dataclass ``source``, or all, with its defaults.

    ``source`` may be an instance, whose values are the defaults then. ``kinds``: annotations that
    are narrower than those of the dataclass. Where it has a ``bool``, the section takes nothing
    but true and false.
    """
    dataclass: Any = source if isinstance(source, type) else type(source)
    fields_of = {key: Switch if kind is bool else kind for key, kind in kinds_of(dataclass).items()}
    annotations = {**fields_of, **kinds}
    chosen: dict[str, Any] = {
        key: (annotations[key], getattr(source, key, ...)) for key in keys or annotations
    }
    return create_model(f"{dataclass.__name__}Keys", __base__=Section, **chosen)


def changes_to(section: type[Section]) -> Any:
    """``section`` with every key optional: None means no change."""
    keys: dict[str, Any] = {
        key: (field.rebuild_annotation() | None, None)
        for key, field in section.model_fields.items()
    }
    return create_model(f"{section.__name__}Changes", __base__=Section, **keys)
