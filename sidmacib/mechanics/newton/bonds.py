"""How far bonds are used: shear and tension over strength."""

# mypy: allow-untyped-defs

import math

import numpy as np

from sidmacib.mechanics.newton.compilation import compiled


@compiled
def utilisations(shear_strength, tensile_strength, friction, whole, force, rounding):
    """See `sidmacib.mechanics.utilisation.utilisation`; ``rounding``: of the largest force."""
    used, noise = np.zeros(len(force)), np.nan
    for node in range(len(force)):
        if whole[node] > 0.0:
            normal, along, across = force[node, 0], force[node, 1], force[node, 2]
            # Unlike a root of squares, the same to the last digit as that of numpy.
            shear = math.hypot(along, across) - friction[node] * normal
            strengths = shear_strength[node], tensile_strength[node]
            if np.isnan(noise) and min(strengths) <= 0.0:
                noise = rounding * np.abs(force).max()
            by_shear = over(shear, strengths[0], noise)
            by_tension = over(-normal, strengths[1], noise)
            used[node] = max(by_shear, by_tension, 0.0)
    return used


@compiled
def over(part, strength, noise):
    """A ``part`` of a node's force over its strength; without strength infinite above ``noise``."""
    if strength > 0.0:
        return part / strength
    return np.inf if part > noise else 0.0
