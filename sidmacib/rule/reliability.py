"""Reliability of a joint: scatter of its first failure, characteristic and design resistance.

Where strengths scatter the weakest bond decides: a joint survives a load if every root and every
cut between columns does, so it is weaker than one whose bonds all have the mean strength.
Resistances are those of EN 1990.

The characteristic resistance is the load that 5 % of joints do not reach: the 5 % fractile of the
first failure (EN 1990, 4.2). The strengths of bonded faces are independent and lognormal (D.7.2);
mean and coefficient of variation are known. Up to the first failure the forces do not depend on
strengths, so the fractile is the load of a joint whose strengths are all divided by one margin, at
which 95 % of joints survive.

The design resistance has the partial factor on the strengths (6.3.5, expression 6.6a) or on the
resistance (6.6c), whichever gives less, and the margin of the safe rule for the model.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, Push
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.solution import Mode
from sidmacib.quantities import four_digits
from sidmacib.rule import JointFailure, LawCapacity, capacity_of, first_failure, safe, weakened
from sidmacib.rule.spans import require_covered
from sidmacib.validation import refused, require_positive

# Largest distance of a quantile from the load at mean strength, in its logarithm: in standard
# deviations, and a constant.
WIDEST, LEAST_WIDTH = 20.0, 0.01
FIFTH_PERCENTILE = 0.05  # characteristic strength in codes
MOST_VARIED, LARGEST_FACTOR = 1.0, 10.0
ROUNDING = 1e-6  # of a margin
NEAR = 0.01  # to 5 %: the share of joints that have failed at the load that is found


@dataclass(frozen=True)
class Scatter:
    """Loads at first failure of a joint whose locks' strengths scatter.

    ``load``: for bonds of mean strength, N. ``utilisation``: of each bonded face at this load, of
    roots and of cuts between columns, shape (F,). ``variation``: of the strengths, standard
    deviation over mean.
    """

    load: float
    utilisation: Floats
    variation: float

    def survival(self, load: float) -> float:
        """Probability that no bonded face has failed at ``load`` (N)."""
        if load <= 0.0:
            return 1.0
        loaded = self.utilisation[self.utilisation > 0.0]
        needed, deviation = loaded * load / self.load, log_deviation(self.variation)
        standard = (np.log(needed) + deviation**2 / 2.0) / deviation  # normal variable
        return float(np.exp(norm.logsf(standard).sum()))

    def quantile(self, share: float = FIFTH_PERCENTILE) -> float:
        """The load (N) that a ``share`` of joints does not reach.

        ValueError unless the share is between 0 and 1.
        """
        if not 0.0 < share < 1.0:
            raise refused("share", share, "more than 0 and less than 1")

        def beyond(logarithm: float) -> float:
            return self.survival(self.load * math.exp(logarithm)) - (1.0 - share)

        wide = WIDEST * log_deviation(self.variation) + LEAST_WIDTH
        return float(self.load * math.exp(brentq(beyond, -wide, wide, xtol=1e-10)))


def log_deviation(variation: float) -> float:
    """Standard deviation of the logarithm of a strength with this coefficient of ``variation``."""
    return math.sqrt(math.log1p(variation**2))


def scatter(
    joint: Joint, direction: Direction, variation: float, push: Push = Push.PLUS_Y
) -> Scatter:
    """Scatter of the first failure of ``joint`` for strengths of this coefficient of variation.

    Each root and each cut between columns has a strength of its own. ValueError unless the
    variation is above 0; `CapacityError` if the joint slides or rocks before a bond fails, which
    strengths do not decide; errors of `sidmacib.law`.
    """
    require_positive(variation=variation)
    require_covered(joint)
    state = first_failure(joint, Loading(direction, push=push))
    if state.mode is not Mode.BONDS:
        raise CapacityError(
            f"scatter: {joint.locks} locks move away ({state.mode}) at {four_digits(state.load)} "
            "N, before a bond fails; their strengths do not decide"
        )
    return Scatter(state.load, state.bonds, variation)


@dataclass(frozen=True)
class Reliability:
    """What the strengths of a joint stand for, and the partial factor.

    ``variation``: coefficient of variation of strengths that are means; 0 for strengths that are
    characteristic or design values. ``partial_factor``: gamma_M, 1 for strengths that are design
    values. ValueError for numbers out of range.
    """

    variation: float = 0.0
    partial_factor: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.variation <= MOST_VARIED:
            allowed = f"more than 0 and at most {MOST_VARIED:g}, as in 0.2 for 20 %"
            raise refused("scatter", self.variation, allowed)
        if not 1.0 <= self.partial_factor <= LARGEST_FACTOR:
            raise refused("gamma_m", self.partial_factor, f"from 1 to {LARGEST_FACTOR:g}")


DESIGN_VALUES = Reliability()


@dataclass(frozen=True)
class Characteristic:
    """The characteristic resistance, and the margin on mean strengths that gives it."""

    capacity: LawCapacity
    margin: float


def characteristic(
    joint: Joint, direction: Direction, variation: float, push: Push = Push.PLUS_Y
) -> Characteristic:
    """The load that 5 % of joints with strengths of this coefficient of ``variation`` do not reach.

    The strengths of ``joint`` are means. Where it slides or rocks before 5 % have failed, that load
    counts. ValueError for a variation out of range; errors of `sidmacib.law`, `CapacityError` too
    where permanent loads alone make more than 5 % fail.
    """
    if not variation > 0.0:
        raise refused("scatter", variation, f"more than 0 and at most {MOST_VARIED:g}")
    Reliability(variation)
    require_covered(joint)

    def at(margin: float) -> JointFailure:
        return first_failure(weakened(joint, margin), Loading(direction, push=push))

    def beyond(margin: float) -> float:
        state = at(margin)
        scattered = Scatter(state.load, state.bonds / margin, variation)
        return scattered.survival(state.load) - (1.0 - FIFTH_PERCENTILE)

    def held(margin: float) -> float:
        """The same; more where so weak a joint fails before it is loaded."""
        try:
            return beyond(margin)
        except CapacityError:
            return FIFTH_PERCENTILE

    margin = 1.0
    if beyond(margin) < 0.0:
        # Suffices even where all bonds are loaded to their strength.
        share = 1.0 - (1.0 - FIFTH_PERCENTILE) ** (1.0 / len(at(margin).bonds))
        deviation = log_deviation(variation)
        most = 1.01 / math.exp(deviation * float(norm.ppf(share)) - deviation**2 / 2.0)
        margin = float(brentq(held, 1.0, most, xtol=ROUNDING, rtol=ROUNDING))
        if abs(held(margin)) > NEAR:
            raise CapacityError(
                f"characteristic value: more than 5 % of joints of {joint.locks} locks fail under "
                "their permanent loads alone"
            )
    found = at(margin)
    return Characteristic(capacity_of(joint, direction, found.load, found.mode), margin)


def design_resistance(
    joint: Joint, direction: Direction, reliability: Reliability, push: Push = Push.PLUS_Y
) -> LawCapacity:
    """The design resistance of ``joint``: the safe load where strengths are design values already.

    Errors of `characteristic` and `sidmacib.safe`.
    """
    weak, factor = joint, reliability.partial_factor
    if reliability.variation:
        found = characteristic(joint, direction, reliability.variation, push)
        weak = weakened(joint, found.margin)
    whole = safe(weak, direction, push)
    if factor == 1.0:
        return whole
    of_strengths = safe(weakened(weak, factor), direction, push)
    if of_strengths.load < whole.load / factor:
        return of_strengths
    return capacity_of(joint, direction, whole.load / factor, whole.mode)


def resistances(
    reliability: Reliability, *, decides: bool = False
) -> dict[str, Callable[..., LawCapacity]]:
    """`characteristic` and `design_resistance`, as far as ``reliability`` asks for them, by name.

    ``decides``: whether a scatter alone asks for the latter too, as a load is to be carried.
    They take a joint, a direction and a push, as the law does.
    """
    asked: dict[str, Callable[..., LawCapacity]] = {}
    if reliability.variation:
        asked["characteristic"] = lambda joint, direction, push=Push.PLUS_Y: (
            characteristic(joint, direction, reliability.variation, push).capacity
        )
    if reliability.partial_factor != 1.0 or (decides and reliability.variation):
        asked["design"] = partial(design_resistance, reliability=reliability)
    return asked
