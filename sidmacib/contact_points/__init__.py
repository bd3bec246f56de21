"""Choices of SiDMACIB: contact points of the locks, and which part of their strength counts.

Forces between the blocks act at the contact points of an option, on the abstracted plane. A
reduction, of the revised SiDMACIB, returns the factors w_j of `sidmacib.Sidmacib`, one per lock. A
lock that does not count keeps its normal force and its friction along the lock. If all locks have
the same strength, the V-M curve does not depend on which of them count: their forces across the
locks act along y through points that have the same x in every lock. The rules start with the lower
locks, which carry the load to the ground. Rules that count locks, rather than weigh them, refuse
joints whose locks differ in strength.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import four_digits, is_number
from sidmacib.validation import refused

NEAREST = 1e-12  # over a: a point that is nearer to the lock's middle lies in it, but for rounding
Weights = Sequence[float]


@dataclass(frozen=True)
class ContactOption:
    """Contact points of every lock, on its centreline.

    ``positions``: distance from the lock's centre over its length a, between -1/2 and 1/2.
    ``portions``: share p of the lock's strength that each point may carry; they add up to 1.
    ValueError if they do not, or differ in number.
    """

    positions: tuple[float, ...]
    portions: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.positions) != len(self.portions):
            raise ValueError(
                f"positions: must be one for each of the {len(self.portions)} portions "
                f"(got {len(self.positions)})"
            )
        if not all(is_number(x) and abs(x) <= 0.5 for x in self.positions):
            raise refused("positions", self.positions, "from -0.5 to 0.5 (of a)")
        if not all(is_number(p) and p >= 0.0 for p in self.portions) or not math.isclose(
            math.fsum(self.portions), 1.0
        ):
            raise refused("portions", self.portions, "shares from 0 to 1 that add up to 1")
        apart = tuple(0.0 if abs(x) < NEAREST else x for x in self.positions)
        object.__setattr__(self, "positions", apart)

    @classmethod
    def pair(cls, distance: float) -> "ContactOption":
        """Two points at ``distance`` (over a) on either side of the lock's centre, half each."""
        return cls((-distance, distance), (0.5, 0.5))


# The paper's four options. It does not print the positions: these are assumptions, ordered as its
# text orders the pure torsion that they give.
OPTIONS = {
    "option1": ContactOption.pair(1 / 2),  # the ends of the lock
    "option2": ContactOption.pair(1 / 3),  # resultants of a linear stress on each half
    "option3": ContactOption.pair(1 / (2 * math.sqrt(3))),  # radius of gyration
    "option4": ContactOption.pair(1 / 4),  # resultants of a uniform stress on each half
}

# These and one more, which studies can name. `bilinear` has three points per lock, as the paper's
# option of that name; the paper prints neither positions nor portions (ASSUMED). A stress that is
# linear from each end to the middle is given by its values at these three places; by tributary
# lengths the middle represents half of the lock, each end a quarter. Without friction M is
# n T0 a / 4 as long as the middles can carry V, up to n T0 / 2; it then falls to 0 at n T0. The
# envelope so has two straight parts.
READY_OPTIONS = {
    **OPTIONS,
    "bilinear": ContactOption((-1 / 2, 0.0, 1 / 2), (1 / 4, 1 / 2, 1 / 4)),
}


def contact_points(joint: Joint, option: ContactOption) -> Floats:
    """Places (m) of the points of ``option``, lock by lock, at mid-height, (N, 3)."""
    places = [
        (along * joint.a, joint.lock_centre_y(lock), joint.h / 2)
        for lock in joint.numbers
        for along in option.positions
    ]
    return np.array(places)


def floor_of_sum(joint: Joint, weights: Weights) -> tuple[float, ...]:
    """As many locks count as the weights (the paper's W_sum) add up to, rounded down.

    ValueError if the locks differ in strength.
    """
    _require_alike(joint, "floor_of_sum")
    return active(joint, math.floor(math.fsum(weights)))


def half_rule(joint: Joint, weights: Weights) -> tuple[float, ...]:
    """(n - 1) / 2 locks count (the paper's rule), whichever block the first belongs to.

    ValueError if n is even or 1, or if the locks differ in strength.
    """
    if joint.locks % 2 == 0:
        raise ValueError(f"locks: {joint.locks} is not allowed with (n - 1) / 2; it must be odd")
    if joint.locks == 1:
        raise ValueError("locks: 1 is not allowed with (n - 1) / 2; it must be at least 3")
    _require_alike(joint, "(n - 1) / 2")
    return active(joint, (joint.locks - 1) // 2)


def lower_sum(joint: Joint, weights: Weights) -> tuple[float, ...]:
    """The lower locks count by their weights, the upper ones not at all."""
    return tuple(0.0 if joint.is_upper(j) else w for j, w in enumerate(weights, start=1))


REDUCTIONS: dict[str, Callable[[Joint, Weights], tuple[float, ...]]] = {
    "none": lambda joint, _: (1.0,) * joint.locks,
    "floor_of_sum": floor_of_sum,
    "half": half_rule,
    "lower_sum": lower_sum,
    "per_lock": lambda _, weights: tuple(weights),
}


def active(joint: Joint, count: int) -> tuple[float, ...]:
    """``count`` locks count in full, lower locks before upper ones, the others not at all."""
    chosen = (joint.lower_locks + joint.upper_locks)[:count]
    return tuple(float(lock in chosen) for lock in range(1, joint.locks + 1))


def _require_alike(joint: Joint, rule: str) -> None:
    """ValueError if a ``rule`` that counts locks is asked of locks that differ in strength."""
    low, high = min(joint.strengths), max(joint.strengths)
    if not math.isclose(low, high):
        raise ValueError(
            f"different: a strength from {four_digits(low)} to {four_digits(high)} N is not "
            f"allowed with {rule}, which counts locks; it must be the same for all"
        )
