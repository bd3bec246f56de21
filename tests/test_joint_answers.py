"""One question has one answer: which load of a joint counts, at every door."""

from dataclasses import replace

import pytest
from command_runner import answers
from conftest import a_case

from analysis.explore import pictures
from analysis.explore.pictures import answers as explored
from analysis.explore.pictures import peak, which_counts
from analysis.explore.state import Settings
from sidmacib import Direction, Loading, NodeLayout
from sidmacib.answers.joint import JointAnswer, joint_answer, meshes
from sidmacib.models.static import solve
from workflow.results import record_of

JOINTS = {
    "published": Settings(),
    "pure shear": Settings(locks=3, eccentricity=0.0),
    "one piece": Settings(locks=4, one_piece=True),
    "under pressure": Settings(locks=2, pressure=50.0, eccentricity=0.2),
    "bonds that fail one by one": Settings(locks=7, eccentricity=1.0),
}


def answer(state: Settings) -> JointAnswer:
    return joint_answer(state.joint, Loading(Direction(state.eccentricity)))


@pytest.mark.parametrize("name", JOINTS)
def test_a_joint_has_the_same_load_at_every_door(name: str) -> None:
    state = JOINTS[name]
    joint, direction, found = state.joint, Direction(state.eccentricity), answer(state)
    shear = found.load * direction.shear
    given = {
        **{"-n": joint.locks, "-a": joint.a, "-b": joint.b, "-h": joint.h, "-H": joint.H},
        **{"-e": state.eccentricity, "--upper-body": str(joint.upper_body), "-m": "static"},
        "--hold-down": f"pressure:{1e3 * state.pressure:g}" if state.pressure else "plate",
    }
    (printed,) = answers("capacity", *(str(part) for pair in given.items() for part in pair))
    assert printed["V (N)"] == pytest.approx(shear, rel=1e-9)
    case = a_case("static", joint, Loading(direction), meshes(joint)[1], NodeLayout.LOBATTO)
    problem = case.subject.problem()
    record = record_of(case, problem, solve(problem), {})
    assert record.part.shear_N == pytest.approx(shear, rel=1e-9)
    assert which_counts(state).shear == pytest.approx(shear, rel=1e-9)
    if not found.solution.spread:
        assert f"peak at V = {shear:.4g} N" in explored(state).words
        at = peak(joint, state.eccentricity)
        assert at is not None and at.shear == pytest.approx(shear, rel=1e-9)


def test_the_lowest_of_several_peaks_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    state = JOINTS["published"]
    peaked = answer(state)
    found = replace(peaked, solution=replace(peaked.solution, spread=0.08))
    assert (peaked.why, found.why) == ("peak", "lowest peak found")
    monkeypatch.setattr(pictures, "joint_answer", lambda *_: found)
    shown = which_counts(state)
    assert "lowest peak found" in shown.words and f"V = {shown.shear:.4g} N" in shown.words
    assert "spread 8.0 %" in shown.legend
