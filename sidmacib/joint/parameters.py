"""The parameters of a joint, one row each: flags, keys of a joint's file, sensitivities, sliders.

A parameter is one field of a `Joint`, or of its faces or its elastic material, or two fields that
are set together. Ranges, units, likely values and defaults are those of the fields. Values that are
allowed but look as if they were in another unit get a warning.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import Any

from sidmacib.joint import HoldDown, Joint
from sidmacib.mechanics.assembly import SOFTENED, Elastic, FaceMaterial, Failure
from sidmacib.quantities import Number, choice
from sidmacib.validation import kinds_of, number_of

PARTS = {"": Joint, "inner": FaceMaterial, "dry": FaceMaterial, "elastic": Elastic}


@dataclass(frozen=True)
class Parameter:
    """A parameter: its description and the fields that it sets, such as ``inner.cohesion``.

    ``places``: of the fields, with {} for its name. ``size``: that it has, for sensitivities, where
    its value is 0; None if the first failure has none to it. ``slider``: its least and largest
    value and its step, and their unit with its size in SI units.
    """

    name: str
    words: str
    places: str = "{}"
    size: float | None = None
    slider: Any = None

    @cached_property
    def fields(self) -> tuple[str, ...]:
        """The fields that it sets."""
        return tuple(self.places.format(self.name).split())

    @property
    def kind(self) -> Any:
        """The annotation of its fields."""
        part, _, field = self.fields[0].rpartition(".")
        return kinds_of(PARTS[part])[field]

    @property
    def number(self) -> Number | None:
        """The range of a number; None of any other."""
        return number_of(self.kind)

    def read(self, value: Any) -> Any:
        """``value``, from a file or a command line, as a `Joint` takes it.

        ValueError that says what is allowed.
        """
        if self.number:
            return self.number.read(value)
        return HoldDown.read(value) if self.kind is HoldDown else choice(self.kind, value)

    def of(self, joint: Joint) -> Any:
        """Its value in ``joint``; None of the elastic material of rigid pieces."""
        return value_at(joint, self.fields[0])

    @property
    def choices(self) -> type[StrEnum] | None:
        """The words that it may be; None of a number, and of what holds the joint down."""
        return None if self.number or self.kind is HoldDown else self.kind


MM, KPA, GPA = ("mm", 1e-3), ("kPa", 1e3), ("GPa", 1e9)
INNER, DRY, ELASTIC = "inner.{}", "dry.{}", "elastic.{}"
_TABLE = (
    Parameter("locks", "number of locks", slider=(2, 31, 1)),
    Parameter("a", "length of a lock (x)", size=1.0, slider=(15, 150, 1, *MM)),
    Parameter("b", "width of a lock (y)", size=1.0, slider=(20, 100, 1, *MM)),
    Parameter("h", "height of a lock (z)", size=1.0, slider=(3, 40, 0.5, *MM)),
    Parameter("H", "height of the body above the locks", size=1.0, slider=(15, 150, 1, *MM)),
    Parameter("cohesion", "cohesion of inner faces (tau_k)", INNER, 1.0, (10, 300, 5, *KPA)),
    Parameter("tensile_strength", "tensile strength of inner faces", INNER, 1e5),
    Parameter("normal_stiffness", "normal stiffness of inner faces", INNER, 1.0),
    Parameter("shear_stiffness", "shear stiffness of inner faces", INNER, 1.0),
    Parameter("fracture_energy", "fracture energy of bonds that soften", INNER),
    Parameter("bond_friction", "friction of bonds under compression", INNER, 1.0),
    Parameter(
        "dry_stiffness",
        "stiffness of dry faces, normal and shear",
        "dry.normal_stiffness dry.shear_stiffness",
        1.0,
    ),
    Parameter("friction", "coefficient of friction of dry faces", DRY, 1.0, (0, 0.8, 0.01)),
    Parameter("density", "density", size=1e3),
    Parameter("young", "Young's modulus of elastic pieces", ELASTIC, slider=(0, 50, 1, *GPA)),
    Parameter("poisson", "Poisson's ratio of elastic pieces", ELASTIC),
    Parameter("upper_body", "how the upper body is cut"),
    Parameter("failure", "failure of the bonds of inner faces"),
    Parameter("hold_down", "what holds the joint down"),
)
PARAMETERS = {parameter.name: parameter for parameter in _TABLE}
SIZES = tuple(name for name, each in PARAMETERS.items() if each.number and each.number.unit == "m")


def with_parameters(joint: Joint, values: Mapping[str, Any]) -> Joint:
    """``joint`` with the ``values`` of parameters by name; ValueError as for a `Joint`."""
    fields = {field: value for name, value in values.items() for field in PARAMETERS[name].fields}
    return with_fields(joint, fields)


def value_at(joint: Joint, place: str) -> Any:
    """The value of a field such as ``inner.cohesion``; None where ``joint`` has no such part."""
    part, _, field = place.rpartition(".")
    value = getattr(owner := getattr(joint, part) if part else joint, field, None)
    if value is None and isinstance(owner, FaceMaterial):  # bonds with the friction of the face
        return owner.friction_in_bonds
    return value


def with_fields(joint: Joint, values: Mapping[str, Any]) -> Joint:
    """``joint`` with the ``values`` of fields such as ``inner.cohesion``; errors of a `Joint`."""
    changes: dict[str, dict[str, Any]] = defaultdict(dict)
    for place, value in values.items():
        part, _, field = place.rpartition(".")
        changes[part][field] = value
    whole = changes.pop("", {})
    for part, changed in changes.items():
        before = getattr(joint, part)
        whole[part] = replace(before, **changed) if before is not None else Elastic(**changed)
    return replace(joint, **whole)


def unit_warnings(joint: Joint) -> Iterator[str]:
    """A line for each value of ``joint`` that is unlikely, with its unit, or has no effect."""
    parameters = [each for each in PARAMETERS.values() if each.number]
    yield from beyond((each.name, each.of(joint), each.number) for each in parameters)
    yield from material_warnings("inner faces: ", joint.inner, "friction")
    given = [name for name in SOFTENED if getattr(joint.inner, name)]
    if (softens := joint.failure is Failure.SOFTENING) and not given:
        yield "failure: softening bonds without fracture_energy are brittle; give it too"
    if not softens:
        for name in given:
            yield f"{name}: no effect on {joint.failure} bonds; give failure: softening too"


def material_warnings(what: str, material: FaceMaterial, *names: str) -> Iterator[str]:
    """The same of numbers of a ``material``, all or those with these ``names``."""
    kinds = kinds_of(FaceMaterial)
    yield from beyond(
        (f"{what}{name}", getattr(material, name), number_of(kinds[name]))
        for name in names or kinds
    )


def beyond(values: Iterable[tuple[str, float | None, Number | None]]) -> Iterator[str]:
    """One line for each of ``values`` that is unlikely; 0 counts as none."""
    for name, value, number in values:
        if not value or not number or number.likely[0] <= value <= number.likely[1]:
            continue
        what = f"very {'small' if value < number.likely[0] else 'large'}"
        if number.unit:
            yield f"{name}: {value:g} {number.unit} is {what}; is it in {number.unit}?"
        else:
            yield f"{name}: {value:g} is {what}; {_angle(value, number.likely[1])}"


def _angle(friction: float, most: float) -> str:
    """The likely meaning: an angle in degrees, if it is below 90."""
    if not friction < 90.0:
        return f"a coefficient of friction is hardly ever above {most:g}"
    coefficient = math.tan(math.radians(friction))
    return f"is it an angle in degrees? tan({friction:g}\N{DEGREE SIGN}) = {coefficient:.3g}"
