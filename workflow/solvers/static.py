"""The static brittle model."""

from sidmacib.answers.joint import on_given_cells
from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem
from workflow.outcome import Outcome, State


def solve(problem: Problem) -> Outcome:
    """The equilibria on the way to the capacity, which is the first failure where peaks spread.

    `sidmacib.errors.CapacityError` if there is none.
    """
    found = on_given_cells(problem)
    return _outcome(found.solution, found.path, found.spread)


def solve_once(problem: Problem) -> Outcome:
    """The equilibria on the way to the peak, whose spread is not asked; raises as `solve` does."""
    once = static_peak(*problem)
    return _outcome(once, once.path, None)


def _outcome(
    solution: StaticSolution, path: tuple[Equilibrium, ...], spread: float | None
) -> Outcome:
    states = tuple(State(float(p.load), p.displacement, p.force, p.state.bonded) for p in path)
    return Outcome(
        states,
        solution.failed_load,
        solution.first_failure_load,
        str(solution.mode),
        spread,
        float(solution.peak.load),
    )
