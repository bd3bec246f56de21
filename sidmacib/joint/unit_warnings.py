"""Warnings about values that are allowed but look as if they were in another unit."""

import math
from collections.abc import Iterable, Iterator

from sidmacib.fields import kinds_of, number_of
from sidmacib.joint.joint import Joint
from sidmacib.joint.parameters import PARAMETERS
from sidmacib.mechanics.assembly import FaceMaterial
from sidmacib.quantities import Number


def unit_warnings(joint: Joint) -> Iterator[str]:
    """One line, with its unit, for each value of ``joint`` that is unlikely."""
    parameters = [each for each in PARAMETERS.values() if each.number]
    yield from beyond((each.name, each.of(joint), each.number) for each in parameters)
    yield from material_warnings("inner faces: ", joint.inner, "friction")


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
