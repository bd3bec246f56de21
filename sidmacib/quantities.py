"""Numbers with a range and a unit, which annotate the fields of a joint.

Everything that reads a joint takes ranges, units and messages from these annotations: the library's
dataclasses, the command, its files, and the configuration of a study. A number may have its unit
behind it, such as 80mm, 5kN, 0.3MPa or 15deg; a number alone is in SI units.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from enum import StrEnum
from numbers import Integral, Real
from typing import Annotated, Any, TypeVar

_FACTOR = r"[A-Za-z°]+\^?[23²³]?"
_SPELLED = re.compile(rf"([-+.0-9]+(?:[eE][-+]?[0-9]+)?) *({_FACTOR}(?: ?[*·/ ] ?{_FACTOR})*)")
_PLAIN = str.maketrans({"²": "2", "³": "3", "°": "deg", **dict.fromkeys("*·^ ")})
Choice = TypeVar("Choice", bound=StrEnum)

FORMULA = ("=", "+", "-", "@")  # what formulas of a spreadsheet begin with
MOST_COMPARED = 200  # letters of a name that is compared with those allowed
MAX_SHOWN = 60  # letters of a value that a message shows
DIGITS = 10  # significant digits that are kept
LARGEST = 1e9  # number told without an exponent
_DECIMAL = re.compile(r"[-+]?(\.[0-9]+|(0|[1-9][0-9]*)(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WHOLE = re.compile(r"[-+]?(0|[1-9][0-9]{0,30})")


@dataclass(frozen=True)
class Quantity:
    """What units measure: its name, the unit of plain numbers, an example, and units in these."""

    name: str
    unit: str
    example: str
    units: dict[str, float]


_MPA, _KPA = 1e6, 1e3
# A table, and not pint: that takes 0.5 s of CPU to load, reads 12 Nm as m/kg and 1,5 m as 15 m, and
# knows no N/mm2.
QUANTITIES = (
    Quantity(
        "a length",
        "m",
        "80mm",
        {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "in": 0.0254, "ft": 0.3048},
    ),
    Quantity("a force", "N", "5kN", {"N": 1.0, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605}),
    Quantity(
        "a torque",
        "N m",
        "5kNm",
        {"Nm": 1.0, "kNm": 1e3, "MNm": 1e6, "Nmm": 1e-3, "kNmm": 1.0},
    ),
    Quantity(
        "a pressure",
        "Pa",
        "0.3MPa",
        {
            **{"Pa": 1.0, "kPa": _KPA, "MPa": _MPA, "GPa": 1e9, "bar": 1e5},
            **{"N/mm2": _MPA, "N/m2": 1.0, "kN/m2": _KPA, "MN/m2": _MPA, "psi": 6894.757293168361},
        },
    ),
    Quantity("a density", "kg/m3", "2000kg/m3", {"kg/m3": 1.0, "t/m3": 1e3, "g/cm3": 1e3}),
    Quantity(
        "a force by volume",
        "Pa/m",
        "10GPa/m",
        {
            **{"Pa/m": 1.0, "kPa/m": _KPA, "MPa/m": _MPA, "GPa/m": 1e9, "MPa/mm": 1e9},
            **{"N/m3": 1.0, "kN/m3": 1e3, "MN/m3": 1e6, "N/mm3": 1e9},
        },
    ),
    Quantity(
        "an energy by area",
        "J/m2",
        "100J/m2",
        {"J/m2": 1.0, "kJ/m2": 1e3, "N/m": 1.0, "kN/m": 1e3, "N/mm": 1e3},
    ),
    Quantity(
        "an angle", "degrees", "15deg", {"deg": 1.0, "degrees": 1.0, "rad": math.degrees(1.0)}
    ),
    Quantity("a time", "s", "90s", {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}),
    Quantity("a speed", "m/s", "0.2m/s", {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}),
    Quantity("an acceleration", "m/s2", "0.3g", {"m/s2": 1.0, "cm/s2": 1e-2, "g": 9.81}),
)
MEASURED_IN = {quantity.unit: quantity for quantity in QUANTITIES}
_OF = {unit: quantity for quantity in QUANTITIES for unit in quantity.units}


def _size_of(text: str, spelled: str, unit: str) -> float:
    """How many of ``unit``, in which plain numbers are, the unit ``spelled`` in ``text`` is.

    ``unit`` is empty for numbers that have none. ValueError that says what is allowed.
    """
    wanted = MEASURED_IN.get(unit)
    if wanted and spelled in wanted.units:
        return wanted.units[spelled]
    allowed = f"{wanted.name}, such as {wanted.example}" if wanted else "a number without a unit"
    if (of := _OF.get(spelled)) is not None:
        friction = " (friction is the tangent of its angle)"
        hint = friction if wanted is None and of.unit == "degrees" else ""
        raise ValueError(f"{text} is {of.name}; it must be {allowed}{hint}")
    units = f" ({', '.join(wanted.units)})" if wanted else ""
    raise ValueError(f"{text} is in an unknown unit, {spelled}; it must be {allowed}{units}")


def quantity_of(spelled: str) -> Quantity:
    """What the unit ``spelled`` measures; ValueError if it is none."""
    plain = plain_unit(spelled)
    if plain not in _OF:
        raise ValueError(f"{spelled!r} is not a unit; it must be one of {', '.join(_OF)}")
    return _OF[plain]


def plain_unit(spelled: str) -> str:
    """A unit as it stands in `QUANTITIES`: kNm for kN m, m2 for m²."""
    return spelled.strip().translate(_PLAIN)


def is_number(value: Any) -> bool:
    """Whether ``value`` is a real number, a boolean not being one."""
    if type(value) is float:  # at once, as almost all are
        return True
    return isinstance(value, Real) and not isinstance(value, bool)


def number_in(text: str) -> int | float | None:
    """The decimal number that ``text`` spells; None if it spells none, or one too large."""
    if _WHOLE.fullmatch(text):
        return int(text)
    number = float(text) if _DECIMAL.fullmatch(text) else math.inf
    return number if math.isfinite(number) else None


def shown(value: Any) -> str:
    """``value`` as shown in a message: short, printable and in one line, whatever it is."""
    if value is None or isinstance(value, bool):
        words = {None: "null", True: "true", False: "false"}[value]
    elif isinstance(value, str):
        cut = f"{value[:MAX_SHOWN]}..." if len(value) > MAX_SHOWN else value
        words = repr(cut)[: 2 * MAX_SHOWN]  # unprintable letters are written out
    elif isinstance(value, Mapping):
        words = "a mapping" if value else "an empty mapping"
    elif isinstance(value, list | tuple):
        words = "a list" if value else "an empty list"
    elif isinstance(value, Integral):
        words = str(int(value)) if abs(int(value)) < 10**30 else "a number of more than 30 digits"
    elif is_number(value):
        words = repr(float(value))
    else:
        words = f"a value of the kind {type(value).__name__[:MAX_SHOWN]}"
    return words


class Read:
    """Annotates a field that pydantic reads by `read` and describes by `schema`.

    Plain data: pydantic, which takes long to import, is not needed here.
    """

    read: Any  # a function of the value
    schema: Any

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> dict[str, Any]:
        function = {"type": "no-info", "function": self.read}
        found = {"type": "function-before", "function": function, "schema": handler(source)}
        if write := getattr(self, "write", None):
            found["serialization"] = {
                "type": "function-plain",
                "function": write,
                "when_used": "json",
            }
        return found

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        return dict(self.schema)


@dataclass(frozen=True, eq=False)
class ReadBy(Read):
    """A field that a function reads, and perhaps another writes as JSON."""

    read: Callable[[Any], Any]
    schema: Mapping[str, Any]
    write: Callable[[Any], Any] | None = None


def one_of(names: Iterable[str]) -> ReadBy:
    """An annotation of text that must be one of ``names``."""

    def read(value: Any) -> Any:
        if value not in [*names]:
            raise ValueError(f"{shown(value)} is not allowed; it must be one of {', '.join(names)}")
        return value

    return ReadBy(read, {"enum": [*names]})


@dataclass(frozen=True)
class Number(Read):
    """A range of finite numbers; true and false are not numbers.

    ``unit`` is for messages. Outside ``likely`` a number seems to be in another unit.
    """

    above: float = -math.inf
    at_least: float = -math.inf
    at_most: float = math.inf
    below: float = math.inf
    unit: str = ""
    whole: bool = False
    likely: tuple[float, float] = (0.0, math.inf)

    def read(self, value: Any) -> float:
        """``value``, from a file or a command line, as a number; ValueError if it is not allowed.

        Text that spells a decimal number counts as the number: some YAML readers take 6e-2 for
        text, and every value on a command line is text. So does a number with a unit, as in 80mm.
        """
        number: Any = self._spelled(value) if isinstance(value, str) else value
        if not is_number(number):
            raise ValueError(f"{shown(value)} is not a number; it must be {self.range(kind=True)}")
        if not self._holds(number):
            raise ValueError(f"{shown(value)} is not allowed; it must be {self.range(self.whole)}")
        return int(number) if self.whole else float(number) + 0.0  # no negative zero

    def _spelled(self, text: str) -> float | None:
        """The number in ``text``, in `unit`; ValueError for a unit of something else."""
        if text.endswith("%") and not self.unit and not self.whole:
            share = number_in(text[:-1].strip())
            return None if share is None else float(f"{share / 100.0:.15g}")
        number, found = number_in(text), _SPELLED.fullmatch(text.strip())
        if number is not None or found is None or (number := number_in(found[1])) is None:
            return number
        size = _size_of(found[0], plain_unit(found[2]), self.unit)
        return float(f"{number * size:.15g}")  # 70 mm are 0.07 m

    def require(self, name: str, value: Any) -> None:
        """ValueError, which begins with ``name``, unless ``value`` is such a number in Python."""
        number = is_number(value)
        if not number or not self._holds(value) or (self.whole and not isinstance(value, Integral)):
            what = "not allowed" if number else "not a number"
            allowed = self.range(kind=self.whole or not number)
            raise ValueError(f"{name}: {shown(value)} is {what}; it must be {allowed}")

    def _holds(self, number: Any) -> bool:
        """Whether a number is in the range; infinity and nan never are."""
        try:
            value = float(number)
        except OverflowError:
            return False
        inside = self.above < value < self.below and self.at_least <= value <= self.at_most
        return inside and (not self.whole or value.is_integer())

    @property
    def _bounds(self) -> list[tuple[str, str, float]]:
        """Each bound that there is: the key of JSON schema for it, words, and where it is."""
        every = [
            ("exclusiveMinimum", "greater than", self.above),
            ("minimum", "at least", self.at_least),
            ("maximum", "at most", self.at_most),
            ("exclusiveMaximum", "less than", self.below),
        ]
        return [bound for bound in every if math.isfinite(bound[2])]

    def range(self, kind: bool = False) -> str:
        """The range in words; ``kind``: and that it is one of numbers."""
        words = " and ".join(f"{text} {x:g}" for _, text, x in self._bounds)
        if not words:
            return f"a finite number{f' ({self.unit})' if self.unit else ''}"
        if self.at_least == self.at_most:
            words = f"{self.at_least:g}"
        elif math.isfinite(self.at_least) and math.isfinite(self.at_most):
            words = f"from {self.at_least:g} to {self.at_most:g}"
        if kind:
            of = "of " if words.startswith("at ") else ""
            words = f"{'a whole number' if self.whole else 'a number'} {of}{words}"
        return f"{words}{f' ({self.unit})' if self.unit else ''}"

    @property
    def schema(self) -> dict[str, Any]:
        """The range as JSON schema, and in words for people."""
        kind: Any = "integer" if self.whole else "number"
        return {
            "type": [kind, "string"] if self.unit in MEASURED_IN else kind,  # with a unit
            **{key: x for key, _, x in self._bounds},
            "allowed": self.range(kind=True),
        }


@dataclass(frozen=True)
class Span(Read):
    """The least and the largest value that a ``number`` may have."""

    number: Number

    def read(self, value: Any) -> tuple[float, float]:
        """Both, from a list in a file; ValueError if it is not allowed."""
        if not isinstance(value, list | tuple) or len(value) != 2:
            raise ValueError(
                f"{shown(value)} is not allowed; it must be a list of the least and the largest "
                "value"
            )
        least, largest = map(self.number.read, value)
        if least > largest:
            raise ValueError(
                f"[{least:g}, {largest:g}] is not allowed; the first value must not exceed "
                "the second"
            )
        return least, largest

    @property
    def schema(self) -> dict[str, Any]:
        """Two such numbers, as JSON schema and in words."""
        words = f"the least and the largest, each {self.number.range(kind=True)}"
        items = {"type": "array", "items": self.number.schema, "minItems": 2, "maxItems": 2}
        return {**items, "allowed": words}


def choice(kind: type[Choice], value: Any) -> Choice:
    """The member of ``kind`` that ``value`` names; ValueError if it names none."""
    try:
        return kind(value)
    except ValueError:
        *names, last = kind
        allowed = f"{', '.join(names)} or {last}"
        raise ValueError(f"{shown(value)} is not allowed; it must be {allowed}") from None


# Far beyond any lock of stone, concrete or timber, and any printed model; friction is 0.5 to 1.
Count = Annotated[int, Number(at_least=1, whole=True)]
Length = Annotated[float, Number(above=0, unit="m", likely=(1e-3, 10.0))]
Newtons = Annotated[float, Number(above=0, unit="N")]
Density = Annotated[float, Number(at_least=0, unit="kg/m3", likely=(10.0, 3e4))]
Stiffness = Annotated[float, Number(above=0, unit="Pa/m", likely=(1e6, 1e15))]
Modulus = Annotated[float, Number(above=0, unit="Pa", likely=(1e6, 1e13))]
Poisson = Annotated[float, Number(at_least=0, below=0.5)]
Strength = Annotated[float, Number(at_least=0, unit="Pa", likely=(100.0, 1e9))]
FractureEnergy = Annotated[float, Number(at_least=0, unit="J/m2")]
Friction = Annotated[float, Number(at_least=0, likely=(0.0, 1.2))]
Part = Annotated[float, Number(at_least=0, at_most=1)]
Share = Annotated[float, Number(above=0, below=1)]  # neither nothing nor all


def rounded(value: float) -> float:
    """``value`` to `DIGITS` significant digits; never -0."""
    return float(f"{value:.{DIGITS}g}") + 0.0


def clean(value: float, noise: float) -> float:
    """``value`` in multiples of ``noise``: the same on every machine."""
    return rounded(round(value / noise) * noise)


def four_digits(value: float) -> str:
    """``value`` in four digits, without an exponent up to `LARGEST`."""
    return digits(value, 4)


def digits(value: float, count: int) -> str:
    """``value`` in so many digits, or all before the decimal point up to `LARGEST`."""
    whole = 10**count - 0.5 <= abs(value) < LARGEST
    return f"{value:.0f}" if whole else f"{value:.{count}g}"


def some_of(names: Sequence[str], most: int) -> str:
    """The first ``names`` in words, and how many others there are."""
    others = f" and {len(names) - most} others" if len(names) > most else ""
    return f"{', '.join(names[:most])}{others}"


def meant(name: str, names: Iterable[str]) -> str:
    """The one of ``names`` that looks like ``name``, as a question; no words if none does."""
    near = get_close_matches(name[:MOST_COMPARED], list(names), 1)
    return f"did you mean {near[0]}? " if near else ""


def number_of(count: int, name: str) -> str:
    """``count`` things of a ``name`` in words."""
    return f"{count:,} {name}" + ("" if count == 1 else "s")
