"""Loads on the pieces of an assembly: those that always act, and the one that is raised."""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.raised import A_LOAD, Floats, Load
from sidmacib.validation import require_positive


@dataclass(frozen=True)
class SideLoad:
    """The part of a piece's loads that acts on one of its sides.

    The side is normal to ``axis``: the one with the larger coordinate if ``high``. ``wrench``:
    force (N) and moment (N m) about the centroid if ``permanent``, otherwise these per newton of
    load. The stress varies linearly over the side.
    """

    piece: int
    axis: int
    high: bool
    wrench: tuple[float, ...]
    permanent: bool = False


@dataclass(frozen=True)
class Loads:
    """Forces and moments on the pieces, about their centroids, both of shape (P, 6).

    ``permanent`` (N and N m): loads that always act, such as self-weight. ``variable``: the load
    that is raised, per newton. ``scale`` (N): a load of the order of the capacity; the first
    increments are fractions of it. ``sides``: the parts of both that act on sides of pieces; the
    rest is spread over the volume, which matters only for elastic pieces. ``raised``: what the load
    that is raised is. ``guided``: a piece that is held along x, where no friction holds any.
    ValueError unless all numbers are finite and the scale above 0.
    """

    permanent: Floats
    variable: Floats
    scale: float
    sides: tuple[SideLoad, ...] = ()
    raised: Load = A_LOAD
    guided: int | None = None

    def __post_init__(self) -> None:
        for name, forces in (("permanent", self.permanent), ("variable", self.variable)):
            if not np.isfinite(forces).all():
                raise ValueError(f"{name} loads: they must be finite")
        require_positive(scale=self.scale)

    def at(self, load: float) -> Floats:
        """Forces (N) and moments (N m) on the pieces under ``load`` (N), (P, 6)."""
        return self.raised.forces(load, self.permanent, self.variable)

    def levers(self) -> Floats:
        """Sums of arm (m) times force (N) on each piece, whose arms turn with it, (2, P, 3, 3).

        Of the permanent loads, and of 1 N of the variable one.
        """
        return np.zeros((2, len(self.permanent), 3, 3))

    def require_proportional(self) -> None:
        """ValueError if gravity turns, for models that raise loads in proportion."""
        error = ValueError("loads: gravity turns; use static_tilt or limit_tilt")
        self.raised.require_newtons(error)
