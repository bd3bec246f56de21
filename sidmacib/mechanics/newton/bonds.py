"""How far bonds are used: shear and tension over strength."""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.newton.compilation import compiled


@compiled
def utilisations(shear_strength, tensile_strength, friction, whole, force, rounding):
    """See `sidmacib.mechanics.utilisation.utilisation`; ``rounding``: of the largest force.

    ``force``: (3, N).
    """
    without = 0
    for n in range(len(whole)):
        without += (shear_strength[n] <= 0.0) | (tensile_strength[n] <= 0.0)
    noise = rounding * np.abs(force).max() if without else 0.0
    used, normal, along, across = np.empty_like(whole), force[0], force[1], force[2]
    for n in range(len(whole)):
        shear = np.sqrt(along[n] * along[n] + across[n] * across[n]) - friction[n] * normal[n]
        by_shear = over(shear, shear_strength[n], noise)
        by_tension = over(-normal[n], tensile_strength[n], noise)
        most = by_shear if by_shear > by_tension else by_tension
        used[n] = most if whole[n] > 0.0 and most > 0.0 else 0.0
    return used


@compiled
def over(part, strength, noise):
    """A ``part`` of a node's force over its strength; without strength infinite above ``noise``."""
    without = np.inf if part > noise else 0.0
    return part / strength if strength > 0.0 else without
