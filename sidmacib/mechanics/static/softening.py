"""Equilibria of bonds that soften, see `sidmacib.mechanics.contact_law.softening`."""

from dataclasses import replace

import numpy as np

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.contact_law.softening import Softening
from sidmacib.mechanics.solution import Equilibrium, Solver

SOFTENING_ROUNDS = 300  # in which the stiffness of the bonds must converge at a load
SOFTENING_SETTLED = 1e-4  # relative change of a bond's stiffness in the last round


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
    raise NoEquilibriumError(f"bonds keep softening at {load:g} N")
