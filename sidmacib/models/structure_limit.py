"""Limit analysis of a structure, with associated friction."""

from dataclasses import replace

from sidmacib.answers.said import of_limit
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import MECHANISM, MeshErrors, Outcome, Problem, State
from sidmacib.structure.analysis.limit import LimitTilt, limit_or_tilt


def solve(problem: Problem) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    return outcome_of(problem, limit_or_tilt(problem))


def outcome_of(problem: Problem, found: LimitState | LimitTilt) -> Outcome:
    """What limit analysis has ``found`` for a structure as an outcome."""
    state = State(problem.loads.raised.newtons(found.load))
    if isinstance(found, LimitState):
        bonded = ContactLaw.of(problem.assembly).cohesive
        state = replace(state, force=found.force, bonded=bonded)
    answer = of_limit(problem, found)
    return Outcome(
        (state,),
        failed_load=state.load,
        motion=found.mechanism,
        motion_kind=MECHANISM,
        mesh_errors=MeshErrors(None, answer.mesh_error),
        notes=answer.notes,
    )
