"""Limit analysis of a structure, with associated friction."""

from sidmacib.answers.structure_limit import limit_state
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.models.found import MECHANISM, Found
from sidmacib.outcome import Outcome, State
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit_mesh_error import limit_mesh_error
from sidmacib.structure.analysis.limit_tilt import limit_tilt
from sidmacib.structure.analysis.mesh_error import MeshErrors
from sidmacib.structure.analysis.tilt import Tilt, load_of_tilt


def solve(problem: Problem) -> Found:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    assembly, loads = problem
    if loads.axis is not None:
        tilt = limit_tilt(assembly, Tilt(loads.axis))
        load = load_of_tilt(tilt.angle, loads)
        outcome = Outcome((State(load),), failed_load=load)
        errors = MeshErrors(None, limit_mesh_error(problem, tilt.angle))
        return Found(outcome, tilt.mechanism, MECHANISM, mesh_errors=errors)
    found = limit_state(*problem)
    state = State(found.load, force=found.force, bonded=ContactLaw.of(assembly).cohesive)
    outcome = Outcome((state,), failed_load=found.load)
    errors = MeshErrors(None, limit_mesh_error(problem, found.load))
    return Found(outcome, found.mechanism, MECHANISM, mesh_errors=errors)
