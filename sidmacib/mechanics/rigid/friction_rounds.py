"""Equilibrium of rigid pieces where Newton's method gives up: rounds of given friction limits.

Friction that changes side, and nodes that open and close, make Newton's method cycle where there is
an equilibrium. If each node's friction limit is given, whatever its normal force, equilibrium is
the minimum of a convex energy, and Newton's method with a search along each step arrives wherever
there is one. The limits of the next round follow from the normal forces of the last one, and in
each round Newton's method on both at once tries to do the rest: what it finds obeys the same law as
any other equilibrium.

Where limits that are never reached do not hold the pieces, nothing does. Where the limits of some
rounds in a row do not, the search ends too: pieces move off for good.
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
    settled,
    solve_linear,
    tangent_stiffness,
    unbalanced,
)

ROUNDS = 30  # of limits of friction
SHARES = (1 / 16, 4.0)  # of the way to the new limits, at least and at most; doubled or halved
IN_A_ROW = 6  # rounds without equilibrium that end the search
STEPS = 60  # of Newton's method in a round
CUTS = 40  # places on a step that are tried
ENOUGH = 0.5  # part of the slope at a step's begin: where the search along it ends
RESISTED = 0.99  # the same, where a step meets no resistance and is made longer,
LONGER = 10.0  # so many times
NEAREST = 0.02  # to an end of what is left of a step: next place, over what is left
ROUNDING = 1e-14  # unbalanced force, over the stiffest face's if pieces moved by as much alone,
MOST_ROUNDING = 100.0  # or over what is allowed else, if that is less: pieces may move off
FRICTION, GIVEN = 2, 3  # columns of `Structure.nodes`


@dataclass(frozen=True)
class Problem:
    """What is to be in equilibrium, see `sidmacib.mechanics.newton.newton`.

    ``target`` (U,) in N; ``slip`` (N, 2) in m and ``whole`` (N,) of the nodes; ``floor`` and
    ``stiffness``, of the stiffest face, in N/m; ``allowed``: norm of unbalanced forces, N;
    ``farthest``: how far pieces move in a round unless they move off, m.
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
        """What friction may reach at each node, by its normal force at ``unknowns``, (N,), N."""
        force, _ = settled(self.structure, self.slip, self.whole, unknowns)
        pressed = np.where(self.whole > 0.0, 0.0, np.maximum(force[:, 0], 0.0))
        return np.asarray(self.structure.nodes[:, FRICTION] * pressed)

    def never_reached(self) -> Floats:
        """Limits (N) that friction never reaches, where there is any, (N,)."""
        rough = (self.whole == 0.0) & (self.structure.nodes[:, FRICTION] > 0.0)
        return np.where(rough, math.inf, 0.0)

    def allowed_at(self, unknowns: Floats) -> float:
        """Norm of unbalanced forces (N) that counts as none, for what rounding makes of them."""
        inside = self.stiffness * float(np.abs(unknowns).max())
        return min(max(self.allowed, ROUNDING * inside), MOST_ROUNDING * self.allowed)

    def equilibrium_from(self, unknowns: Floats) -> Floats | None:
        """Equilibrium by Newton's method, None if it is not found from ``unknowns``."""
        limits = self.floor, self.allowed_at(unknowns), self.farthest
        found, there = newton(
            self.structure, self.matrix, self.target, unknowns, self.slip, self.whole, limits, QUICK
        )
        return there if found else None


def by_rounds(problem: Problem, guess: Floats) -> Floats | None:
    """Unknowns (U,) at which all is in equilibrium, from a ``guess``; None if none are found.

    Rounds begin with the limits of the guess, so that the equilibrium is one nearby if it can be,
    and then with limits that are never reached.
    """
    stuck, holds = _given_limits(problem, guess, problem.never_reached())
    if not holds:
        return None
    found = _rounds(problem, guess, problem.limits(guess))
    if found is None:
        found = problem.equilibrium_from(stuck)
    return _rounds(problem, stuck, problem.limits(stuck)) if found is None else found


def _rounds(problem: Problem, unknowns: Floats, limits: Floats) -> Floats | None:
    """`by_rounds`, where the first round has ``limits`` (N)."""
    lost, share, last = 0, 1.0, np.zeros_like(limits)  # rounds without equilibrium, in a row
    for number in range(ROUNDS):
        unknowns, holds = _given_limits(problem, unknowns, limits)
        found = problem.equilibrium_from(unknowns)
        if found is not None:
            return found
        lost = 0 if holds else lost + 1
        if lost == IN_A_ROW:
            return None
        change = problem.limits(unknowns) - limits
        if number:  # limits that go on to move the same way are far off, others are passed by
            onward = _product(change, last) > 0.0
            share = min(2.0 * share, SHARES[1]) if onward else max(share / 2.0, SHARES[0])
        limits, last = np.maximum(limits + share * change, 0.0), change
    return None


def _given_limits(problem: Problem, unknowns: Floats, limits: Floats) -> tuple[Floats, bool]:
    """Where the energy is least if friction reaches ``limits`` (N), (N,), and whether it is found.

    It is not where the loads push pieces off, which end some way on.
    """
    nodes = problem.structure.nodes.copy()
    nodes[:, FRICTION], nodes[:, GIVEN] = 0.0, limits
    structure = problem.structure._replace(nodes=nodes)
    residual, begin = np.empty_like(unknowns), unknowns

    def far(place: Floats) -> bool:
        return not float(np.abs(place - begin).max()) <= problem.farthest  # or no number

    def force_at(place: Floats) -> float:
        own = problem.slip, problem.whole, place, problem.target, residual
        return float(unbalanced(structure, *own))

    size = force_at(unknowns)
    for _ in range(STEPS):
        if far(unknowns):
            break
        if size <= problem.allowed_at(unknowns):
            return unknowns, True
        own = problem.slip, problem.whole, unknowns, problem.floor, problem.matrix
        tangent_stiffness(structure, *own)
        step = residual.copy()
        if not solve_linear(structure, problem.matrix, step):
            break
        search = _Search(_product(residual, step))
        while True:
            there = unknowns + search.part * step
            size = force_at(there)
            slope = _product(residual, step)
            if search.ends(slope):
                break
            if slope > 0.0 and far(there):
                break
        unknowns = there
    return unknowns, False


class _Search:
    """The search along a step for a place at which the energy's slope is small enough.

    The slope falls along the step, from ``start`` on: false position, with the slope of an end
    halved that stays (Illinois), and a longer step where nothing resists.
    """

    def __init__(self, start: float) -> None:
        self.start, self.part, self.tried = start, 1.0, 0
        self.low, self.low_slope = 0.0, start
        self.high, self.high_slope = math.inf, 0.0

    def ends(self, slope: float) -> bool:
        """Whether ``slope`` at ``part`` of the step is small enough; if not, ``part`` moves on."""
        self.tried += 1
        falls, steep = slope > 0.0, abs(slope)
        if steep <= ENOUGH * self.start or self.tried == CUTS or not math.isfinite(slope):
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
