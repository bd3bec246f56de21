"""How far bonds are used."""

# mypy: allow-untyped-defs

import math

import numpy as np

from sidmacib.mechanics.newton.compilation import compiled


@compiled
def utilisations(shear_strength, tensile_strength, friction, whole, force, rounding):
    """See `sidmacib.mechanics.utilisation.utilisation`; ``rounding``: of the largest force."""
    used, noise = np.zeros(len(force)), rounding * np.abs(force).max()
    for node in range(len(force)):
        if whole[node] > 0.0:
            normal, along, across = force[node]
            # Unlike a root of squares, the same to the last digit as that of numpy.
            shear = math.hypot(along, across) - friction[node] * normal
            by_shear = over(shear, shear_strength[node], noise)
            by_tension = over(-normal, tensile_strength[node], noise)
            used[node] = max(by_shear, by_tension, 0.0)
    return used


@compiled
def over(part, strength, noise):
    """A ``part`` of a node's force over its strength; without strength infinite above ``noise``."""
    if strength > 0.0:
        return part / strength
    return np.inf if part > noise else 0.0
