"""The static model of a structure."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Kind, Loads
from sidmacib.mechanics.solution import Equilibrium, Mode
from sidmacib.mechanics.static.model import static_first_failure, static_peak
from sidmacib.problem import Problem
from sidmacib.structure.analysis.mesh_error import (
    UNKNOWN,
    Failures,
    MeshErrors,
    structure_mesh_errors,
)
from sidmacib.structure.analysis.tilt import PRECISION, Tilt, load_of_tilt, static_tilt
from sidmacib.structure.structure import refined
from workflow.outcome import Outcome, State
from workflow.solvers.static import solve_with_path
from workflow.structures.found import AT_THE_PEAK, MECHANISM, Found

FINER = 4  # times as many nodes on cells of half the size
MOST_NODES = 4000  # on these: more take longer than the answer


def solve(problem: Problem) -> Found:
    """The equilibria on the way to the capacity, and where the first bond fails.

    `sidmacib.errors.CapacityError` if there is none.
    """
    found, failures = solve_on_these_cells(problem)
    return replace(found, mesh_errors=_mesh_errors(problem, failures))


def solve_on_these_cells(problem: Problem, *, spread: bool = True) -> tuple[Found, Failures]:
    """What `solve` finds but for mesh errors, and the failures that these compare.

    Without ``spread`` the peak counts, however far peaks spread.
    """
    if problem.loads.axis is not None:
        return _tilted(problem, Tilt(problem.loads.axis))
    try:
        outcome, path = solve_with_path(problem, spread=spread)
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    motion = np.zeros((len(problem.assembly.pieces), 6))
    free = [number for number, piece in enumerate(problem.assembly.pieces) if not piece.fixed]
    motion[free] = path[-1].unknowns.reshape(len(free), 6)
    failures = Failures(outcome.first_failure_load or 0.0, outcome.path[-1].load)
    return Found(outcome, motion, AT_THE_PEAK, _broken_at(problem, path)), failures


def _tilted(problem: Problem, tilt: Tilt) -> tuple[Found, Failures]:
    """The outcome of `solve_on_these_cells` where gravity turns."""
    assembly, loads = problem
    found = static_tilt(assembly, tilt)
    states = tuple(
        State(load_of_tilt(at.load, loads), None, at.force, at.state.bonded) for at in found.path
    )
    outcome = Outcome(
        states,
        states[-1].load * (1.0 + PRECISION),
        load_of_tilt(found.first_failure, loads),
        str(found.motion),
    )
    lost = {face: load_of_tilt(at, loads) for face, at in _lost(assembly, found.path).items()}
    failures = Failures(found.first_failure, found.angle)
    return Found(outcome, found.mechanism, MECHANISM, lost), failures


def _mesh_errors(problem: Problem, coarse: Failures) -> MeshErrors:
    """Mesh errors of the failures; None if cells of half the size give none, or are too many."""
    assembly, loads = problem
    if FINER * len(assembly.nodes.area) > MOST_NODES:
        return UNKNOWN
    try:
        fine = failures_of(refined(assembly), loads, first_only=coarse.peak == coarse.first)
    except CapacityError:
        return UNKNOWN
    return structure_mesh_errors(assembly, coarse, fine)


def failures_of(assembly: Assembly, loads: Loads, *, first_only: bool = False) -> Failures:
    """First failure and peak; the first failure in place of the peak if only that counts."""
    if loads.axis is not None:
        tilt = static_tilt(assembly, Tilt(loads.axis))
        return Failures(tilt.first_failure, tilt.angle)
    if first_only:
        first = static_first_failure(assembly, loads).point.load
        return Failures(first, first)
    try:
        found = static_peak(assembly, loads)
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    return Failures(found.first_failure_load, found.peak.load)


def _broken_at(problem: Problem, path: tuple[Equilibrium, ...]) -> dict[int, float]:
    """The load (N) at which the first bond of each face fails, the first of them first."""
    assembly: Assembly = problem.assembly
    if not any(face.kind is Kind.INNER for face in assembly.faces):
        return {}
    if lost := _lost(assembly, path):
        return lost
    found = static_first_failure(*problem)  # the peak is the first failure
    if found.mode is not Mode.BONDS:
        return {}
    return {int(assembly.nodes.face[np.argmax(found.failing)]): found.point.load}


def _lost(assembly: Assembly, path: tuple[Equilibrium, ...]) -> dict[int, float]:
    """The load of the last equilibrium before the first bond of a face is lost on a path."""
    lost: dict[int, float] = {}
    for before, after in pairwise(path):
        for node in np.flatnonzero(before.state.bonded & ~after.state.bonded):
            lost.setdefault(int(assembly.nodes.face[node]), float(before.load))
    return lost
