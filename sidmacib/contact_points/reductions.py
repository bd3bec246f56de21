"""Reductions of the revised SiDMACIB: the fraction of each lock's strength that counts.

Every rule returns the factors w_j of `sidmacib.Sidmacib`, one per lock. A lock that does not count
keeps its normal force and its friction along the lock. If all locks have the same strength, the V-M
curve does not depend on which of them count: their forces across the locks act along y through
points that have the same x in every lock. The rules start with the lower locks, which carry the
load to the ground. Rules that count locks, rather than weigh them, refuse joints whose locks differ
in strength.
"""

import math
from collections.abc import Callable, Sequence

from sidmacib.joint.joint import Joint

Weights = Sequence[float]


def no_reduction(joint: Joint, weights: Weights) -> tuple[float, ...]:
    """All locks count in full."""
    return (1.0,) * joint.locks


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


def weight_per_lock(joint: Joint, weights: Weights) -> tuple[float, ...]:
    """Every lock counts by its weight."""
    return tuple(weights)


REDUCTIONS: dict[str, Callable[[Joint, Weights], tuple[float, ...]]] = {
    "none": no_reduction,
    "floor_of_sum": floor_of_sum,
    "half": half_rule,
    "lower_sum": lower_sum,
    "per_lock": weight_per_lock,
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
            f"different: a strength from {low:g} to {high:g} N is not allowed with {rule}, which "
            "counts locks; it must be the same for all"
        )
