"""Limit analysis of a structure, with associated friction."""

from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load, require_standing
from sidmacib.problem import Problem
from sidmacib.structure.limit_tilt import limit_tilt
from sidmacib.structure.tilt import Tilt, load_of_tilt
from workflow.outcome import Outcome, State
from workflow.structures.found import MECHANISM, Found


def solve(problem: Problem) -> Found:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    assembly, loads = problem
    if loads.axis is not None:
        tilt = limit_tilt(assembly, Tilt(loads.axis))
        load = load_of_tilt(tilt.angle, loads)
        return Found(Outcome((State(load),), failed_load=load), tilt.mechanism, MECHANISM)
    require_standing(*problem, friction=True)
    found = limit_load(*problem, friction=True)
    state = State(found.load, force=found.force, bonded=ContactLaw.of(assembly).cohesive)
    return Found(Outcome((state,), failed_load=found.load), found.mechanism, MECHANISM)
