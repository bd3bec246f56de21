"""First failure of locks with scattering strengths: the weakest lock decides.

The strengths of the locks' roots are independent and lognormal. A joint survives a load if every
lock does, so it is weaker than locks of mean strength.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

from sidmacib.errors import CapacityError
from sidmacib.joint.joint import Direction, Joint
from sidmacib.joint.loading import Loading, Push
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.solution import Mode
from sidmacib.rule.law import first_failure, require_covered
from sidmacib.validation import refused, require_positive

# Largest distance of a quantile from the load at mean strength, in its logarithm: in standard
# deviations, and a constant.
WIDEST, NEAR = 20.0, 0.01
FIFTH_PERCENTILE = 0.05  # characteristic strength in codes


@dataclass(frozen=True)
class Scatter:
    """Loads at first failure of a joint whose locks' strengths scatter.

    ``load``: for locks of mean strength, N. ``utilisation``: of each root at this load, shape (n,).
    ``variation``: of the strengths, standard deviation over mean.
    """

    load: float
    utilisation: Floats
    variation: float

    def survival(self, load: float) -> float:
        """Probability that no root has failed at ``load`` (N)."""
        if load <= 0.0:
            return 1.0
        loaded = self.utilisation[self.utilisation > 0.0]
        needed = loaded * load / self.load
        return float(np.exp(norm.logsf(self._standard(needed)).sum()))

    def quantile(self, share: float = FIFTH_PERCENTILE) -> float:
        """The load (N) that a ``share`` of joints does not reach.

        ValueError unless the share is between 0 and 1.
        """
        if not 0.0 < share < 1.0:
            raise refused("share", share, "more than 0 and less than 1")
        deviation = self._deviation

        def beyond(logarithm: float) -> float:
            return self.survival(self.load * math.exp(logarithm)) - (1.0 - share)

        wide = WIDEST * deviation + NEAR
        return float(self.load * math.exp(brentq(beyond, -wide, wide, xtol=1e-10)))

    @staticmethod
    def strength(variation: float, standard: float) -> float:
        """A strength over its mean, of a ``standard`` normal variable."""
        deviation = math.sqrt(math.log1p(variation**2))
        return math.exp(deviation * standard - deviation**2 / 2.0)

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
    """Scatter of the first failure of ``joint`` for strengths of this coefficient of variation.

    The strengths of cuts between columns do not scatter. ValueError unless the variation is above
    0; `CapacityError` if the joint slides or rocks before a bond fails, which strengths do not
    decide; errors of `sidmacib.law`.
    """
    require_positive(variation=variation)
    require_covered(joint)
    state = first_failure(joint, Loading(direction, push=push))
    if state.mode is not Mode.BONDS:
        raise CapacityError(
            f"scatter: {joint.locks} locks move away ({state.mode}) at {state.load:.4g} N, before "
            "a bond fails; their strengths do not decide"
        )
    return Scatter(state.load, state.utilisation, variation)
