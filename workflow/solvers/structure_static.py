"""The static model of a structure."""

from itertools import pairwise

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Kind
from sidmacib.mechanics.solution import Equilibrium, Mode
from sidmacib.mechanics.static.model import static_first_failure
from sidmacib.problem import Problem
from sidmacib.structure.tilt import PRECISION, Tilt, load_of_tilt, static_tilt
from workflow.outcome import Outcome, State
from workflow.solvers.static import solve_with_path
from workflow.structures.found import AT_THE_PEAK, MECHANISM, Found


def solve(problem: Problem) -> Found:
    """The equilibria on the way to the capacity, and where the first bond fails.

    `sidmacib.errors.CapacityError` if there is none.
    """
    if problem.loads.axis is not None:
        return _tilted(problem, Tilt(problem.loads.axis))
    outcome, path = solve_with_path(problem)
    motion = np.zeros((len(problem.assembly.pieces), 6))
    free = [number for number, piece in enumerate(problem.assembly.pieces) if not piece.fixed]
    motion[free] = path[-1].unknowns.reshape(len(free), 6)
    return Found(outcome, motion, AT_THE_PEAK, _first_face(problem, path))


def _tilted(problem: Problem, tilt: Tilt) -> Found:
    """What `solve` finds where gravity turns."""
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
    first = _lost(assembly, found.path)
    return Found(outcome, found.mechanism, MECHANISM, first)


def _first_face(problem: Problem, path: tuple[Equilibrium, ...]) -> int | None:
    """The face whose bond fails first; None if none does."""
    assembly: Assembly = problem.assembly
    if not any(face.kind is Kind.INNER for face in assembly.faces):
        return None
    if (face := _lost(assembly, path)) is not None:
        return face
    found = static_first_failure(*problem)  # the peak is the first failure
    if found.mode is not Mode.BONDS:
        return None
    return int(assembly.nodes.face[np.argmax(found.failing)])


def _lost(assembly: Assembly, path: tuple[Equilibrium, ...]) -> int | None:
    """The face of the first bond that is lost on a path; None if none is."""
    for before, after in pairwise(path):
        lost = before.state.bonded & ~after.state.bonded
        if lost.any():
            return int(assembly.nodes.face[np.argmax(lost)])
    return None
