"""Sizes, stiffnesses and strengths that are possible, but look as if they were in another unit."""

import math
from collections.abc import Iterator

from sidmacib.joint import Joint

# What locks of stone, concrete, timber or a printed model may have, and far more.
LENGTH = (1e-3, 10.0)
STRENGTH = (100.0, 1e9)
STIFFNESS = (1e6, 1e15)
MODULUS = (1e6, 1e13)
DENSITY = (10.0, 3e4)
ROUGHEST = 1.2  # friction of masonry and concrete is 0.5 to 1


def unit_warnings(joint: Joint) -> Iterator[str]:
    """One line for each number of ``joint`` that is far from all joints, with its unit."""
    inner, dry = joint.inner, joint.dry
    checked = [
        *((name, getattr(joint, name), LENGTH, "m") for name in "abhH"),
        ("cohesion", inner.cohesion, STRENGTH, "Pa"),
        ("tensile strength", inner.tensile_strength, STRENGTH, "Pa"),
        ("normal stiffness of inner faces", inner.normal_stiffness, STIFFNESS, "Pa/m"),
        ("shear stiffness of inner faces", inner.shear_stiffness, STIFFNESS, "Pa/m"),
        ("stiffness of dry faces", dry.normal_stiffness, STIFFNESS, "Pa/m"),
        ("density", joint.density, DENSITY, "kg/m3"),
    ]
    if joint.elastic is not None:
        checked.append(("Young's modulus", joint.elastic.young, MODULUS, "Pa"))
    for name, value, (least, most), unit in checked:
        if value and not least <= value <= most:
            what = "small" if value < least else "large"
            yield f"{name}: {value:g} {unit} is very {what}; is it in {unit}?"
    for name, friction in (("friction", dry.friction), ("friction of inner faces", inner.friction)):
        if friction > ROUGHEST:
            yield f"{name}: {friction:g} is very large; {_angle(friction)}"


def _angle(friction: float) -> str:
    """What a coefficient may have been: an angle below the steepest that faces have."""
    if not friction < 90.0:
        return f"a coefficient of friction is hardly ever above {ROUGHEST:g}"
    told = f"{math.tan(math.radians(friction)):.3g}"
    return f"is it an angle in degrees? tan({friction:g}°) = {told}"
