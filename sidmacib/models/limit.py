"""Limit analysis of all pieces, without friction."""

from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load
from sidmacib.problem import Outcome, Problem, State


def solve(problem: Problem) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    found = limit_load(*problem)
    state = State(found.load, force=found.force, bonded=ContactLaw.of(problem.assembly).cohesive)
    return Outcome((state,), failed_load=found.load)
