"""Units behind a number, such as 80mm, 5kN, 0.3MPa or 15deg; a number alone is in SI units.

A table, and not pint: that takes 0.5 s of CPU to load, reads 12 Nm as m/kg and 1,5 m as 15 m, and
knows no N/mm2.
"""

import math
import re
from dataclasses import dataclass

_FACTOR = r"[A-Za-z°]+\^?[23²³]?"
_SPELLED = re.compile(rf"([-+.0-9]+(?:[eE][-+]?[0-9]+)?) *({_FACTOR}(?: ?[*·/ ] ?{_FACTOR})*)")
_PLAIN = str.maketrans({"²": "2", "³": "3", "°": "deg", **dict.fromkeys("*·^ ")})


@dataclass(frozen=True)
class Quantity:
    """What units measure: its name, the unit of plain numbers, an example, and units in these."""

    name: str
    unit: str
    example: str
    units: dict[str, float]


_MPA, _KPA = 1e6, 1e3
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
    Quantity("a time", "s", "90s", {"s": 1.0, "min": 60.0, "h": 3600.0}),
)
MEASURED_IN = {quantity.unit: quantity for quantity in QUANTITIES}
_OF = {unit: quantity for quantity in QUANTITIES for unit in quantity.units}


def with_unit(text: str) -> tuple[str, str] | None:
    """The number and the unit, written plainly, that ``text`` spells; None without both."""
    found = _SPELLED.fullmatch(text.strip())
    return (found[1], found[2].translate(_PLAIN)) if found else None


def size_of(text: str, spelled: str, unit: str) -> float:
    """How many of ``unit``, in which plain numbers are, the unit ``spelled`` in ``text`` is.

    ``unit`` is empty for numbers that have none. ValueError that says what is allowed.
    """
    wanted = MEASURED_IN.get(unit)
    if wanted and spelled in wanted.units:
        return wanted.units[spelled]
    allowed = f"{wanted.name}, such as {wanted.example}" if wanted else "a number without a unit"
    if spelled in _OF:
        raise ValueError(f"{text} is {_OF[spelled].name}; it must be {allowed}")
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
