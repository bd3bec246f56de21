"""The static brittle model."""

from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.problem import Outcome, Problem, State


def solve(problem: Problem) -> Outcome:
    """The equilibria on the way to the lowest peak; `sidmacib.errors.CapacityError` if none."""
    found = lowest_peak(*problem)
    return _outcome(found, found.spread)


def solve_once(problem: Problem) -> Outcome:
    """The equilibria on the way to a peak; no lower one is sought. Raises as `solve` does."""
    return _outcome(static_peak(*problem), None)


def _outcome(solution: StaticSolution, spread: float | None) -> Outcome:
    states = tuple(
        State(float(p.load), p.displacement, p.force, p.state.bonded) for p in solution.path
    )
    return Outcome(
        states,
        solution.failed_load,
        solution.first_failure_load,
        str(solution.mode),
        spread,
        float(solution.peak.load),
    )
