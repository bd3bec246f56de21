"""The unbroken joint as springs and masses: its natural frequencies and its compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the joint can only have failed.
"""

import numpy as np
from scipy.linalg import eigh

from sidmacib.contact_law import NodeLaw
from sidmacib.discretisation import Discretisation, Floats
from sidmacib.equilibrium import equilibrium_matrix, free_rows, permanent_and_reference
from sidmacib.loading import PieceLoad


def natural_frequencies(model: Discretisation) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece is a rigid body with its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in model.pieces if not piece.fixed]
    mass = np.concatenate([[p.mass] * 3 + [p.inertia.max()] * 3 for p in free])
    return np.sqrt(eigh(_stiffness(model), np.diag(mass), eigvals_only=True))


def compliance(model: Discretisation, loads: tuple[PieceLoad, ...]) -> float:
    """Displacement that ``loads`` work on, per unit of load, in m/N, with every node closed."""
    force = permanent_and_reference(model, loads)[1][free_rows(model)]
    return float(force @ np.linalg.solve(_stiffness(model), force))


def _stiffness(model: Discretisation) -> Floats:
    """Stiffness of the free pieces, (6 F, 6 F): every node a spring, K per area times its area."""
    compatibility = equilibrium_matrix(model)[free_rows(model)]
    law = NodeLaw.of(model)
    springs = np.column_stack([law.normal_stiffness, law.shear_stiffness, law.shear_stiffness])
    return np.asarray((compatibility * springs.ravel()) @ compatibility.T)
