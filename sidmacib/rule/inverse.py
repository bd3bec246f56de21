"""Inverse questions of a joint: the fewest locks, the cheapest sizes, all joints that carry a load.

What a joint carries is what the safe rule says; a joint that the rule refuses is no answer. Nothing
is assumed of how the safe load depends on sizes and locks: joints are tried from the fewest locks,
or from the cheapest, until one meets the demand.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from sidmacib.joint.joint import Joint
from sidmacib.joint.loading import Push
from sidmacib.rule.demand import Candidate, Demand, Prices, candidate
from sidmacib.rule.law import SPANS
from sidmacib.validation import refused

SIZES = ("locks", "a", "b", "h", "H")  # what may vary
MOST = 20_000  # joints in one search
AREA = Prices()


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
    tried = []
    for each in variants(joint, {"locks": range(int(least), int(most) + 1)}):
        tried.append(candidate(each, demand, push, exact=False))
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
    tried = []
    for each in sorted(variants(joint, values), key=lambda one: _order(one, prices)):
        tried.append(candidate(each, demand, push, exact=False))
        if tried[-1].meets:
            return Search(tried[-1], tuple(tried))
    return Search(None, tuple(tried))


def all_candidates(
    joint: Joint,
    demand: Demand,
    values: Mapping[str, Sequence[float]],
    push: Push = Push.PLUS_Y,
) -> tuple[Candidate, ...]:
    """All combinations of ``values`` beside ``demand``, such as for a chart of locks against a.

    Arguments and errors of `cheapest`; in the order of ``values``, the last varying fastest.
    """
    return tuple(candidate(each, demand, push, exact=False) for each in variants(joint, values))


def cheapest_of(candidates: Sequence[Candidate], prices: Prices = AREA) -> Candidate | None:
    """The cheapest of ``candidates`` that meets the demand, as `cheapest` finds it, or None."""
    found = [each for each in candidates if each.meets]
    return min(found, key=lambda one: _order(one.joint, prices), default=None)


def variants(joint: Joint, values: Mapping[str, Sequence[float]]) -> tuple[Joint, ...]:
    """``joint`` with all combinations of ``values``.

    ValueError for a name that is not in `SIZES`, for no or more than `MOST` combinations, for locks
    that differ, and as for a `Joint`.
    """
    if joint.different:
        raise refused("different", "locks that differ", "none where the number or size is sought")
    for name in values:
        if name not in SIZES:
            raise refused("values", name, f"one of {', '.join(SIZES)}")
    count = math.prod(len(each) for each in values.values())
    if not 0 < count <= MOST:
        raise refused("values", f"{count} joints", f"1 to {MOST} joints")
    return tuple(
        replace(joint, **dict(zip(values, each, strict=True)))  # type: ignore[arg-type]
        for each in product(*values.values())
    )


def _order(joint: Joint, prices: Prices) -> tuple[float, ...]:
    return prices.of(joint), *(getattr(joint, name) for name in SIZES)
