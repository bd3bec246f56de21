"""The parameters of a joint by one name each: flags, keys of a joint's file, sliders, ratios.

A parameter is one field of a `Joint`, or of its faces or its elastic material, or two fields that
are set together. Ranges, units and defaults are those of the fields.
"""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from sidmacib.fields import kinds_of, number_of
from sidmacib.joint.hold_down import HoldDown
from sidmacib.joint.joint import Joint
from sidmacib.mechanics.assembly import Elastic, FaceMaterial
from sidmacib.quantities import Number, choice

PARTS = {"": Joint, "inner": FaceMaterial, "dry": FaceMaterial, "elastic": Elastic}


@dataclass(frozen=True)
class Parameter:
    """A parameter: its description and the fields that it sets, such as ``inner.cohesion``."""

    name: str
    words: str
    fields: tuple[str, ...]

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
        part, _, field = self.fields[0].rpartition(".")
        return getattr(getattr(joint, part) if part else joint, field, None)

    @property
    def choices(self) -> type[StrEnum] | None:
        """The words that it may be; None of a number, and of what holds the joint down."""
        return None if self.number or self.kind is HoldDown else self.kind


PARAMETERS = {
    name: Parameter(name, words, tuple(fields))
    for name, words, *fields in (
        ("locks", "number of locks", "locks"),
        ("a", "length of a lock (x)", "a"),
        ("b", "width of a lock (y)", "b"),
        ("h", "height of a lock (z)", "h"),
        ("H", "height of the body above the locks", "H"),
        ("cohesion", "cohesion of inner faces (tau_k)", "inner.cohesion"),
        ("tensile_strength", "tensile strength of inner faces", "inner.tensile_strength"),
        ("normal_stiffness", "normal stiffness of inner faces", "inner.normal_stiffness"),
        ("shear_stiffness", "shear stiffness of inner faces", "inner.shear_stiffness"),
        ("fracture_energy", "fracture energy of bonds that soften", "inner.fracture_energy"),
        ("bond_friction", "friction of bonds under compression", "inner.bond_friction"),
        (
            "dry_stiffness",
            "stiffness of dry faces, normal and shear",
            *("dry.normal_stiffness", "dry.shear_stiffness"),
        ),
        ("friction", "coefficient of friction of dry faces", "dry.friction"),
        ("density", "density", "density"),
        ("young", "Young's modulus of elastic pieces", "elastic.young"),
        ("poisson", "Poisson's ratio of elastic pieces", "elastic.poisson"),
        ("upper_body", "how the upper body is cut", "upper_body"),
        ("failure", "failure of the bonds of inner faces", "failure"),
        ("hold_down", "what holds the joint down", "hold_down"),
    )
}


def with_parameters(joint: Joint, values: Mapping[str, Any]) -> Joint:
    """``joint`` with the ``values`` of parameters by name; ValueError as for a `Joint`."""
    changes: dict[str, dict[str, Any]] = defaultdict(dict)
    for name, value in values.items():
        for place in PARAMETERS[name].fields:
            part, _, field = place.rpartition(".")
            changes[part][field] = value
    whole = changes.pop("", {})
    for part, changed in changes.items():
        before = getattr(joint, part)
        whole[part] = replace(before, **changed) if before is not None else Elastic(**changed)
    return replace(joint, **whole)
