"""The static brittle model."""

from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static.model import static_peak
from sidmacib.mechanics.static.peak_spread import static_capacity
from sidmacib.problem import Problem
from workflow.outcome import Outcome, State


def solve(problem: Problem) -> Outcome:
    """The equilibria on the way to the capacity, which is the first failure where peaks spread.

    `sidmacib.errors.CapacityError` if there is none.
    """
    return solve_with_path(problem)[0]


def solve_with_path(
    problem: Problem, *, spread: bool = True
) -> tuple[Outcome, tuple[Equilibrium, ...]]:
    """The outcome of `solve`, or of `solve_once` without ``spread``, and the equilibria.

    Raises the same errors.
    """
    if not spread:
        once = static_peak(*problem)
        return _outcome(once, once.path, None), once.path
    found = static_capacity(*problem)
    return _outcome(found.solution, found.path, found.spread), found.path


def solve_once(problem: Problem) -> Outcome:
    """The equilibria on the way to the peak, whose spread is not asked; raises as `solve` does."""
    return solve_with_path(problem, spread=False)[0]


def _outcome(
    solution: StaticSolution, path: tuple[Equilibrium, ...], spread: float | None
) -> Outcome:
    states = tuple(State(float(p.load), p.displacement, p.force, p.state.bonded) for p in path)
    return Outcome(
        states, solution.failed_load, solution.first_failure_load, str(solution.mode), spread
    )
