"""Locks whose strengths scatter: a row of them is weaker than its mean, as the weakest decides.

The strengths of the locks' roots are independent and lognormal. The first failure is that of the
lock whose strength is least for its force, so the joint survives a load if every lock does.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading, Push
from sidmacib.mechanics.assembly import Floats
from sidmacib.rule.first_failure import first_failure
from sidmacib.rule.law import require_covered
from sidmacib.validation import refused, require_positive

WIDEST = 20.0  # of a load that is looked for, in standard deviations,
NEAR = 0.01  # and as a part of the load
FIFTH_PERCENTILE = 0.05  # of strengths: what codes call characteristic


@dataclass(frozen=True)
class Scatter:
    """Loads at first failure of a joint whose locks' strengths scatter.

    ``load``: of locks of mean strength, N. ``used``: of each root there, shape (n,).
    ``variation``: of the strengths, standard deviation over mean.
    """

    load: float
    used: Floats
    variation: float

    def survival(self, load: float) -> float:
        """Probability that no root has failed at ``load`` (N)."""
        if load <= 0.0:
            return 1.0
        needed = self.used[self.used > 0.0] * load / self.load
        return float(np.exp(norm.logsf(self._standard(needed)).sum()))

    def quantile(self, share: float = FIFTH_PERCENTILE) -> float:
        """The load (N) that a ``share`` of joints does not reach; ValueError if not in 0 ... 1."""
        if not 0.0 < share < 1.0:
            raise refused("share", share, "more than 0 and less than 1")
        deviation = self._deviation

        def beyond(logarithm: float) -> float:
            return self.survival(self.load * math.exp(logarithm)) - (1.0 - share)

        wide = WIDEST * deviation + NEAR
        return float(self.load * math.exp(brentq(beyond, -wide, wide, xtol=1e-10)))

    @property
    def _deviation(self) -> float:
        """Standard deviation of the logarithm of a strength."""
        return math.sqrt(math.log1p(self.variation**2))

    def _standard(self, strength: Floats) -> Floats:
        """A strength, over its mean, as a standard normal variable."""
        deviation = self._deviation
        return np.asarray((np.log(strength) + deviation**2 / 2.0) / deviation)


def scatter(
    joint: Joint, direction: Direction, variation: float, push: Push = Push.PLUS_Y
) -> Scatter:
    """First failures of ``joint`` with strengths of this ``variation``, around the law's.

    ValueError for a variation that is not positive, and as for `sidmacib.law`; cuts between columns
    have their strength for certain.
    """
    require_positive(variation=variation)
    require_covered(joint, direction)
    state = first_failure(joint, Loading(direction, push=push))
    return Scatter(state.load, state.used, variation)
