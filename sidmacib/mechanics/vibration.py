"""The unbroken assembly as springs and masses: its natural frequencies and its compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the assembly can only have failed.
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
    inertia = [piece.inertia.max() / assembly.length**2 for piece in free]  # kg, as rotations in m
    mass = np.concatenate(
        [[piece.mass] * 3 + [turned] * 3 for piece, turned in zip(free, inertia, strict=True)]
    )
    root = np.sqrt(mass)
    stiffness = Springs.of(assembly).elastic_stiffness() / root / root[:, None]
    return np.sqrt(np.linalg.eigvalsh(stiffness))


def compliance(assembly: Assembly, loads: Loads) -> float:
    """Displacement that ``loads`` work on, per unit of load, in m/N, with every node closed."""
    springs = Springs.of(assembly)
    force = loads.variable.ravel()[free_rows(assembly)] / springs.units
    return float(np.sum(force * np.linalg.solve(springs.elastic_stiffness(), force)))
