"""The joint: its geometry, its materials and the load on it.

Source of every definition here: Mousavian & Casapulla, Appl. Sci. 2024, 14(11), 4475,
doi:10.3390/app14114475, called "the paper" throughout this package.

Axes: ``x`` along the locks, ``y`` across them, ``z`` up. The origin is at mid-length of the
locks (x), at the face of lock 1 that looks away from lock 2 (y), and at the foot of the locks (z).
All quantities are in SI units.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from typing import Annotated, Any

from sidmacib.mechanics.assembly import Elastic, FaceMaterial, Failure, Kind
from sidmacib.quantities import Count, Density, Length, Number, ReadBy, is_number, shown
from sidmacib.validation import refused, require_kinds, require_member


class Hold(StrEnum):
    """The kind of a hold-down."""

    PLATE = "plate"  # fixed and frictionless, above the upper block; it can only push
    FORCE = "force"  # given, whatever the upper block does
    PRESSURE = "pressure"  # the same, per area of the upper block's top
    WEIGHT = "weight"  # nothing but self-weight


AMOUNTS = {
    Hold.FORCE: Number(at_least=0, unit="N"),
    Hold.PRESSURE: Number(at_least=0, unit="Pa"),
}
_NOTHING = Number(at_least=0, at_most=0)  # amount of a plate or of nothing


@dataclass(frozen=True)
class HoldDown:
    """Support or load on the top of the upper block; by default the fixed plate of the paper.

    ``amount``: of a force, in N, or of a pressure, in Pa; it acts downwards and is spread evenly
    over the top. ValueError if it is negative, not finite, or given with anything else.
    """

    kind: Hold = Hold.PLATE
    amount: float = 0.0

    def __post_init__(self) -> None:
        require_member(Hold, hold_down=self.kind)
        AMOUNTS.get(self.kind, _NOTHING).require(f"hold_down {self.kind}", self.amount)

    @classmethod
    def read(cls, value: Any) -> "HoldDown":
        """The hold-down given in a file: a name, or the amount by name, such as {force: 2000}.

        ValueError for anything else.
        """
        if isinstance(value, HoldDown):
            return value
        if isinstance(value, str) and value in (Hold.PLATE, Hold.WEIGHT):
            return cls(Hold(value))
        if isinstance(value, Mapping) and len(value) == 1:
            ((kind, amount),) = value.items()
            if kind in AMOUNTS:
                try:
                    return cls(Hold(kind), AMOUNTS[Hold(kind)].read(amount))
                except ValueError as error:
                    raise ValueError(f"{kind}: {error}") from None
        names = ", ".join(kind for kind in Hold if kind not in AMOUNTS)
        amounts = " or ".join(f"{{{kind}: a number ({x.unit})}}" for kind, x in AMOUNTS.items())
        given = shown(value)
        if isinstance(value, Mapping) and value:
            given = f"a mapping of {', '.join(map(shown, islice(value, 5)))}"
        raise ValueError(f"{given} is not allowed; it must be {names}, {amounts}")

    @property
    def spelled(self) -> str | dict[str, float]:
        """The value as `read` accepts it."""
        kind = str(self.kind)
        return {kind: self.amount} if self.kind in AMOUNTS else kind

    @classmethod
    def plate(cls) -> "HoldDown":
        """A fixed, frictionless plate."""
        return cls(Hold.PLATE)

    @classmethod
    def force(cls, newtons: float) -> "HoldDown":
        """A force in N."""
        return cls(Hold.FORCE, newtons)

    @classmethod
    def pressure(cls, pascals: float) -> "HoldDown":
        """A pressure in Pa."""
        return cls(Hold.PRESSURE, pascals)

    @classmethod
    def weight(cls) -> "HoldDown":
        """Self-weight alone."""
        return cls(Hold.WEIGHT)

    def force_on(self, area: float) -> float | None:
        """The force (N) on a top of this ``area`` (m2); None for a plate, which only reacts."""
        if self.kind is Hold.PLATE:
            return None
        return self.amount * area if self.kind is Hold.PRESSURE else self.amount


HeldDown = Annotated[
    HoldDown,
    ReadBy(
        HoldDown.read,
        {
            "anyOf": [
                {"enum": [str(kind) for kind in Hold if kind not in AMOUNTS]},
                *(
                    {
                        "type": "object",
                        "properties": {str(kind): number.schema},
                        "required": [str(kind)],
                        "additionalProperties": False,
                    }
                    for kind, number in AMOUNTS.items()
                ),
            ],
            "allowed": "`plate`, `weight`, `{force: N}` or `{pressure: Pa}`",
        },
        lambda hold_down: hold_down.spelled,
    ),
]


class UpperBody(StrEnum):
    """Division of the main body of the upper block into pieces."""

    COLUMNS = "columns"  # one column above each lock, as in the paper
    JOINED = "joined"  # columns that can come apart, without the compliance of a joint
    MONOLITHIC = "monolithic"  # one piece


class Side(StrEnum):
    """The block that a lock belongs to."""

    UPPER = "upper"
    LOWER = "lower"


FIXED_PLATE = HoldDown()
INNER = FaceMaterial(
    1e10, 1e10, friction=0.0, cohesion=8e4, tensile_strength=3.7e5, bond_friction=0.0
)
DRY = FaceMaterial(1e10, 1e10, friction=0.3, cohesion=0.0, tensile_strength=0.0)


@dataclass(frozen=True)
class OwnLock:
    """Properties in which a lock differs from the joint; None: the same as the joint.

    ``width`` (y) in m; ``density`` in kg/m3; ``inner``: the face across which it meets its
    block. ValueError as for a `Joint`.
    """

    width: Length | None = None
    density: Density | None = None
    inner: FaceMaterial | None = None

    def __post_init__(self) -> None:
        require_kinds(self)


PLAIN = OwnLock()


@dataclass(frozen=True)
class Joint:
    """A corrugated joint between two blocks, with ``locks`` locks in a row along y.

    Sizes and materials are by default those of the paper's sample. Of its geometry the paper's text
    gives only a * b = 0.003 m2; a, b, h and H are assumptions.

    ``a``, ``b``, ``h``: length (x), width (y) and height (z) of a lock, in m. ``H``: height of the
    upper main body above the locks, in m. ``density`` in kg/m3. ``inner``: material of the inner
    faces; ``dry``: of all other faces of a lock. Lock 1 is the first in +y; it belongs to the block
    ``first``, and the others alternate. ``different``: the locks that differ, by number; it is kept
    as pairs in the order of the numbers. ``hold_down``: support or load on the top of the upper
    block. ``elastic``: the material of elastic pieces; None for rigid ones. ValueError for a number
    out of its range, and for ``different`` locks that do not exist.
    """

    locks: Count
    a: Length = 0.06
    b: Length = 0.05
    h: Length = 0.008
    H: Length = 0.027
    density: Density = 1400.0
    inner: FaceMaterial = INNER
    dry: FaceMaterial = DRY
    failure: Failure = Failure.BRITTLE
    upper_body: UpperBody = UpperBody.MONOLITHIC
    first: Side = Side.UPPER
    different: Mapping[int, OwnLock] | tuple[tuple[int, OwnLock], ...] = ()
    hold_down: HoldDown = FIXED_PLATE
    elastic: Elastic | None = None

    def __post_init__(self) -> None:
        require_kinds(self)
        object.__setattr__(self, "different", _in_order(self.different, self.locks))

    @property
    def T0(self) -> float:
        """Shear strength of an unchanged lock: cohesion times a times b, in N."""
        return self.material_of(Kind.INNER).cohesion * self.a * self.b

    @property
    def strengths(self) -> tuple[float, ...]:
        """Shear strength of each lock, in N."""
        return tuple(map(self.strength, self.numbers))

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of the locks."""
        return tuple(range(1, self.locks + 1))

    @property
    def interlocking(self) -> bool:
        """Whether locks bear against each other, which takes at least two."""
        return self.locks > 1

    @property
    def upper_locks(self) -> tuple[int, ...]:
        """Numbers of the locks that belong to the upper block."""
        return tuple(filter(self.is_upper, self.numbers))

    @property
    def lower_locks(self) -> tuple[int, ...]:
        """Numbers of the locks that belong to the lower block."""
        return tuple(lock for lock in self.numbers if not self.is_upper(lock))

    @property
    def total_width(self) -> float:
        """Width of all locks together, in m."""
        return self.edge(self.locks)

    @property
    def least_side(self) -> float:
        """The shortest side of the locks' horizontal faces, in m."""
        return min(self.a, *map(self.width, self.numbers))

    @property
    def pressing_force(self) -> float | None:
        """The given force on the upper block's top, in N; None under a plate."""
        return self.hold_down.force_on(self.a * self.total_width)

    @property
    def stiffness_ratio(self) -> float:
        """E of the block over Kn b: the solid between two locks, over a cut; inf if rigid."""
        if self.elastic is None:
            return math.inf
        return self.elastic.young / (self.material_of(Kind.INNER).normal_stiffness * self.b)

    def own(self, lock: int) -> OwnLock:
        """Properties in which lock number ``lock`` differs from the joint."""
        return dict(self.different).get(lock, PLAIN)

    def width(self, lock: int) -> float:
        """Width (y) of lock number ``lock``, in m."""
        width = self.own(lock).width
        return self.b if width is None else width

    def lock_density(self, lock: int) -> float:
        """Density of lock number ``lock``, in kg/m3."""
        density = self.own(lock).density
        return self.density if density is None else density

    def material_of(self, kind: Kind) -> FaceMaterial:
        """Law of the faces of ``kind``, as every model and rule reads it.

        Locks may differ from that of inner faces, see `inner_of`. ValueError for contact points in
        place of locks, which a joint does not have.
        """
        if kind is Kind.INNER:
            return self.inner
        if kind is Kind.DRY:
            return self.dry
        if kind is Kind.PLATE:
            dry = self.material_of(Kind.DRY)
            return FaceMaterial(dry.normal_stiffness, dry.shear_stiffness, 0.0, 0.0, 0.0)
        raise refused("kind", kind, "inner, dry or plate")

    def inner_of(self, lock: int) -> FaceMaterial:
        """Law of the face across which lock number ``lock`` meets its block."""
        return self.own(lock).inner or self.material_of(Kind.INNER)

    def strength(self, lock: int) -> float:
        """Shear strength of lock number ``lock``: its cohesion times its area, in N."""
        return self.inner_of(lock).cohesion * self.a * self.width(lock)

    def edge(self, lock: int) -> float:
        """Position across the joint of the far edge of lock number ``lock``, in m; 0 of none."""
        return lock * self.b + self._more(lock)

    def lock_centre_y(self, lock: int) -> float:
        """Position across the joint of the centreline of lock number ``lock``, in m."""
        more = (self._more(lock - 1) + self._more(lock)) / 2
        return (lock - 0.5) * self.b + more

    def _more(self, lock: int) -> float:
        """Extra width of the locks up to number ``lock`` over unchanged ones, in m."""
        wide = dict(self.different)
        return math.fsum(self.width(each) - self.b for each in wide if each <= lock)

    def is_upper(self, lock: int) -> bool:
        """Whether lock number ``lock`` belongs to the upper block."""
        return (lock % 2 == 1) is (self.first is Side.UPPER)


def _in_order(
    different: Mapping[int, OwnLock] | tuple[tuple[int, OwnLock], ...], locks: int
) -> tuple[tuple[int, OwnLock], ...]:
    """The checked properties of locks that differ, in the order of their numbers."""
    pairs = tuple(different.items() if isinstance(different, Mapping) else different)
    for number, changes in pairs:
        if isinstance(number, bool) or number not in range(1, locks + 1):
            raise refused("different", number, f"the number of a lock, 1 to {locks}")
        if not isinstance(changes, OwnLock):
            raise refused(f"different: lock {number}", changes, "an OwnLock")
    if len(dict(pairs)) < len(pairs):
        raise refused("different", [number for number, _ in pairs], "one entry for each lock")
    return tuple(
        sorted(((int(number), changes) for number, changes in pairs), key=lambda pair: pair[0])
    )


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
        return 1.0 / math.hypot(1.0, self.eccentricity)

    @property
    def torque(self) -> float:
        """M over the load times a."""
        if math.isinf(self.eccentricity):
            return math.copysign(1.0, self.eccentricity)
        return self.eccentricity / math.hypot(1.0, self.eccentricity)
