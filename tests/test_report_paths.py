"""Paths of the report: where nodes lie, and loads and stresses there."""

import numpy as np
import pytest

from analysis.report.paths import path_of, shown_cases
from sidmacib.mechanics.static import static_peak
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study

STUDY = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.02],
    "eccentricities": [0.3],
    "models": ["static"],
    "dem": {"engines": []},
}


def case_of() -> JointCase:
    case, *_ = shown_cases(cases_of(read_study(STUDY)).values())
    return case


def test_nodes_lie_on_the_inner_face_of_their_lock() -> None:
    case = case_of()
    joint, found = case.subject.joint, path_of(case)
    assert found is not None
    assert [face["lock"] for face in found["faces"]] == [1, 2, 3]
    for face in found["faces"]:
        lock = face["lock"]
        assert (min(face["x"]), max(face["x"])) == pytest.approx((-joint.a / 2, joint.a / 2))
        edges = joint.edge(lock - 1), joint.edge(lock)
        assert (min(face["y"]), max(face["y"])) == pytest.approx(edges)
        assert face["z"] == pytest.approx(joint.h if joint.is_upper(lock) else 0.0)
        assert len(set(zip(face["x"], face["y"], strict=True))) == len(face["x"])


def test_stresses_stand_at_their_nodes() -> None:
    """They give the shear and, with the places of the nodes, the torque that a lock carries."""
    case = case_of()
    found = path_of(case)
    assert found is not None
    problem = case.subject.problem()
    peak, nodes = static_peak(*problem).peak, problem.assembly.nodes
    stress = (
        np.hypot(peak.force[:, 1], peak.force[:, 2])
        / nodes.area
        / case.subject.joint.inner.cohesion
    )
    for face, shear in zip(found["faces"], found["steps"][-1]["shear"], strict=True):
        place = np.column_stack([face["x"], face["y"], np.full(len(shear), face["z"])])
        for where, value in zip(place, shear, strict=True):
            near = np.abs(nodes.position - where).max(axis=1) < 1e-5
            assert np.abs(stress[near] - value).min() <= 6e-3 * max(value, 1e-6)


def test_loads_are_those_of_the_static_model() -> None:
    case = case_of()
    found = path_of(case)
    assert found is not None
    solution = static_peak(*case.subject.problem())
    assert found["first"] == pytest.approx(solution.first_failure_load, rel=1e-5)
    assert found["steps"][-1]["load"] == pytest.approx(solution.peak.load, rel=1e-5)
    assert found["curve"][-1] == pytest.approx(
        [solution.peak.displacement, solution.peak.load], rel=1e-4
    )
    lost = [face["fails_from"] for face in found["faces"] if face["fails_from"] is not None]
    assert all(solution.first_failure_load <= load <= solution.peak.load for load in lost)
