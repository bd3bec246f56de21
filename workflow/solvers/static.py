"""The static brittle model."""

from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.mechanics.static import static_peak
from workflow.outcome import Outcome, State


def solve(assembly: Assembly, loads: Loads) -> Outcome:
    """The equilibria on the way to the peak; `sidmacib.errors.CapacityError` if there is none."""
    solution = static_peak(assembly, loads)
    path = tuple(
        State(float(p.load), p.displacement, p.force, p.state.bonded) for p in solution.path
    )
    return Outcome(path, solution.failed_load, solution.first_failure_load, str(solution.mode))
