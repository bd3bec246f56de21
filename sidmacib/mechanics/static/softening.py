r"""Softening bonds, between brittle and ductile.

Once a node reaches its strength its stress falls linearly with its displacement, so that its total
work per unit of area is the material's fracture energy G; it does not fall below the residual
fraction r of the strength. Unloading leads back to the origin. With the displacement over that at
which a whole bond reaches its strength, m, and the one at which softening ends, R, the fraction of
the stiffness that is left is, for m > 1,

.. math::

    D = \frac{1}{m} \max\left( 1 - \frac{m - 1}{R - 1},\ r \right), \qquad
    R = \max\left( 1,\ \frac{2\, G K}{\tau^2} \right)

in shear (K_s, the cohesion tau_k) and in tension (K_n, the tensile strength sigma), whichever is
less; D never grows. If G is at most the energy stored elastically at failure, R = 1, the stress
falls at once, as in a brittle bond. With r = 1 it does not fall, as in a ductile one.
"""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.solution import Equilibrium, Solver
from sidmacib.quantities import four_digits

GONE = 1e-5  # a smaller fraction of a bond's stiffness counts as 0
SOFTENING_ROUNDS = 300  # in which the stiffness of the bonds must converge at a load
SOFTENING_SETTLED = 1e-4  # relative change of a bond's stiffness in the last round


@dataclass(frozen=True)
class Softening:
    """The numbers of softening in shear and in tension, all of shape (N,).

    ``shear_reach``, ``tension_reach``: displacement at which softening ends, over the one at which
    the strength is reached. ``residual``: the fraction of the strength that remains.
    """

    shear_reach: Floats
    tension_reach: Floats
    residual: Floats

    @classmethod
    def of(cls, assembly: Assembly) -> "Softening":
        """The softening of every node of ``assembly``."""

        def reach(energy: float, stiffness: float, strength: float) -> float:
            return max(1.0, 2.0 * energy * stiffness / strength**2) if strength else 1.0

        per_face = np.array(
            [
                (
                    reach(m.fracture_energy, m.shear_stiffness, m.cohesion),
                    reach(m.fracture_energy, m.normal_stiffness, m.tensile_strength),
                    1.0 if assembly.failure is Failure.DUCTILE else m.residual,
                )
                for m in (face.material for face in assembly.faces)
            ]
        )
        return cls(*np.ascontiguousarray(per_face[assembly.nodes.face].T))

    def left(self, contact_law: ContactLaw, state: NodeState, force: Floats) -> Floats:
        """The fraction of each bond's stiffness that is left under ``force`` (N), (N, 3); (N,).

        It never grows.
        """
        undamaged = replace(state, whole=np.where(state.whole > 0.0, 1.0, 0.0))
        by_shear = utilisation(contact_law, undamaged, force * [0.0, 1.0, 1.0])
        by_tension = utilisation(contact_law, undamaged, force * [1.0, 0.0, 0.0])
        left = state.whole.copy()
        for used, reach in ((by_shear, self.shear_reach), (by_tension, self.tension_reach)):
            # Displacement over the one at which the whole bond reaches its strength.
            moved = np.divide(used, state.whole, out=np.zeros_like(used), where=state.whole > 0.0)
            over = moved > 1.0
            rest = np.maximum(reach - 1.0, 1e-300)
            falls = np.where(reach > 1.0, 1.0 - (moved - 1.0) / rest, 0.0)
            carried = np.maximum(falls, self.residual)
            share = np.divide(carried, moved, out=np.ones_like(moved), where=over)
            left = np.where(over, np.minimum(left, share), left)
        return np.where(left < GONE * (self.residual == 0.0), 0.0, left)


def softened_equilibrium(
    solver: Solver, softening: Softening, load: float, guess: Floats, state: NodeState
) -> Equilibrium:
    """The equilibrium at ``load`` (N) with bonds softened as far as they are at this load.

    Raises `NoEquilibriumError` if there is none, or if softening does not converge.
    """
    for _ in range(SOFTENING_ROUNDS):
        point = solver.solve(load, guess, state)
        left = softening.left(solver.contact_law, state, point.force)
        if np.all(state.whole - left <= SOFTENING_SETTLED * state.whole):
            return point
        state, guess = replace(state, whole=left), point.unknowns
    raise NoEquilibriumError(f"bonds keep softening at {four_digits(load)} N")
