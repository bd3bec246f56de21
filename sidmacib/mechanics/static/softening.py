"""Inner faces between brittle and ductile: what is left of a bond once its strength was reached.

From its strength on, the stress of a node falls linearly with its displacement, so that all of its
work per unit of area is the material's fracture energy; it does not fall below the residual part
of the strength. Unloading goes back to the origin. What a node remembers is the part of its
stiffness that is left, which never grows.

With no more fracture energy than what is stored elastically at failure, tau^2 / (2 Ks), the stress
falls at once: brittle. With a residual part of 1 it does not fall: ductile.
"""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, utilisation
from sidmacib.mechanics.solution import Equilibrium, Solver

ROUNDS = 300  # in which what is left of the bonds must settle at a load
SETTLED = 1e-4  # last change of what is left of a bond, over it
GONE = 1e-5  # less than this is nothing


@dataclass(frozen=True)
class Softening:
    """How bonds of nodes fade, by shear and by tension; all of shape (N,).

    ``shear_reach``, ``tension_reach``: displacement at which nothing more is lost, over the one at
    which the strength is reached. ``residual``: the part of the strength that is kept.
    """

    shear_reach: Floats
    tension_reach: Floats
    residual: Floats

    @classmethod
    def of(cls, assembly: Assembly) -> "Softening":
        """That of every node of ``assembly``."""

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

    def left(self, law: ContactLaw, state: NodeState, force: Floats) -> Floats:
        """The part of each bond's stiffness that is left under ``force`` (N), (N, 3); shape (N,).

        It never grows.
        """
        every = replace(state, whole=np.where(state.whole > 0.0, 1.0, 0.0))
        by_shear = utilisation(law, every, force * [0.0, 1.0, 1.0])
        by_tension = utilisation(law, every, force * [1.0, 0.0, 0.0])
        found = state.whole.copy()
        for used, reach in ((by_shear, self.shear_reach), (by_tension, self.tension_reach)):
            # Displacement over that at which the strength of the whole bond is reached.
            moved = np.divide(used, state.whole, out=np.zeros_like(used), where=state.whole > 0.0)
            over = moved > 1.0
            rest = np.maximum(reach - 1.0, 1e-300)
            falls = np.where(reach > 1.0, 1.0 - (moved - 1.0) / rest, 0.0)
            carried = np.maximum(falls, self.residual)
            share = np.divide(carried, moved, out=np.ones_like(moved), where=over)
            found = np.where(over, np.minimum(found, share), found)
        return np.where(found < GONE * (self.residual == 0.0), 0.0, found)


def settled(
    solver: Solver, softening: Softening, load: float, guess: Floats, state: NodeState
) -> Equilibrium:
    """The equilibrium at ``load`` (N) once bonds have faded as far as they do at this load.

    Raises `NoEquilibriumError` if there is none, or if they go on to fade.
    """
    for _ in range(ROUNDS):
        found = solver.solve(load, guess, state)
        left = softening.left(solver.law, state, found.force)
        if np.all(state.whole - left <= SETTLED * state.whole):
            return found
        state, guess = replace(state, whole=left), found.unknowns
    raise NoEquilibriumError(f"bonds go on to fade at {load:g} N")
