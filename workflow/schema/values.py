"""Kinds of values in the configuration, each with its range, its unit and its message.

A fault raises a ValueError whose text comes after the key's name: "-1 is not allowed; it must
be ...".
"""

import math
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer

from sidmacib.yaml_text import number_in

MAX_SHOWN = 60  # letters of a value that a message shows
NAME_LENGTH = 64  # a folder's name, at most 255 letters, is made of two names and more
PATH_LENGTH, PART_LENGTH = 1000, 200


def shown(value: Any) -> str:
    """``value`` as shown in a message: short, printable and in one line, whatever it is."""
    if value is None or isinstance(value, bool):
        found = {None: "null", True: "true", False: "false"}[value]
    elif isinstance(value, str):
        cut = f"{value[:MAX_SHOWN]}..." if len(value) > MAX_SHOWN else value
        found = repr(cut)[: 2 * MAX_SHOWN]  # unprintable letters are written out
    elif isinstance(value, Mapping):
        found = "a mapping" if value else "an empty mapping"
    elif isinstance(value, list | tuple):
        found = "a list" if value else "an empty list"
    elif isinstance(value, Integral):
        found = str(int(value)) if abs(int(value)) < 10**30 else "a number of more than 30 digits"
    elif isinstance(value, float):
        found = repr(float(value))
    else:
        found = f"a value of the kind {type(value).__name__[:MAX_SHOWN]}"
    return found


def shown_key(key: Any) -> str:
    """A key as shown in a message: unchanged if it is a short word."""
    plain = isinstance(key, int) or (isinstance(key, str) and re.fullmatch(r"[\w.+-]{1,80}", key))
    return str(key) if plain else shown(key)


@dataclass(frozen=True)
class Number:
    """Accepts numbers within a range; ``unit`` is for messages.

    Text that spells a decimal number counts as the number: some YAML readers take 6e-2 for text,
    and every value on a command line is text. true and false are not numbers.
    """

    above: float = -math.inf
    at_least: float = -math.inf
    at_most: float = math.inf
    below: float = math.inf
    unit: str = ""
    whole: bool = False

    def __call__(self, value: Any) -> float:
        """``value`` as a number; ValueError if it is not one, or is out of range."""
        number = number_in(value) if isinstance(value, str) else value
        if isinstance(number, bool) or not isinstance(number, Real):
            raise ValueError(f"{shown(value)} is not a number; it must be {self.range(kind=True)}")
        try:
            found = float(number)
        except OverflowError:
            found = math.nan
        fits = self.above < found < self.below and self.at_least <= found <= self.at_most
        if not math.isfinite(found) or not fits or (self.whole and not found.is_integer()):
            raise ValueError(f"{shown(value)} is not allowed; it must be {self.range(self.whole)}")
        return int(found) if self.whole else found + 0.0  # no negative zero

    def range(self, kind: bool = False) -> str:
        """The range in words."""
        bounds = [
            (self.above, "greater than {:g}"),
            (self.at_least, "at least {:g}"),
            (self.at_most, "at most {:g}"),
            (self.below, "less than {:g}"),
        ]
        words = " and ".join(text.format(x) for x, text in bounds if math.isfinite(x))
        if self.at_least == self.at_most:
            words = f"{self.at_least:g}"
        elif math.isfinite(self.at_least) and math.isfinite(self.at_most):
            words = f"from {self.at_least:g} to {self.at_most:g}"
        what = f"{'a whole number' if self.whole else 'a number'} " if kind else ""
        return f"{what}{words}{f' ({self.unit})' if self.unit else ''}"


Length = Annotated[float, BeforeValidator(Number(above=0, unit="m"))]
Density = Annotated[float, BeforeValidator(Number(above=0, unit="kg/m3"))]
Stiffness = Annotated[float, BeforeValidator(Number(above=0, unit="Pa/m"))]
Modulus = Annotated[float, BeforeValidator(Number(above=0, unit="Pa"))]
Poisson = Annotated[float, BeforeValidator(Number(at_least=0, below=0.5))]
Strength = Annotated[float, BeforeValidator(Number(above=0, unit="Pa"))]
StrengthOrNone = Annotated[float, BeforeValidator(Number(at_least=0, unit="Pa"))]
Residual = Annotated[float, BeforeValidator(Number(at_least=0, at_most=1))]
FractureEnergy = Annotated[float, BeforeValidator(Number(at_least=0, unit="J/m2"))]
NoStrength = Annotated[float, BeforeValidator(Number(at_least=0, at_most=0, unit="Pa"))]
Force = Annotated[float, BeforeValidator(Number(at_least=0, unit="N"))]
Friction = Annotated[float, BeforeValidator(Number(at_least=0))]
Positive = Annotated[float, BeforeValidator(Number(above=0))]
Share = Annotated[float, BeforeValidator(Number(above=0, below=1))]


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
        return Number(at_least=0)(value)
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
            f"{shown(value)} is too long; a name must have {NAME_LENGTH} letters or fewer"
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
        raise ValueError(f"{shown(text)} is not allowed; it must be a folder of its own")
    if max(len(p.encode()) for p in parts) > PART_LENGTH or len(path.encode()) > PATH_LENGTH:
        raise ValueError(
            f"{shown(text)} is too long; each part must have {PART_LENGTH} bytes or fewer, "
            f"the whole {PATH_LENGTH} or fewer"
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
