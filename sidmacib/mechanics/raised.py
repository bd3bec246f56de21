"""What is raised until an assembly fails: a load in N, or the angle by which gravity turns."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sidmacib.quantities import four_digits

Floats = NDArray[np.float64]
NEVER_FALLS = "in equilibrium up to a tilt of 180 degrees"


class Load:
    """A load in N that is raised in proportion.

    ``name``, ``unit``, ``sign``: of its values in answers; ``acts``: what does at one of them;
    ``last``: the last state of a path. ``axis``: of gravity that turns. ``per_unit``: N. ``most``:
    over the loads' scale; ``endless``: what there is to say where that is carried.
    """

    name, unit, sign, acts, last = "load", "N", " N", "load,", "peak"
    axis: tuple[float, float, float] | None = None
    per_unit, most, endless = 1.0, math.inf, ""

    def forces(self, load: float, permanent: Floats, variable: Floats, fixed: Any = 0.0) -> Floats:
        """Forces (N) and moments (N m) under ``load`` (N), (P, 6); ``fixed``: that do not turn."""
        return permanent + load * variable

    def drawn(self, load: float | None, weight: Floats, variable: Floats) -> Floats:
        """What is drawn of them: the variable load, per newton if ``load`` is None."""
        return (1.0 if load is None else load) * variable

    def value(self, load: float) -> float:
        """A ``load`` (N) in `unit`."""
        return load / self.per_unit

    def newtons(self, value: float) -> float:
        """The load (N) of a ``value`` in `unit`."""
        return value * self.per_unit

    def told(self, value: float) -> str:
        """A ``value`` with its unit."""
        return f"{four_digits(value)} {self.unit}"

    def short(self, value: float) -> str:
        """A ``value`` with its sign."""
        return f"{four_digits(value)}{self.sign}"

    def beside(self, value: float, weight: float) -> str:
        """A ``value`` beside the ``weight`` (N) of all that is free."""
        return f"{self.told(value)}, {value / weight:.3g} of the weight"

    def require_newtons(self, error: Exception) -> None:
        """Raise the ``error`` unless values are in N."""


A_LOAD = Load()


@dataclass(frozen=True)
class Tilt(Load):
    """The tilt of gravity about an ``axis``, of length 1; loads are angles in rad times the weight.

    ``per_unit``: the weight (N) times a degree. Permanent loads turn, apart from those that are
    fixed; the variable ones are how they begin to.
    """

    per_unit: float = field()  # both must be given: those of a load are no defaults
    axis: tuple[float, float, float] = field()
    name, unit, sign, acts, last = "tilt", "degrees", "°", "weight, tilted by", "last equilibrium"
    most, endless = math.pi, NEVER_FALLS

    def forces(self, load: float, permanent: Floats, variable: Floats, fixed: Any = 0.0) -> Floats:
        """See `Load.forces`."""
        axis, angle = np.array(self.axis), math.radians(self.value(load))
        vectors = (permanent - fixed).reshape(-1, 3)
        along = np.outer(vectors @ axis, axis)
        across = np.cross(axis, vectors)
        turned = along + math.cos(angle) * (vectors - along) + math.sin(angle) * across
        return turned.reshape(permanent.shape) + fixed

    def drawn(self, load: float | None, weight: Floats, variable: Floats) -> Floats:
        """The ``weight``, turned."""
        return weight if load is None else self.forces(load, weight, variable)

    def beside(self, value: float, weight: float) -> str:
        """The angle alone."""
        return self.short(value)

    def require_newtons(self, error: Exception) -> None:
        """Raise the ``error``."""
        raise error
