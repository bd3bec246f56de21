"""Limit analysis of a structure, with associated friction."""

from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import MECHANISM, MeshErrors, Outcome, Problem, State
from sidmacib.structure.analysis.limit import LimitTilt, limit_mesh_error, limit_state, limit_tilt
from sidmacib.structure.analysis.tilt import load_of_tilt
from sidmacib.structure.loads import naming_permanent


def solve(problem: Problem) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    return outcome_of(problem, found_for(problem))


def found_for(problem: Problem) -> LimitState | LimitTilt:
    """The limit load, or the angle where gravity turns; errors of `solve`."""
    assembly, loads = problem
    if loads.axis is None:
        return limit_state(assembly, loads)
    with naming_permanent(loads):
        return limit_tilt(assembly, loads)


def outcome_of(problem: Problem, found: LimitState | LimitTilt) -> Outcome:
    """What limit analysis has ``found`` for a structure as an outcome."""
    if isinstance(found, LimitTilt):
        value, state = found.angle, State(load_of_tilt(found.angle, problem.loads))
    else:
        bonded = ContactLaw.of(problem.assembly).cohesive
        value, state = found.load, State(found.load, force=found.force, bonded=bonded)
    return Outcome(
        (state,),
        failed_load=state.load,
        motion=found.mechanism,
        motion_kind=MECHANISM,
        mesh_errors=MeshErrors(None, limit_mesh_error(problem, value)),
    )
