"""Warnings about values that are allowed but look as if they were in another unit."""

import math
from collections.abc import Iterable, Iterator, Mapping

from sidmacib.joint.joint import Joint

# Far beyond any lock of stone, concrete or timber, and any printed model.
LENGTH = (1e-3, 10.0)
STRENGTH = (100.0, 1e9)
STIFFNESS = (1e6, 1e15)
MODULUS = (1e6, 1e13)
DENSITY = (10.0, 3e4)
Value = tuple[str, float, tuple[float, float], str]  # what it is of, itself, its range, its unit
ROUGHEST = 1.2  # friction of masonry and concrete is 0.5 to 1


def unit_warnings(joint: Joint) -> Iterator[str]:
    """One line, with its unit, for each value of ``joint`` outside these ranges."""
    inner, dry = joint.inner, joint.dry
    values: list[Value] = [
        *((name, getattr(joint, name), LENGTH, "m") for name in "abhH"),
        ("cohesion", inner.cohesion, STRENGTH, "Pa"),
        ("tensile strength", inner.tensile_strength, STRENGTH, "Pa"),
        ("normal stiffness of inner faces", inner.normal_stiffness, STIFFNESS, "Pa/m"),
        ("shear stiffness of inner faces", inner.shear_stiffness, STIFFNESS, "Pa/m"),
        ("stiffness of dry faces", dry.normal_stiffness, STIFFNESS, "Pa/m"),
        ("density", joint.density, DENSITY, "kg/m3"),
    ]
    if joint.elastic is not None:
        values.append(("Young's modulus", joint.elastic.young, MODULUS, "Pa"))
    yield from beyond(values)
    yield from rough({"friction": dry.friction, "friction of inner faces": inner.friction})


def beyond(values: Iterable[Value]) -> Iterator[str]:
    """One line for each of ``values`` that is outside its range; 0 counts as none."""
    for name, value, (least, most), unit in values:
        if value and not least <= value <= most:
            what = "small" if value < least else "large"
            yield f"{name}: {value:g} {unit} is very {what}; is it in {unit}?"


def rough(frictions: Mapping[str, float]) -> Iterator[str]:
    """One line for each coefficient of friction that is unusually large, by its description."""
    for name, friction in frictions.items():
        if friction > ROUGHEST:
            yield f"{name}: {friction:g} is very large; {_angle(friction)}"


def _angle(friction: float) -> str:
    """The likely meaning: an angle in degrees, if it is below 90."""
    if not friction < 90.0:
        return f"a coefficient of friction is hardly ever above {ROUGHEST:g}"
    coefficient = math.tan(math.radians(friction))
    return f"is it an angle in degrees? tan({friction:g}°) = {coefficient:.3g}"
