"""The unbroken joint as springs and masses: its natural frequencies and its compliance.

They set the scales of an explicit computation: its time step, its loading rate, and the
displacement beyond which the joint can only have failed.
"""

import numpy as np
from scipy.linalg import eigh

from sidmacib.discretisation import Discretisation, Floats
from sidmacib.equilibrium import equilibrium_matrix
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
    wrench = np.zeros((len(model.pieces), 6))
    for load in loads:
        wrench[load.piece] += np.concatenate([load.force, load.moment])
    force = wrench.ravel()[_free_rows(model)]
    return float(force @ np.linalg.solve(_stiffness(model), force))


def _free_rows(model: Discretisation) -> np.ndarray:
    free = [i for i, piece in enumerate(model.pieces) if not piece.fixed]
    return np.concatenate([np.arange(6 * i, 6 * i + 6) for i in free])


def _stiffness(model: Discretisation) -> Floats:
    """Stiffness of the free pieces, (6 F, 6 F): every node a spring, K per area times its area."""
    compatibility = equilibrium_matrix(model)[_free_rows(model)]
    materials = [model.material(face.kind) for face in model.faces]
    per_area = np.array(
        [[m.normal_stiffness, m.shear_stiffness, m.shear_stiffness] for m in materials]
    )
    springs = (per_area[model.nodes.face] * model.nodes.area[:, None]).ravel()
    return np.asarray((compatibility * springs) @ compatibility.T)
