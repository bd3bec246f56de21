"""Limit analysis of a structure, with associated friction."""

from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.problem import Problem
from workflow.outcome import Outcome, State
from workflow.structures.found import MECHANISM, Found


def solve(problem: Problem) -> Found:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    require_standing(*problem, friction=True)
    found = limit_load(*problem, friction=True)
    state = State(found.load, force=found.force, bonded=ContactLaw.of(problem.assembly).cohesive)
    return Found(Outcome((state,), failed_load=found.load), found.mechanism, MECHANISM)
