"""The static model of a structure."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from sidmacib.answers.said import of_static
from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import CRUSHING, StaticAnswer, bond_fails, followed
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.equilibrium import has_bonds, placed
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.solution import LEAST_INCREMENT, Equilibrium, Mode
from sidmacib.mechanics.static import static_first_failure
from sidmacib.models.static import state_of
from sidmacib.problem import AT_THE_LOAD, MECHANISM, Failures, Outcome, Problem
from sidmacib.structure.analysis.tilt import PRECISION


def solve(problem: Problem) -> Outcome:
    """The equilibria on the way to the peak, which load counts, and where the first bond fails.

    `sidmacib.errors.CapacityError` if there is none.
    """
    answer = static_answer(problem)
    try:
        given = followed(*problem).failures
    except CapacityError:
        return outcome_of(problem, answer)
    return outcome_of(problem, answer, given)


def outcome_of(problem: Problem, answer: StaticAnswer, given: Failures | None = None) -> Outcome:
    """The ``answer`` for a structure as an outcome; ``given``: as there."""
    load_of, tilts = problem.loads.raised.newtons, problem.loads.raised.axis is not None
    path = tuple(state_of(answer.assembly, each, load_of(each.load)) for each in answer.path)
    if tilts:
        path = tuple(replace(each, displacement=None) for each in path)
    return Outcome(
        path,
        failed_load=path[-1].load * (1.0 + (PRECISION if tilts else LEAST_INCREMENT)),
        first_failure_load=load_of(answer.failures.first),
        mode=answer.mode,
        peak_spread=answer.spread,
        peak_load=path[-1].load,
        motion=answer.mechanism if tilts else placed(answer.assembly, answer.state.unknowns),
        motion_kind=MECHANISM if tilts else AT_THE_LOAD,
        broken_at={f: load_of(load) for f, load in _broken_at(answer, problem.loads).items()},
        mesh_errors=answer.mesh_errors,
        counts=answer.counts,
        cells=answer.assembly,
        given=given and Failures(*map(load_of, given)),
        notes=of_static(answer).notes,
    )


def _broken_at(answer: StaticAnswer, loads: Loads) -> dict[int, float]:
    """The load at which the first bond of each face fails, the first of them first."""
    assembly = answer.assembly
    if not has_bonds(assembly):
        return {}
    if lost := _lost(assembly, answer.path):
        return lost
    if loads.raised.axis or bond_fails(answer.failures) or answer.mode == CRUSHING:
        return {}
    found = static_first_failure(assembly, loads)  # the peak is the first failure
    if found.mode is not Mode.BONDS:
        return {}
    return {int(assembly.nodes.face[np.argmax(found.failing)]): float(found.point.load)}


def _lost(assembly: Assembly, path: tuple[Equilibrium, ...]) -> dict[int, float]:
    """The load of the last equilibrium before the first bond of a face is lost on a path."""
    lost: dict[int, float] = {}
    for before, after in pairwise(path):
        for node in np.flatnonzero(before.state.bonded & ~after.state.bonded):
            lost.setdefault(int(assembly.nodes.face[node]), float(before.load))
    return lost
