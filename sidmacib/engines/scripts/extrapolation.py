"""Predict the load at which the next bond fails, from the utilisation of the bonds."""

import math
from collections.abc import Sequence

AT_ONCE = 0.9  # of the way to a load at which something is expected: so far in one go
APART = 0.05  # of the load, between equilibria that give a slope
BEYOND = 0.01  # of a load at which something is expected: further on, nothing is any more
HALF = 0.5  # of such a load: a stop on the way, as displacements do not grow quite in proportion
STOPS = (HALF, AT_ONCE, 0.97, 0.99)  # of a load at which something is expected
STRIDE = 2.0  # over the tolerance, the increment near a load at which something is expected


def failure_ahead(used: Sequence[tuple[float, float]], otherwise: float) -> float:
    """The load (N) at which the most used bond will reach its strength, if all stays linear.

    ``used``: loads (N) and largest utilisations of the last equilibria; ``otherwise`` where they
    give no slope, which is taken over some distance, as every equilibrium is still a bit off.
    """
    load, most = used[-1]
    far = [(0.0, 0.0), *(point for point in used[:-1] if point[0] <= (1.0 - APART) * load)]
    before, less = far[-1]
    if not (load > before and less < most < math.inf):
        return otherwise
    return load + (1.0 - most) * (load - before) / (most - less)
