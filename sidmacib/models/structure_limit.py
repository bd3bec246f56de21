"""Limit analysis of a structure, with associated friction."""

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import MECHANISM, MeshErrors, Outcome, Problem, State
from sidmacib.structure.analysis.limit import limit_mesh_error, limit_state, limit_tilt
from sidmacib.structure.analysis.tilt import Tilt, load_of_tilt
from sidmacib.structure.loads import naming_permanent


def solve(problem: Problem) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    assembly, loads = problem
    if loads.axis is None:
        return outcome_of(problem, limit_state(*problem))
    with naming_permanent(loads):
        tilt = limit_tilt(assembly, Tilt.of(loads))
    state = State(load_of_tilt(tilt.angle, loads))
    return _outcome(problem, state, tilt.angle, tilt.mechanism)


def outcome_of(problem: Problem, found: LimitState) -> Outcome:
    """The limit state ``found`` for a structure as an outcome."""
    bonded = ContactLaw.of(problem.assembly).cohesive
    state = State(found.load, force=found.force, bonded=bonded)
    return _outcome(problem, state, found.load, found.mechanism)


def _outcome(problem: Problem, state: State, value: float, motion: Floats | None) -> Outcome:
    return Outcome(
        (state,),
        failed_load=state.load,
        motion=motion,
        motion_kind=MECHANISM,
        mesh_errors=MeshErrors(None, limit_mesh_error(problem, value)),
    )
