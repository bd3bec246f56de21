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
from sidmacib.mechanics.newton import (
    QUICK,
    Matrix,
    Structure,
    newton,
    node_forces,
    solve_linear,
    tangent_stiffness,
    unbalanced,
)

ROUNDS = 30  # of friction limits, at most
SHARES = (1 / 16, 4.0)  # least and largest fraction of the way to the new limits
IN_A_ROW = 6  # rounds without equilibrium that end the search
STEPS = 60  # of Newton's method in a round
TRIALS = 40  # places along a step, at most
ENOUGH = 0.5  # slope over that at the start of a step: the line search ends below it
RESISTED = 0.99  # slope over that at the start: above it nothing resists, and the step is extended
LONGER = 10.0  # by this factor
NEAREST = 0.02  # distance of the next trial to either end of the bracket, over its length
ROUNDING = 1e-14  # unbalanced force over stiffest face times displacement: rounding error
MOST_ROUNDING = 100.0  # over the tolerance: its upper bound, as pieces may move away
FRICTION, GIVEN = 2, 3  # columns of `Structure.nodes`


@dataclass(frozen=True)
class EquilibriumSearch:
    """The problem whose equilibrium is sought, see `sidmacib.mechanics.newton.newton`.

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

    def allowed_at(self, unknowns: Floats) -> float:
        """Norm of unbalanced forces (N) that counts as zero, rounding included."""
        inside = self.stiffness * float(np.abs(unknowns).max())
        return min(max(self.allowed, ROUNDING * inside), MOST_ROUNDING * self.allowed)

    def equilibrium_from(self, unknowns: Floats) -> Floats | None:
        """Equilibrium by Newton's method, None if it is not found from ``unknowns``."""
        limits = self.floor, self.allowed_at(unknowns), self.farthest
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
            onward = _product(change, last) > 0.0
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
    residual, begin = np.empty_like(unknowns), unknowns

    def far(place: Floats) -> bool:
        return not float(np.abs(place - begin).max()) <= problem.farthest  # true for NaN as well

    def force_at(place: Floats) -> float:
        return float(
            unbalanced(structure, problem.slip, problem.whole, place, problem.target, residual)
        )

    size = force_at(unknowns)
    for _ in range(STEPS):
        if far(unknowns):
            break
        if size <= problem.allowed_at(unknowns):
            return unknowns, True
        tangent_stiffness(
            structure, problem.slip, problem.whole, unknowns, problem.floor, problem.matrix
        )
        step = residual.copy()
        if not solve_linear(structure, problem.matrix, step):
            break
        search = _Search(_product(residual, step))
        while True:
            trial = unknowns + search.part * step
            size = force_at(trial)
            slope = _product(residual, step)
            if search.ends(slope):
                break
            if slope > 0.0 and far(trial):
                break
        unknowns = trial
    return unknowns, False


class _Search:
    """Line search for a point of a step at which the slope of the energy is small enough.

    The slope decreases along the step, from ``start`` on. False position in the Illinois variant,
    which halves the slope at an end that stays; a longer step where nothing resists.
    """

    def __init__(self, start: float) -> None:
        self.start, self.part, self.tried = start, 1.0, 0
        self.low, self.low_slope = 0.0, start
        self.high, self.high_slope = math.inf, 0.0

    def ends(self, slope: float) -> bool:
        """Whether ``slope`` at ``part`` of the step is small enough; if not, ``part`` moves on."""
        self.tried += 1
        falls, steep = slope > 0.0, abs(slope)
        if steep <= ENOUGH * self.start or self.tried == TRIALS or not math.isfinite(slope):
            return True
        if falls and math.isinf(self.high):
            if slope < RESISTED * self.start and self.part == 1.0:
                return True  # a plain step
            self.low, self.low_slope, self.part = self.part, slope, LONGER * self.part
            return False
        if falls:
            self.low, self.low_slope, self.high_slope = self.part, slope, self.high_slope / 2.0
        else:
            self.low_slope /= 1.0 if math.isinf(self.high) else 2.0
            self.high, self.high_slope = self.part, slope
        share = self.low_slope / (self.low_slope - self.high_slope)
        share = min(max(share, NEAREST), 1.0 - NEAREST)
        self.part = self.low + (self.high - self.low) * share
        return False


def _product(one: Floats, other: Floats) -> float:
    """Inner product, the same on every processor."""
    return math.fsum((one * other).tolist())
