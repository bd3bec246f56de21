"""The lowest peak of an assembly whose bonds are brittle, and the path behind a peak.

Friction may leave more than one equilibrium under the same load. After the first failure nodes fail
one after the other, and which of the equilibria is found on the way decides where the path ends.
The first failure does not depend on it. So the path beyond it is sought again from other places:
every search for an equilibrium starts near its usual guess, not at it. All these equilibria obey
the same laws, so the lowest of the peaks is the capacity. It is stable where a single path is not,
which may jump from one peak to another if the last digits of the input change.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
from scipy.optimize import brentq

from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats
from sidmacib.mechanics.contact_law import Flags, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.solution import (
    LEAST_INCREMENT,
    Equilibrium,
    OtherSearches,
    Solver,
    StaticSolution,
)
from sidmacib.mechanics.static import another_peak, peak_of, solver_of, static_peak

# Largest change of an unknown where a search starts, over the largest unknown. Taken in turn: the
# first finds more equilibria, the second some that the first steps over.
OFF = 1e-3, 1e-4
STARTS = 10  # in a row without a lower peak end the search
LOWER = 1e-3  # over the lowest peak: one that is lower by more is a lower peak
MOST = 500  # searches for an equilibrium: more end the search for the lowest peak
# The same for elastic pieces, where one takes a thousand times as long: over the equilibria on the
# first path. Those behind the first failure cost most, so that this is about the cost of that path.
MOST_ELASTIC = 1
DIGITS = 4  # of a spread after the decimal point: peaks are known to 1e-5
AT_STRENGTH = 1e-2  # nodes whose utilisations differ by less fail together
PRECISION = 1e-4  # of the loads, over the peak
LEAST_LOAD_LEFT = 0.02  # of the peak: less counts as nothing
HIGHEST = 1.5  # of the peak: the bonds that are left never carry more than whole ones do


class FromElsewhere(OtherSearches):
    """A ``solver`` whose searches start at random places near those that are asked for.

    If there is no equilibrium from there, the search starts where it was asked to, as a bad start
    must not end a path. ``number``: of searches.
    """

    def __init__(self, solver: Solver, seed: int) -> None:
        super().__init__(solver)
        self.off = OFF[seed % len(OFF)]
        self.random = np.random.default_rng(seed)
        self.number = 0

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), see `sidmacib.mechanics.solution.Solver`."""
        self.number += 1
        off = self.off * np.abs(guess).max() * self.random.uniform(-1.0, 1.0, len(guess))
        try:
            return self.solver.solve(load, guess + off, state)
        except NoEquilibriumError:
            return self.solver.solve(load, guess, state, thorough=thorough)


def lowest_peak(assembly: Assembly, loads: Loads) -> StaticSolution:
    """Raise ``loads`` from 0 to the lowest peak of ``assembly`` that is found, with its spread.

    The search ends after `STARTS` starts without a lower peak, or when it has cost too much, see
    `MOST`. There is none if the peak is the first failure, or bonds are not brittle, where no other
    peak was ever found. Errors of `sidmacib.mechanics.static.static_peak`.
    """
    if assembly.failure is not Failure.BRITTLE:
        return static_peak(assembly, loads)
    solver = solver_of(assembly, loads)
    first = peak_of(solver)
    if first.peak.load <= first.first_failure_load * (1.0 + 2.0 * LEAST_INCREMENT):
        return first
    most = MOST_ELASTIC * len(first.path) if assembly.elastic else MOST
    return _lowest(solver, first, most)


def _lowest(solver: Solver, first: StaticSolution, most: int) -> StaticSolution:
    """The lowest of the peaks; ``most``: searches for an equilibrium that end the search for it."""
    lowest, highest = first, first.peak.load
    seed, last_lower = 0, -1
    while seed - last_lower <= STARTS and most > 0:
        searches = FromElsewhere(solver, seed)
        try:
            other = another_peak(solver, searches, first)
        except CapacityError:
            other = first  # no peak from this start
        if other.peak.load < lowest.peak.load * (1.0 - LOWER):
            lowest, last_lower = other, seed
        highest = max(highest, other.peak.load)
        most -= searches.number
        seed += 1
    return replace(lowest, spread=round(float(highest / lowest.peak.load) - 1.0, DIGITS))


def after_peak(assembly: Assembly, loads: Loads, peak: Equilibrium) -> Iterator[Equilibrium]:
    """The points behind ``peak``, until a failure leaves less than `LEAST_LOAD_LEFT` of it.

    Under a load that stays, a joint at its peak fails as a whole. Here the load goes down, or up,
    to the one at which the next node reaches its strength, once the nodes before it have lost
    theirs. Each such point is an equilibrium, reached from no load with the bonds that are left, as
    in sequentially linear analysis (Rots, J.G., 2001, Heron 46(2), 69-90). The displacement may
    decrease from one point to the next: a test that holds the displacement would jump over such
    points. Friction has no history here.

    ``assembly``: with brittle bonds; others give nothing. ``peak``: of its path under ``loads``.
    Every point has at least one bonded node less than the one before.
    """
    if assembly.failure is not Failure.BRITTLE:
        return
    solver = solver_of(assembly, loads)
    start = solver.start()
    bonded = peak.state.bonded & ~_failing(solver, peak)
    while bonded.any():
        state = replace(start.state, whole=np.where(bonded, start.state.whole, 0.0))
        point = _next_failure(solver, start, state, peak.load)
        if point is None or point.load < LEAST_LOAD_LEFT * peak.load:
            return
        yield point
        bonded &= ~_failing(solver, point)


def _failing(solver: Solver, point: Equilibrium) -> Flags:
    """The bonded nodes that reach their strength at ``point``."""
    used = np.where(
        point.state.bonded, utilisation(solver.contact_law, point.state, point.force), 0
    )
    return np.asarray(used >= used.max() * (1.0 - AT_STRENGTH))


def _next_failure(
    solver: Solver, start: Equilibrium, state: NodeState, peak: float
) -> Equilibrium | None:
    """The equilibrium at the load at which a bond reaches its strength; None if there is none."""

    @cache
    def at(load: float) -> Equilibrium:
        return solver.solve(load, start.unknowns, state, thorough=True)

    def excess(load: float) -> float:
        return float(utilisation(solver.contact_law, state, at(load).force).max()) - 1.0

    low, high = LEAST_LOAD_LEFT * peak / 2.0, peak
    try:
        if excess(low) >= 0.0:
            return None
        while excess(high) <= 0.0:
            if high >= HIGHEST * peak:
                return None
            high *= 1.1
        return at(float(brentq(excess, low, high, xtol=PRECISION * peak)))
    except CapacityError:
        return None
