"""Inverse questions of a joint: the fewest locks, the cheapest sizes, all joints that carry a load.

What a joint carries is what the safe rule says; a joint that the rule refuses is no answer. Nothing
is assumed of how the safe load depends on sizes and locks: joints are tried from the fewest locks,
or from the cheapest, until one meets the demand.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint, UpperBody
from sidmacib.joint.loading import Push
from sidmacib.joint.parameters import SIZES
from sidmacib.rule import safe_at_most
from sidmacib.rule.reliability import DESIGN_VALUES, Reliability, design_resistance
from sidmacib.rule.spans import SPANS
from sidmacib.validation import refused, require_not_negative

VARIED = ("locks", *SIZES)
MOST = 20_000  # joints in one search
REFUSALS = (CapacityError, ValueError, ArithmeticError)


@dataclass(frozen=True)
class Demand:
    """A shear force V (N) and the torque M (N m) that a joint must carry together.

    ``shear``: V, in N. ``torque``: M, in N m. ``ratio``: e / a in place of the torque, which is
    then V e and grows with a. ``reliability``: of the joint that carries them. ValueError unless V
    is finite and not negative, M finite, and one of them not 0.
    """

    shear: float
    torque: float = 0.0
    ratio: float | None = None
    reliability: Reliability = DESIGN_VALUES

    def __post_init__(self) -> None:
        require_not_negative(shear=self.shear)
        if not math.isfinite(self.torque):
            raise refused("torque", self.torque, "a finite number")
        if self.ratio is None:
            if not (self.shear or self.torque):
                raise ValueError("demand: V or M must not be zero")
            return
        if self.torque:
            raise ValueError("demand: must have a torque or e / a, not both")
        if not (self.shear and math.isfinite(self.ratio)):
            raise ValueError("demand: e / a must be finite and V more than 0; give M for torsion")

    def direction(self, joint: Joint) -> Direction:
        """The direction of loading of ``joint``."""
        if self.ratio is not None:
            return Direction(self.ratio)
        if not self.shear:
            return Direction(math.copysign(math.inf, self.torque))
        return Direction(self.torque / (self.shear * joint.a))

    def load(self, joint: Joint) -> float:
        """The load along that direction, sqrt(V^2 + (M / a)^2), in N."""
        if self.ratio is not None:
            return self.shear * math.hypot(1.0, self.ratio)
        return math.hypot(self.shear, self.torque / joint.a)


@dataclass(frozen=True)
class Prices:
    """Prices by which joints are compared, in any currency.

    ``area``: of the joint in plan, per m2. ``volume``: cut out of both blocks, per m3. ``bonded``:
    area of all inner faces, per m2.

    ValueError unless all are finite and not negative, and one is more than 0.
    """

    area: float = 1.0
    volume: float = 0.0
    bonded: float = 0.0

    def __post_init__(self) -> None:
        require_not_negative(area=self.area, volume=self.volume, bonded=self.bonded)
        if not (self.area or self.volume or self.bonded):
            raise ValueError("prices: one of area, volume and bonded must be more than 0")

    def of(self, joint: Joint) -> float:
        """The price of ``joint``."""
        return (
            self.area * joint_area(joint)
            + self.volume * volume_cut(joint)
            + self.bonded * bonded_area(joint)
        )


AREA = Prices()


def joint_area(joint: Joint) -> float:
    """Area of the joint in plan, in m2."""
    return joint.a * joint.total_width


def volume_cut(joint: Joint) -> float:
    """Volume cut out of both blocks, in m3: where one has a lock, the other has none."""
    return joint_area(joint) * joint.h


def bonded_area(joint: Joint) -> float:
    """Area of all inner faces, in m2: the roots, and the cuts between columns."""
    cuts = 0 if joint.upper_body is UpperBody.MONOLITHIC else joint.locks - 1
    return joint_area(joint) + cuts * joint.a * joint.H


@dataclass(frozen=True)
class Candidate:
    """A joint beside a demand.

    ``direction``: of the demand's load, ``needed`` (N). ``load``: the safe one along it, or the
    design resistance (N); None where the safe rule refuses the joint, for ``reason``. ``exact``:
    False if the load is only an upper bound, which is below what is needed already.
    """

    joint: Joint
    direction: Direction
    needed: float
    load: float | None
    exact: bool = True
    reason: str = ""

    @property
    def meets(self) -> bool:
        """Whether the joint carries the demand by the safe rule."""
        return self.load is not None and self.load >= self.needed

    @property
    def usage(self) -> float | None:
        """Needed over safe load; where that is a bound, at least this; None if refused."""
        return self.needed / self.load if self.load else None

    @property
    def shear(self) -> float | None:
        """V of ``load``, in N."""
        return None if self.load is None else self.load * self.direction.shear

    @property
    def torque(self) -> float | None:
        """M of ``load``, in N m."""
        return None if self.load is None else self.load * self.direction.torque * self.joint.a


def candidate(joint: Joint, demand: Demand, push: Push = Push.PLUS_Y) -> Candidate:
    """``joint`` beside ``demand``: what the safe rule says of it, or why it refuses it."""
    needed, direction = demand.load(joint), demand.direction(joint)
    try:
        most = safe_at_most(joint, direction, push) / demand.reliability.partial_factor
        if most < needed:
            return Candidate(joint, direction, needed, most, exact=False)
        load = design_resistance(joint, direction, demand.reliability, push).load
        return Candidate(joint, direction, needed, load)
    except REFUSALS as error:
        return Candidate(joint, direction, needed, None, reason=" ".join(str(error).split()))


@dataclass(frozen=True)
class Search:
    """``found``: the first joint that meets the demand, or None; ``tried``: all, it included."""

    found: Candidate | None
    tried: tuple[Candidate, ...]


def fewest_locks(joint: Joint, demand: Demand, push: Push = Push.PLUS_Y) -> Search:
    """The fewest locks with which a joint of these sizes and materials carries ``demand``.

    All numbers from 2 up to the answer are tried, as more locks need not carry more.
    ``joint.locks`` counts for nothing. ValueError for locks that differ.
    """
    least, most = SPANS["locks"]
    if joint.elastic is not None:
        most = SPANS["locks of elastic blocks"][1]
    return _first(variants(joint, {"locks": range(int(least), int(most) + 1)}), demand, push)


def _first(joints: Sequence[Joint], demand: Demand, push: Push) -> Search:
    """The first of ``joints`` that meets the ``demand``."""
    tried = []
    for each in joints:
        tried.append(candidate(each, demand, push))
        if tried[-1].meets:
            return Search(tried[-1], tuple(tried))
    return Search(None, tuple(tried))


def cheapest(
    joint: Joint,
    demand: Demand,
    values: Mapping[str, Sequence[float]],
    prices: Prices = AREA,
    push: Push = Push.PLUS_Y,
) -> Search:
    """The cheapest joint that carries ``demand``, of all combinations of ``values``.

    ``values``: of the numbers that vary, by name: locks, a, b, h, H (m); all others are those of
    ``joint``. Cheapest first, so the first that meets it is the answer; ``tried`` shows why each
    cheaper one is none. At equal prices fewer locks and smaller sizes come first. Errors of
    `variants`.
    """
    joints = sorted(variants(joint, values), key=lambda one: _order(one, prices))
    return _first(joints, demand, push)


def all_candidates(
    joint: Joint,
    demand: Demand,
    values: Mapping[str, Sequence[float]],
    push: Push = Push.PLUS_Y,
) -> tuple[Candidate, ...]:
    """All combinations of ``values`` beside ``demand``, such as for a chart of locks against a.

    Arguments and errors of `cheapest`; in the order of ``values``, the last varying fastest.
    """
    return tuple(candidate(each, demand, push) for each in variants(joint, values))


def cheapest_of(candidates: Sequence[Candidate], prices: Prices = AREA) -> Candidate | None:
    """The cheapest of ``candidates`` that meets the demand, as `cheapest` finds it, or None."""
    found = [each for each in candidates if each.meets]
    return min(found, key=lambda one: _order(one.joint, prices), default=None)


def variants(joint: Joint, values: Mapping[str, Sequence[float]]) -> tuple[Joint, ...]:
    """``joint`` with all combinations of ``values``.

    ValueError for a name that is not in `VARIED`, for no or more than `MOST` combinations, for
    locks that differ, and as for a `Joint`.
    """
    if joint.different:
        raise refused("different", "locks that differ", "none where the number or size is sought")
    for name in values:
        if name not in VARIED:
            raise refused("values", name, f"one of {', '.join(VARIED)}")
    count = math.prod(len(each) for each in values.values())
    if not 0 < count <= MOST:
        raise refused("values", f"{count} joints", f"1 to {MOST} joints")
    return tuple(
        replace(joint, **dict(zip(values, each, strict=True)))  # type: ignore[arg-type]
        for each in product(*values.values())
    )


def _order(joint: Joint, prices: Prices) -> tuple[float, ...]:
    return prices.of(joint), *(getattr(joint, name) for name in VARIED)
