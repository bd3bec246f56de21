"""Warnings about values that are allowed but look as if they were in another unit."""

import math
from collections.abc import Iterator

from sidmacib.joint import Joint

# Far beyond any lock of stone, concrete or timber, and any printed model.
LENGTH = (1e-3, 10.0)
STRENGTH = (100.0, 1e9)
STIFFNESS = (1e6, 1e15)
MODULUS = (1e6, 1e13)
DENSITY = (10.0, 3e4)
ROUGHEST = 1.2  # friction of masonry and concrete is 0.5 to 1


def unit_warnings(joint: Joint) -> Iterator[str]:
    """One line, with its unit, for each value of ``joint`` outside these ranges."""
    inner, dry = joint.inner, joint.dry
    values = [
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
    for name, value, (least, most), unit in values:
        if value and not least <= value <= most:
            what = "small" if value < least else "large"
            yield f"{name}: {value:g} {unit} is very {what}; is it in {unit}?"
    for name, friction in (("friction", dry.friction), ("friction of inner faces", inner.friction)):
        if friction > ROUGHEST:
            yield f"{name}: {friction:g} is very large; {_angle(friction)}"


def _angle(friction: float) -> str:
    """What may have been meant: an angle, if it is below 90 degrees."""
    if not friction < 90.0:
        return f"a coefficient of friction is hardly ever above {ROUGHEST:g}"
    coefficient = math.tan(math.radians(friction))
    return f"is it an angle in degrees? tan({friction:g}°) = {coefficient:.3g}"
