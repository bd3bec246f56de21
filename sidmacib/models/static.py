"""The static brittle model."""

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.equilibrium import placed
from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.problem import Outcome, Problem, State


def solve(problem: Problem) -> Outcome:
    """The equilibria on the way to the lowest peak; `sidmacib.errors.CapacityError` if none."""
    found = lowest_peak(*problem)
    return _outcome(problem.assembly, found, found.spread)


def solve_once(problem: Problem) -> Outcome:
    """The equilibria on the way to a peak; no lower one is sought. Raises as `solve` does."""
    return _outcome(problem.assembly, static_peak(*problem), None)


def _outcome(assembly: Assembly, solution: StaticSolution, spread: float | None) -> Outcome:
    states = tuple(state_of(assembly, each, each.load) for each in solution.path)
    return Outcome(
        states,
        solution.failed_load,
        solution.first_failure_load,
        str(solution.mode),
        spread,
        float(solution.peak.load),
    )


def state_of(assembly: Assembly, point: Equilibrium, load: float) -> State:
    """An equilibrium of ``assembly`` as a state at a ``load`` (N)."""
    motion = placed(assembly, point.unknowns) if not assembly.elastic else None
    return State(float(load), point.displacement, point.force, point.state.bonded, motion)
