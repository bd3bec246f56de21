"""Equilibrium of rigid pieces where Newton's method gives up: rounds of given friction limits.

Friction that changes direction, and nodes that open and close, can make Newton's method cycle
although there is an equilibrium. If the friction limit of each node is given and does not depend on
its normal force, equilibrium is the minimum of a convex energy, and Newton's method with a line
search finds it wherever there is one. The limits of the next round follow from the normal forces of
the last one. In each round Newton's method on the full problem tries to finish: its equilibrium
obeys the same contact law as any other.

If the pieces are not held even by limits that are never reached, there is no equilibrium. The
search also ends if the limits of some rounds in a row do not hold them: the pieces move away.
"""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.newton.elimination import Matrix
from sidmacib.mechanics.newton.equilibrium import (
    QUICK,
    allowed_at,
    least_energy,
    newton,
    node_forces,
    product,
)
from sidmacib.mechanics.newton.faces import FRICTION, GIVEN, Structure

ROUNDS = 30  # of friction limits, at most
SHARES = (1 / 16, 4.0)  # least and largest fraction of the way to the new limits
IN_A_ROW = 6  # rounds without equilibrium that end the search


@dataclass(frozen=True)
class EquilibriumSearch:
    """The problem whose equilibrium is sought, see `sidmacib.mechanics.newton.equilibrium.newton`.

    ``target`` (U,) in N; ``slip`` (N, 2) in m and ``whole`` (N,) of the nodes; ``stiffness`` of the
    stiffest face and ``floor`` in N/m; ``allowed``: norm of unbalanced forces, N; ``farthest``: a
    piece that moves further in one round (m) moves away.
    """

    structure: Structure
    matrix: Matrix
    target: Floats
    slip: Floats
    whole: Floats
    stiffness: float
    floor: float
    allowed: float
    farthest: float

    def limits(self, unknowns: Floats) -> Floats:
        """Friction limit (N) of each node by its normal force at ``unknowns``, (N,)."""
        force, _ = node_forces(self.structure, self.slip, self.whole, unknowns)
        pressed = np.where(self.whole > 0.0, 0.0, np.maximum(force[:, 0], 0.0))
        return np.asarray(self.structure.nodes[:, FRICTION] * pressed)

    def never_reached(self) -> Floats:
        """Limits (N) that friction never reaches; 0 at nodes without friction, (N,)."""
        rough = (self.whole == 0.0) & (self.structure.nodes[:, FRICTION] > 0.0)
        return np.where(rough, math.inf, 0.0)

    def equilibrium_from(self, unknowns: Floats) -> Floats | None:
        """Equilibrium by Newton's method, None if it is not found from ``unknowns``."""
        allowed = allowed_at(unknowns, self.stiffness, self.allowed)
        limits = self.floor, allowed, self.farthest
        converged, solution = newton(
            self.structure, self.matrix, self.target, unknowns, self.slip, self.whole, limits, QUICK
        )
        return solution if converged else None


def by_rounds(problem: EquilibriumSearch, guess: Floats) -> Floats | None:
    """Unknowns (U,) of an equilibrium, from a ``guess``; None if none is found.

    The first rounds start with the limits of the guess, to find an equilibrium nearby; if they
    fail, other rounds start with limits that are never reached.
    """
    stuck, holds = _given_limits(problem, guess, problem.never_reached())
    if not holds:
        return None
    solution = _rounds(problem, guess, problem.limits(guess))
    if solution is None:
        solution = problem.equilibrium_from(stuck)
    return _rounds(problem, stuck, problem.limits(stuck)) if solution is None else solution


def _rounds(problem: EquilibriumSearch, unknowns: Floats, limits: Floats) -> Floats | None:
    """Rounds from ``unknowns``, the first of them with ``limits`` (N); see `by_rounds`."""
    lost, share, last = 0, 1.0, np.zeros_like(limits)  # rounds without equilibrium, in a row
    for number in range(ROUNDS):
        unknowns, holds = _given_limits(problem, unknowns, limits)
        solution = problem.equilibrium_from(unknowns)
        if solution is not None:
            return solution
        lost = 0 if holds else lost + 1
        if lost == IN_A_ROW:
            return None
        change = problem.limits(unknowns) - limits
        if number:  # longer steps while the limits change the same way, shorter ones after a turn
            onward = product(change, last) > 0.0
            share = min(2.0 * share, SHARES[1]) if onward else max(share / 2.0, SHARES[0])
        limits, last = np.maximum(limits + share * change, 0.0), change
    return None


def _given_limits(
    problem: EquilibriumSearch, unknowns: Floats, limits: Floats
) -> tuple[Floats, bool]:
    """The minimum of the energy with friction ``limits`` (N), (N,), and whether it was found.

    It is not found if the loads push pieces away; these are then some way off.
    """
    nodes = problem.structure.nodes.copy()
    nodes[:, FRICTION], nodes[:, GIVEN] = 0.0, limits
    structure = problem.structure._replace(nodes=nodes)
    accuracy = problem.stiffness, problem.floor, problem.allowed, problem.farthest
    found, minimum = least_energy(
        structure,
        problem.matrix,
        problem.target,
        unknowns,
        problem.slip,
        problem.whole,
        accuracy,
    )
    return minimum, found
