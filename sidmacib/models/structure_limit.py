"""Limit analysis of a structure, with associated friction."""

from sidmacib.answers.structure_limit import limit_state
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.problem import MECHANISM, MeshErrors, Outcome, Problem, State
from sidmacib.structure.analysis.limit_mesh_error import limit_mesh_error
from sidmacib.structure.analysis.limit_tilt import limit_tilt
from sidmacib.structure.analysis.tilt import Tilt, load_of_tilt


def solve(problem: Problem) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    assembly, loads = problem
    if loads.axis is not None:
        tilt = limit_tilt(assembly, Tilt(loads.axis))
        value, motion = tilt.angle, tilt.mechanism
        state = State(load_of_tilt(value, loads))
    else:
        found = limit_state(*problem)
        value, motion = found.load, found.mechanism
        state = State(value, force=found.force, bonded=ContactLaw.of(assembly).cohesive)
    return Outcome(
        (state,),
        failed_load=state.load,
        motion=motion,
        motion_kind=MECHANISM,
        mesh_errors=MeshErrors(None, limit_mesh_error(problem, value)),
    )
