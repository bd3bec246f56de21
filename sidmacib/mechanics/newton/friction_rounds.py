"""Equilibrium of rigid pieces where Newton's method gives up: rounds of given friction limits.

Friction that changes direction, and nodes that open and close, can make Newton's method cycle
although there is an equilibrium. If the friction limit of each node is given and does not depend on
its normal force, equilibrium is the minimum of a convex energy, and Newton's method with a line
search finds it wherever there is one. The limits of the next round follow from the normal forces of
the last one. In each round Newton's method on the full problem tries to finish: its equilibrium
obeys the same contact law as any other.

If the pieces are not held even by limits that are never reached, there is no equilibrium. The
search also ends if the limits of some rounds in a row do not hold them: the pieces move away.

Of pieces that bonds keep near; see `sidmacib.mechanics.newton.drift` for others.
"""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law.kernels import FRICTION, GIVEN
from sidmacib.mechanics.newton import LOST, QUICK, newton, put_at
from sidmacib.mechanics.newton.faces import Applied, ContactFaces, Point
from sidmacib.mechanics.newton.least_energy import allowed_at, least_energy, product
from sidmacib.mechanics.newton.linear import Matrix

FRICTION_ROUNDS = 300  # of friction limits, at most
LIMIT_SHARES = (1 / 16, 4.0)  # least and largest fraction of the way to the new limits
IN_A_ROW = 6  # rounds without equilibrium that end the search


@dataclass(frozen=True)
class EquilibriumSearch:
    """The problem whose equilibrium is sought, see `sidmacib.mechanics.newton.newton`.

    ``target``: the loads; ``slip`` (2, N) in m and ``whole`` (N,) of the nodes; ``stiffness`` of
    the stiffest face and ``floor`` in N/m; ``allowed``: norm of unbalanced forces, N;
    ``farthest``: a piece that moves further in one round (m) moves away.
    """

    contacts: ContactFaces
    matrix: Matrix
    here: Point
    target: Applied
    slip: Floats
    whole: Floats
    stiffness: float
    floor: float
    allowed: float
    farthest: float

    @property
    def limits(self) -> Floats:
        """Friction limit (N) of each node by its normal force ``here``, (N,)."""
        normal = np.where(self.whole > 0.0, 0.0, np.maximum(self.here.force[0], 0.0))
        return np.asarray(self.contacts.law[FRICTION] * normal)

    def equilibrium_from(self, unknowns: Floats) -> bool:
        """Move ``here`` to equilibrium by Newton's method from ``unknowns``; whether it did."""
        allowed = allowed_at(unknowns, self.stiffness, self.allowed)
        arrays = self.contacts, self.matrix, self.here
        nodes = self.target, unknowns, self.slip, self.whole
        return bool(newton(*arrays, *nodes, (self.floor, allowed, self.farthest), (*QUICK, LOST)))

    def with_given_limits(self, unknowns: Floats, limits: Floats) -> bool:
        """Move ``here`` to the minimum of the energy with friction ``limits`` (N), (N,).

        Returns whether it was found. It is not if the loads push pieces away; these are then some
        way off.
        """
        law = self.contacts.law.copy()
        law[FRICTION], law[GIVEN] = 0.0, limits
        arrays = self.contacts._replace(law=law), self.matrix, self.here
        at_nodes = self.target, unknowns, self.slip, self.whole
        accuracy = self.stiffness, self.floor, self.allowed, self.farthest
        return bool(least_energy(*arrays, *at_nodes, accuracy))


def by_rounds(problem: EquilibriumSearch, guess: Floats) -> bool:
    """Look for an equilibrium from a ``guess`` of the unknowns (U,); whether it was found.

    It is then ``problem.here``. The first rounds start with the limits of the guess, to find an
    equilibrium nearby; if they fail, other rounds start with limits that are never reached.
    """
    here = problem.here
    rubs = (problem.whole == 0.0) & (problem.contacts.law[FRICTION] > 0.0)
    never_reached = np.where(rubs, math.inf, 0.0)
    if not problem.with_given_limits(guess, never_reached):
        return False
    stuck, from_stuck = here.unknowns.copy(), problem.limits
    put_at(problem.contacts, problem.slip, problem.whole, problem.target, here, guess)
    return (
        _rounds(problem, guess, problem.limits)
        or problem.equilibrium_from(stuck)
        or _rounds(problem, stuck, from_stuck)
    )


def _rounds(problem: EquilibriumSearch, unknowns: Floats, limits: Floats) -> bool:
    """Rounds from ``unknowns``, the first of them with ``limits`` (N); see `by_rounds`."""
    lost, share, last = 0, 1.0, np.zeros_like(limits)  # rounds without equilibrium, in a row
    for number in range(FRICTION_ROUNDS):
        holds = problem.with_given_limits(unknowns, limits)
        unknowns, next_limits = problem.here.unknowns.copy(), problem.limits
        if problem.equilibrium_from(unknowns):
            return True
        lost = 0 if holds else lost + 1
        if lost == IN_A_ROW:
            return False
        change = next_limits - limits
        if number:  # longer steps while the limits change the same way, shorter ones after a turn
            onward = product(change, last) > 0.0
            share = (
                min(2.0 * share, LIMIT_SHARES[1]) if onward else max(share / 2.0, LIMIT_SHARES[0])
            )
        limits, last = np.maximum(limits + share * change, 0.0), change
    return False
