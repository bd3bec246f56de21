"""The unbroken joint as springs and masses: its natural frequencies and its compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the joint can only have failed.
"""

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.springs import Springs


def natural_frequencies(assembly: Assembly) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece is a rigid body with its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in assembly.pieces if not piece.fixed]
    root = np.sqrt(np.concatenate([[p.mass] * 3 + [p.inertia.max()] * 3 for p in free]))
    stiffness = Springs.of(assembly).elastic_stiffness()
    return np.sqrt(np.linalg.eigvalsh(stiffness / np.outer(root, root)))


def compliance(assembly: Assembly, loads: Loads) -> float:
    """Displacement that ``loads`` work on, per unit of load, in m/N, with every node closed."""
    force = loads.variable.ravel()[free_rows(assembly)]
    return float(force @ np.linalg.solve(Springs.of(assembly).elastic_stiffness(), force))
