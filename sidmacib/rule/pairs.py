"""Closed form of the chain in pure shear: pairs of locks that bear, and how many of them work.

If nothing tilts or rubs, and locks bear on each other in pairs only, the chain is a row of equal
springs between equal links, and its solution a hyperbolic sine: shear lag, as in bolted and
bonded lap joints (Volkersen, 1938). docs/law.md derives it.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import LoadShare, Push
from sidmacib.validation import require_not_negative, require_positive, require_whole


@dataclass(frozen=True)
class Pairs:
    """A row of ``count`` pairs of an upper and a lower lock that bear on each other.

    ``lag``: stiffness of a pair over that of the body between two pairs, r = k / k_body; 0 for one
    rigid piece. ``direct``: part of the load that the first pair takes without the body, phi.
    ValueError if the count is not a whole number, the lag negative, or the part not in 0 ... 1.
    """

    count: int
    lag: float
    direct: float = 0.0

    def __post_init__(self) -> None:
        require_whole(0, count=self.count)
        require_not_negative(lag=self.lag, direct=self.direct)
        if self.direct > 1.0:
            raise ValueError(f"direct: {self.direct:g} is not possible; it must be at most 1")

    @property
    def decay(self) -> float:
        """kappa, by which the forces of pairs fall off along the row: 2 cosh kappa = 2 + r."""
        return math.acosh(1.0 + self.lag / 2.0)

    @property
    def working(self) -> float:
        """Locks that work when the first fails: V / T0 of a brittle joint, at most ``count``."""
        if self.count == 0:
            return 0.0
        kappa, others = self.decay, self.count - 1
        # sinh((P - 1) kappa) / sinh(P kappa), such that neither overflows.
        rest = (
            math.exp(-kappa)
            * math.expm1(-2.0 * others * kappa)
            / math.expm1(-2.0 * kappa * self.count)
            if kappa
            else others / self.count
        )
        return 1.0 / (1.0 - (1.0 - self.direct) * rest)

    @property
    def most(self) -> float:
        """Locks that work among any number of pairs; inf if neither body nor load sets a limit."""
        most = 1.0 - (1.0 - self.direct) * math.exp(-self.decay)
        return 1.0 / most if most > 0.0 else math.inf

    @property
    def transfer_length(self) -> float:
        """Pairs over which the load is handed on: the forces of pairs fall by e over as many."""
        return 1.0 / self.decay if self.decay > 0.0 else math.inf

    def enough(self, share: float = 0.95) -> float:
        """Pairs after which more add nothing: as many give this ``share`` of what any number gives.

        From tanh(P kappa) = share, the limit of small kappa.
        """
        return math.atanh(share) * self.transfer_length


def bearing_pairs(joint: Joint, push: Push = Push.PLUS_Y) -> int:
    """Pairs of locks that bear: lower locks that an upper lock pushes against."""
    order = range(1, joint.locks + 1) if push is Push.PLUS_Y else range(joint.locks, 0, -1)
    upper = [joint.is_upper(lock) for lock in order]
    return sum(one and not other for one, other in pairwise(upper))


def pairs_of(joint: Joint, push: Push = Push.PLUS_Y, share: LoadShare = LoadShare.FACE) -> Pairs:
    """The closed form of ``joint``, whose locks are alike and whose pieces are rigid.

    k = 1 / (2 / (Ks a b) + 1 / (Kd a h)): a root, the dry face and a root in series. The body
    between two pairs is two cuts, Kn a H / 2; one rigid piece has none. ValueError for stiffnesses
    that are no numbers or nothing.
    """
    root = joint.inner.shear_stiffness * joint.a * joint.b
    contact = joint.dry.normal_stiffness * joint.a * joint.h
    require_positive(**{"Ks a b": root, "Kd a h": contact})
    pair = 1.0 / (2.0 / root + 1.0 / contact)
    one_piece = joint.upper_body is UpperBody.MONOLITHIC
    lag = 0.0 if one_piece else 2.0 * pair / (joint.inner.normal_stiffness * joint.a * joint.H)
    first = joint.is_upper(1 if push is Push.PLUS_Y else joint.locks)
    on_lock = joint.h / (joint.h + joint.H) if first and share is LoadShare.FACE else 0.0
    return Pairs(bearing_pairs(joint, push), lag, on_lock * pair / root)
