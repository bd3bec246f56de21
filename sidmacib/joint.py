"""The joint: its geometry, its materials and the load on it.

Source of every definition here: Mousavian & Casapulla, Appl. Sci. 2024, 14(11), 4475,
doi:10.3390/app14114475, called "the paper" throughout this package.

Axes: ``x`` along the locks, ``y`` across them, ``z`` up. The origin is at mid-length of the
locks (x), at the face of lock 1 that looks away from lock 2 (y), and at the foot of the locks (z).
All quantities are in SI units.
"""

import math
from dataclasses import dataclass
from enum import StrEnum

from sidmacib.mechanics.assembly import Elastic, FaceMaterial, Failure
from sidmacib.validation import (
    is_number,
    refused,
    require_member,
    require_not_negative,
    require_positive,
    require_whole,
)


class UpperBody(StrEnum):
    """How the main body of the upper block is cut."""

    COLUMNS = "columns"  # one column above each lock, as in the paper
    JOINED = "joined"  # columns that can come apart, without the compliance of a joint
    MONOLITHIC = "monolithic"  # one piece


INNER = FaceMaterial(1e10, 1e10, friction=0.0, cohesion=8e4, tensile_strength=3.7e5)
DRY = FaceMaterial(1e10, 1e10, friction=0.3, cohesion=0.0, tensile_strength=0.0)


@dataclass(frozen=True)
class Joint:
    """A corrugated joint between two blocks, with ``locks`` locks in a row along y.

    The defaults are the paper's sample. Of its geometry the paper's text gives only a * b =
    0.003 m2; a, b, h and H are assumptions.

    ``a``, ``b``, ``h``: length (x), width (y) and height (z) of a lock, in m. ``H``: height of the
    upper main body above the locks, in m. ``density`` in kg/m3. Lock 1 is the first in +y. Odd
    locks belong to the upper block, even locks to the lower one. ``block``: the material of pieces
    that deform; they are rigid if it is None. ValueError for anything but at
    least two locks, sizes above 0 and a density that is not negative.
    """

    locks: int
    a: float = 0.06
    b: float = 0.05
    h: float = 0.008
    H: float = 0.027
    density: float = 1400.0
    inner: FaceMaterial = INNER
    dry: FaceMaterial = DRY
    failure: Failure = Failure.BRITTLE
    upper_body: UpperBody = UpperBody.COLUMNS
    block: Elastic | None = None

    def __post_init__(self) -> None:
        require_whole(2, locks=self.locks)
        require_positive(a=self.a, b=self.b, h=self.h, H=self.H)
        require_not_negative(density=self.density)
        for name in ("inner", "dry"):
            if not isinstance(getattr(self, name), FaceMaterial):
                raise refused(name, getattr(self, name), "a FaceMaterial")
        require_member(Failure, failure=self.failure)
        require_member(UpperBody, upper_body=self.upper_body)
        if not isinstance(self.block, Elastic | None):
            raise refused("block", self.block, "an Elastic, or None for rigid pieces")

    @property
    def T0(self) -> float:
        """Shear strength of one lock, cohesion times the area of its inner face, in N."""
        return self.inner.cohesion * self.a * self.b

    @property
    def upper_locks(self) -> tuple[int, ...]:
        """Numbers of the locks that belong to the upper block (odd)."""
        return tuple(range(1, self.locks + 1, 2))

    @property
    def lower_locks(self) -> tuple[int, ...]:
        """Numbers of the locks that belong to the lower block (even)."""
        return tuple(range(2, self.locks + 1, 2))

    def lock_centre_y(self, lock: int) -> float:
        """Position across the joint of the centreline of lock number ``lock``, in m."""
        return (lock - 0.5) * self.b

    def is_upper(self, lock: int) -> bool:
        """Whether lock number ``lock`` belongs to the upper block."""
        return lock % 2 == 1


@dataclass(frozen=True)
class Direction:
    """A direction of loading in the (V, M) plane: V = load * shear, M = load * torque * a.

    ``eccentricity`` is e / a, the lever of the force over the locks' length; ``inf`` is pure
    torsion. ``shear`` and ``torque`` are pure numbers with shear**2 + torque**2 = 1, so ``load`` is
    in N for every direction, pure torsion included. ValueError if it is not a number.
    """

    eccentricity: float

    def __post_init__(self) -> None:
        if not is_number(self.eccentricity) or math.isnan(self.eccentricity):
            raise refused("eccentricity", self.eccentricity, "a number (e / a) or inf")

    @property
    def shear(self) -> float:
        """V over the load."""
        return 0.0 if math.isinf(self.eccentricity) else 1.0 / math.hypot(1.0, self.eccentricity)

    @property
    def torque(self) -> float:
        """M over the load times a."""
        if math.isinf(self.eccentricity):
            return math.copysign(1.0, self.eccentricity)
        return self.eccentricity / math.hypot(1.0, self.eccentricity)
