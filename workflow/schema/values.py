"""Values of the configuration that no joint has, with range and message.

A bad value raises a ValueError whose text follows the key's name: "-1 is not allowed; it must
be ...".
"""

import math
import os
import re
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PlainSerializer

from sidmacib.quantities import Length, Number, shown
from sidmacib.reading import Some

NAME_LENGTH = 64  # a folder's name, at most 255 letters, is made of two names and more
PATH_LENGTH, PART_LENGTH = 1000, 200


Positive = Annotated[float, Number(above=0)]
NotNegative = Annotated[float, Number(at_least=0)]


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


Eccentricity = Annotated[
    float,
    BeforeValidator(eccentricity, json_schema_input_type=Literal["torsion"] | NotNegative),
    PlainSerializer(lambda value: "torsion" if math.isinf(value) else value, when_used="json"),
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


Name = Annotated[
    str,
    BeforeValidator(name),
    Field(description="letters, digits, _ and ., beginning with a letter or digit"),
]


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


Folder = Annotated[str, BeforeValidator(folder), Field(description="the name of a folder")]


Lengths = Annotated[tuple[Length, ...], Some]
Eccentricities = Annotated[tuple[Eccentricity, ...], Some]
