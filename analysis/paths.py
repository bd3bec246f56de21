"""The static model's path of a joint's case, from no load to the peak and behind it.

Records keep its loads; it is solved again where its nodes and pieces are shown: in figures, in the
report's maps, and as a joint that moves.
"""

from collections.abc import Iterable, Sequence
from itertools import islice
from typing import Any

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint.loading import Push
from sidmacib.joint.pieces import cut_pieces, lock_faces, upper_block
from sidmacib.mechanics.assembly import Assembly, Floats, Integers
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import motion_of
from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static.peaks import after_peak, lowest_peak
from sidmacib.models import REFERENCE_MODEL
from sidmacib.problem import Problem
from workflow.case import REFERENCE, JointCase, JointSubject

MOST_ELASTIC = 1_000  # nodes of elastic blocks: more take minutes
MOST_BONDED = 1_050  # bonded nodes that are followed behind the peak, where they fail one by one
STEPS = 24  # of a path, at most
NODE_STATES = 4_000  # of a path: nodes times steps, at most
MOST_NODE_STATES = 400_000  # of all paths: what the page has room for
MOST_BEHIND = 60  # points behind a peak
DIGITS, PLACES = 3, 5  # of what nodes carry, and of where they are


def path_again(subject: JointSubject) -> tuple[Problem, StaticSolution] | None:
    """The path to the lowest peak; None if there is none, or elastic blocks have too many nodes."""
    try:
        problem = subject.problem()
        if problem.assembly.elastic and len(problem.assembly.nodes.area) > MOST_ELASTIC:
            return None
        return problem, lowest_peak(*problem)
    except CapacityError:
        return None


def behind(
    problem: Problem, peak: Equilibrium, eccentricity: float, most: int
) -> list[Equilibrium] | None:
    """At most so many points behind the ``peak``, see `after_peak`.

    None if nodes would fail one by one and there are too many of them, or blocks are elastic. In
    pure shear, where the ``eccentricity`` is 0, whole locks fail at once.
    """
    bonded = np.count_nonzero(ContactLaw.of(problem.assembly).cohesive)
    if eccentricity != 0.0 and (problem.assembly.elastic or bonded > MOST_BONDED):
        return None
    return list(islice(after_peak(*problem, peak), most))


def displacements(assembly: Assembly, point: Equilibrium) -> Floats:
    """Displacement (m) and rotation of each piece, shape (P, 6); none of fixed or elastic ones."""
    if assembly.elastic:
        return np.zeros((len(assembly.pieces), 6))
    return motion_of(assembly, point.unknowns)


def shown_cases(cases: Iterable[JointCase]) -> list[JointCase]:
    """The static model's cases without changes, those on coarse meshes first."""
    own = [case for case in cases if case.model == REFERENCE_MODEL and case.variant == REFERENCE]
    return sorted(own, key=lambda case: -case.subject.mesh)


def paths_of(cases: Iterable[JointCase]) -> list[dict[str, Any]]:
    """`path_of` those ``cases`` that have a peak, as many as the page has room for."""
    found: list[dict[str, Any]] = []
    room = MOST_NODE_STATES
    for case in cases:
        path = path_of(case)
        if path is not None:
            room -= len(path["steps"]) * sum(len(face["x"]) for face in path["faces"])
            if room < 0:
                break
            found.append(path)
    return found


def path_of(case: JointCase) -> dict[str, Any] | None:
    """Loads, stresses and movements along the path of ``case``; None without one, see `path_again`.

    ``faces``: of each lock, where its nodes lie (x and y in m) and the load from which bonds fail.
    ``curve``: displacement along the load (m) and load (N) of all equilibria; ``behind``: the same
    behind the peak, None if not followed, see `after_peak`. ``steps``: the load (N), for each face
    the shear over the cohesion at its nodes and whether they are bonded, and for each piece its
    displacement and rotation (m, rad).
    """
    subject = case.subject
    joint, ratio = subject.joint, subject.direction.eccentricity
    again = path_again(subject)
    if again is None:
        return None
    problem, solution = again
    path, assembly = solution.path, problem.assembly
    numbers = lock_faces(joint)
    faces = [index for index, face in enumerate(assembly.faces) if face.name in numbers]
    faces.sort(key=lambda index: numbers[assembly.faces[index].name])
    nodes = [np.flatnonzero(assembly.nodes.face == index) for index in faces]
    most = int(np.clip(NODE_STATES // sum(map(len, nodes)), 2, STEPS))
    followed = behind(problem, path[-1], ratio, MOST_BEHIND)
    chosen = np.unique(np.linspace(0, len(path) - 1, most).round().astype(int))
    return {
        "sample": subject.sample,
        "mesh": subject.mesh,
        "eccentricity": "torsion" if np.isinf(ratio) else f"{ratio:g}",
        "push": 1 if subject.loading.push is Push.PLUS_Y else -1,
        "first": float(f"{solution.first_failure_load:.6g}"),
        "curve": [_point(point) for point in path],
        "behind": followed and [_point(point) for point in followed],
        "faces": [
            {
                "lock": numbers[assembly.faces[index].name],
                "x": _rounded(assembly.nodes.position[own, 0], PLACES),
                "y": _rounded(assembly.nodes.position[own, 1], PLACES),
                "z": float(assembly.nodes.position[own[0], 2]),
                "fails_from": _fails_from(path, own),
            }
            for index, own in zip(faces, nodes, strict=True)
        ],
        "steps": [_step(path[place], assembly, faces, nodes) for place in chosen],
    }


def _point(point: Equilibrium) -> list[float]:
    return [float(f"{value:.5g}") for value in (point.displacement, point.load)]


def pieces_of(case: JointCase) -> list[dict[str, Any]]:
    """The pieces of a case as boxes: name, block and corners (m)."""
    above = set(upper_block(case.subject.joint))
    return [
        {
            "name": piece.name,
            "block": "upper" if piece.name in above else "lower",
            "low": list(piece.low),
            "high": list(piece.high),
        }
        for piece in cut_pieces(case.subject.joint)
    ]


def _step(
    point: Equilibrium, assembly: Assembly, faces: list[int], nodes: list[Integers]
) -> dict[str, Any]:
    shear = np.hypot(point.force[:, 1], point.force[:, 2]) / assembly.nodes.area
    bonded = point.state.bonded
    moved = displacements(assembly, point)
    return {
        "load": float(f"{point.load:.6g}"),
        "shear": [
            _rounded(shear[own] / assembly.faces[index].material.cohesion)
            for index, own in zip(faces, nodes, strict=True)
        ],
        "bonded": [bonded[own].astype(int).tolist() for own in nodes],
        "moved": [_rounded(each) for each in moved],
    }


def _fails_from(path: Sequence[Equilibrium], nodes: Integers) -> float | None:
    """The load (N) from which on bonds at ``nodes`` have failed; None if they hold to the peak."""
    loads = (float(point.load) for point in path if not point.state.bonded[nodes].all())
    return next(loads, None)


def _rounded(values: Floats, digits: int = DIGITS) -> list[float]:
    return [float(f"{value:.{digits}g}") for value in values]
