"""The numbers of a structure's description that have sliders on the page of a file."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from sidmacib.quantities import is_number, number_in

PARTS = ("interfaces", "special", "locks", "load", "load_cases", "permanent", "blocks")
# Of files, names and places, not of structures.
LEFT_OUT = ("scale", "fixed_below", "within", "positions", "file", "mesh", "material", "block")
MOST = 24  # of sliders
WITH_UNIT = re.compile(r"([-+.\de]*\d\.?)\s*([^\W\d].*)")
STEPS = 50  # from nothing to what the file has, rounded to one digit


class Number(NamedTuple):
    """A number of a description, and where it stands: ``holder[key]``.

    ``name``: its keys, those of lists counted from 1. ``unit``: what follows it in the file, or
    nothing for a plain number in SI units.
    """

    name: str
    value: float
    unit: str
    holder: Any
    key: str

    @property
    def slider(self) -> tuple[float, float, float]:
        """Least, most and step: to twice its value; of locks, whole numbers from 1."""
        if self.key == "count":
            return 1.0, max(10.0, 2.0 * self.value), 1.0
        step = float(f"{abs(self.value) / STEPS:.1g}")
        return min(2.0 * self.value, 0.0), max(2.0 * self.value, 0.0), step

    def put(self, value: float) -> None:
        """Write ``value`` in its place, with the same unit."""
        plain: Any = int(value) if self.key == "count" and value.is_integer() else value
        self.holder[self.key] = f"{value!r}{self.unit}" if self.unit else plain


def numbers_of(description: Any) -> list[Number]:
    """The first `MOST` numbers of a ``description``, plain values as in a file; none of lists."""
    parts = description if isinstance(description, Mapping) else {}
    found = (each for part in PARTS for each in _numbers(parts.get(part), part))
    return [each for each, _ in zip(found, range(MOST), strict=False)]


def _numbers(value: Any, name: str) -> Iterator[Number]:
    if isinstance(value, Mapping):
        for key, each in value.items():
            if key in LEFT_OUT:
                continue
            if is_number(each):
                yield Number(f"{name}.{key}", float(each), "", value, key)
            elif isinstance(each, str) and (match := WITH_UNIT.fullmatch(each)):
                if (number := number_in(match[1])) is not None:
                    yield Number(f"{name}.{key}", float(number), match[2], value, key)
            else:
                yield from _numbers(each, f"{name}.{key}")
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for number, each in enumerate(value, 1):
            yield from _numbers(each, f"{name}.{number}")


def put_numbers(description: Any, values: Mapping[str, float]) -> list[str]:
    """Write ``values`` by name into a ``description``: what that changes, in words."""
    told = []
    for each in numbers_of(description):
        value = values.get(each.name, each.value)
        if value != each.value:
            each.put(value)
            told.append(
                f"{each.name} {each.value:g} \N{RIGHTWARDS ARROW} {value:g} {each.unit}".strip()
            )
    return told
