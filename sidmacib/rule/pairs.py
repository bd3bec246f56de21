"""Pure shear in closed form: pairs of locks that bear, and how many of them work.

Without tilting and friction, locks bear on each other in pairs. The joint is then a chain of equal
springs between equal links, and its solution a hyperbolic sine: shear lag, as in bolted and bonded
lap joints (Volkersen, 1938). docs/law.md derives it.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

from sidmacib.joint import Joint, UpperBody
from sidmacib.joint.loading import LoadShare, Push
from sidmacib.mechanics.assembly import Kind
from sidmacib.validation import refused, require_not_negative, require_positive, require_whole


@dataclass(frozen=True)
class Pairs:
    """A row of ``count`` pairs of an upper and a lower lock that bear on each other.

    ``lag``: stiffness of a pair over that of the body between two pairs, r = k / k_body; 0 for one
    rigid piece. ``direct``: fraction phi of the load that the first pair takes without the body.
    ValueError unless the count is an integer of at least 0, the lag not negative, and the fraction
    from 0 to 1.
    """

    count: int
    lag: float
    direct: float = 0.0

    def __post_init__(self) -> None:
        require_whole(0, count=self.count)
        require_not_negative(lag=self.lag, direct=self.direct)
        if self.direct > 1.0:
            raise refused("direct", self.direct, "at most 1")

    @property
    def decay(self) -> float:
        """Decay kappa of the forces from pair to pair: 2 cosh kappa = 2 + r."""
        return math.acosh(1.0 + self.lag / 2.0)

    @property
    def working(self) -> float:
        """Locks that work when the first fails: V / T0 of a brittle joint, at most ``count``."""
        if self.count == 0:
            return 0.0
        kappa, others = self.decay, self.count - 1
        # sinh((P - 1) kappa) / sinh(P kappa), written so that neither overflows.
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
        """`working` of a very long row; inf if neither the body nor the load sets a limit."""
        first = 1.0 - (1.0 - self.direct) * math.exp(-self.decay)  # fraction of the load
        return 1.0 / first if first > 0.0 else math.inf

    @property
    def transfer_length(self) -> float:
        """Number of pairs over which their forces decay to 1/2.718."""
        return 1.0 / self.decay if self.decay > 0.0 else math.inf


def bearing_pairs(joint: Joint, push: Push = Push.PLUS_Y) -> int:
    """Number of pairs of locks that bear: lower locks that an upper lock pushes against."""
    order = range(1, joint.locks + 1) if push is Push.PLUS_Y else range(joint.locks, 0, -1)
    upper = [joint.is_upper(lock) for lock in order]
    return sum(here and not after for here, after in pairwise(upper))


def pairs_of(joint: Joint, push: Push = Push.PLUS_Y, share: LoadShare = LoadShare.FACE) -> Pairs:
    """The closed form of ``joint``, for equal locks and rigid pieces.

    k = 1 / (2 / (Ks a b) + 1 / (Kd a h)): a root, the dry face and a root in series. The body
    between two pairs has two cuts, Kn a H / 2; one rigid piece has none. ValueError unless these
    stiffnesses are finite and above 0.
    """
    inner, dry = joint.material_of(Kind.INNER), joint.material_of(Kind.DRY)
    root = inner.shear_stiffness * joint.a * joint.b
    contact = dry.normal_stiffness * joint.a * joint.h
    require_positive(**{"Ks a b": root, "Kd a h": contact})
    pair = 1.0 / (2.0 / root + 1.0 / contact)
    one_piece = joint.upper_body is UpperBody.MONOLITHIC
    lag = 0.0 if one_piece else 2.0 * pair / (inner.normal_stiffness * joint.a * joint.H)
    first = joint.is_upper(1 if push is Push.PLUS_Y else joint.locks)
    on_lock = joint.h / (joint.h + joint.H) if first and share is LoadShare.FACE else 0.0
    return Pairs(bearing_pairs(joint, push), lag, on_lock * pair / root)
