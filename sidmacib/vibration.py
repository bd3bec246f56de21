"""The unbroken joint as springs and masses: its natural frequencies and its compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the joint can only have failed.
"""

import numpy as np
from scipy.linalg import eigh

from sidmacib.discretisation import Discretisation, Floats
from sidmacib.equilibrium import free_rows, permanent_and_reference
from sidmacib.loading import PieceLoad
from sidmacib.springs import Springs


def natural_frequencies(model: Discretisation) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece is a rigid body with its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in model.pieces if not piece.fixed]
    mass = np.concatenate([[p.mass] * 3 + [p.inertia.max()] * 3 for p in free])
    return np.sqrt(eigh(Springs.of(model).elastic_stiffness(), np.diag(mass), eigvals_only=True))


def compliance(model: Discretisation, loads: tuple[PieceLoad, ...]) -> float:
    """Displacement that ``loads`` work on, per unit of load, in m/N, with every node closed."""
    force = permanent_and_reference(model, loads)[1][free_rows(model)]
    return float(force @ np.linalg.solve(Springs.of(model).elastic_stiffness(), force))
