"""Values under the keys of a structure's file: each error is one line that names the key."""

from collections.abc import Iterable, Mapping
from typing import Any

from sidmacib.fields import kinds_of, number_of
from sidmacib.mechanics.assembly import FaceMaterial, Vector
from sidmacib.quantities import FORMULA, Number, shown
from sidmacib.validation import LARGE

MATERIAL = {  # of interfaces, where a file leaves a number out
    "normal_stiffness": 1e10,
    "shear_stiffness": 1e10,
    "friction": 0.7,
    "cohesion": 0.0,
    "tensile_strength": 0.0,
    "bond_friction": 0.0,
}
FINITE, POSITIVE = Number(), Number(above=0)
COMPONENT = Number(at_least=-LARGE, at_most=LARGE)


def read_material(key: str, value: Any, defaults: Mapping[str, float]) -> FaceMaterial:
    """The material that ``value`` gives, with ``defaults`` for what it leaves out; ValueError."""
    given = mapping(key, value, (), defaults)
    kinds = kinds_of(FaceMaterial)
    numbers = {
        name: read_number(f"{key}.{name}", each, number_of(kinds[name]) or FINITE)
        for name, each in given.items()
    }
    return FaceMaterial(**{**defaults, **numbers})


def vectors(key: str, value: Any) -> tuple[Vector, ...]:
    """A list of `vector`."""
    return tuple(vector(f"{key}[{k}]", each) for k, each in enumerate(listed(key, value)))


def vector(key: str, value: Any) -> Vector:
    """A list of three numbers up to `LARGE`; ValueError."""
    numbers = listed(key, value)
    if len(numbers) != 3:
        raise ValueError(f"{key}: must be a list of three numbers")
    x, y, z = (read_number(key, each, COMPONENT) for each in numbers)
    return x, y, z


def read_number(key: str, value: Any, allowed: Number) -> float:
    """A number in a range; ValueError."""
    try:
        return allowed.read(value)
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from None


def listed(key: str, value: Any) -> list[Any]:
    """A list; ValueError."""
    if not isinstance(value, list):
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a list")
    return value


def named(key: str, value: Any) -> dict[str, Any]:
    """A mapping by printable names that are no formulas, not empty; ValueError."""
    if not isinstance(value, dict) or not value:
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a mapping by name")
    for name in value:
        if not str(name).strip() or not str(name).isprintable():
            raise ValueError(f"{key}: {shown(name)} is not allowed; names must be printable")
        if str(name).strip().startswith(FORMULA):  # they stand in tables
            raise ValueError(
                f"{key}: {shown(name)} is not allowed; names must not begin with "
                f"{' '.join(FORMULA)}, as a spreadsheet would take them for formulas"
            )
    return {str(name): each for name, each in value.items()}


def mapping(
    key: str, value: Any, needed: Iterable[str], allowed: Iterable[str] = ()
) -> dict[str, Any]:
    """``value`` if it is a mapping with all ``needed`` keys and, beside these, ``allowed`` ones."""
    if not isinstance(value, dict):
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a mapping")
    needed, every = list(needed), [*needed, *allowed]
    for name in value:
        if name not in every:
            raise ValueError(f"{key}: unknown key {shown(name)}; valid keys: {', '.join(every)}")
    for name in needed:
        if name not in value:
            raise ValueError(f"{key}: lacks the key {name}")
    return dict(value)
