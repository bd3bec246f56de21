"""One joint has one answer; where an engine disagrees with the static model, every door says so."""

import math
from dataclasses import replace

import pandas as pd
import pytest
from command_runner import answers
from conftest import a_case

from analysis.explore import pictures
from analysis.explore.pictures import answers as explored
from analysis.explore.pictures import peak, which_counts
from analysis.explore.state import Settings
from analysis.report.joints import _agreement
from analysis.summary import disagreements
from analysis.summary.structures import structure_disagreement
from sidmacib import Direction, Loading, NodeLayout
from sidmacib.answers.joint import JointAnswer, joint_answer, meshes
from sidmacib.engines import Engine, run
from sidmacib.engines.results import disagreement
from sidmacib.models.static import solve
from sidmacib.problem import Failures, Outcome, State
from workflow.results import record_of

STATIC = Failures(441.5, 1148.2)
WORDS = "disagrees with the static model: "


@pytest.mark.parametrize(
    ("peak", "first", "words"),
    [
        (1140.0, 440.0, ""),
        (542.0, 440.0, "peak 53 % below its peak"),
        (300.0, 300.0, "peak 32 % below its first failure"),
        (1400.0, 440.0, "peak 22 % above its peak"),
        (1140.0, 340.0, "first failure 23 % below its first failure"),
        (None, 550.0, "first failure 25 % above its first failure"),
        (1140.0, None, ""),
    ],
)
def test_more_than_a_tenth_is_said(peak: float | None, first: float | None, words: str) -> None:
    assert disagreement(peak, first, STATIC) == (words and f"{WORDS}{words}")


def cases(load: float) -> pd.DataFrame:
    """The static model, an engine that carries ``load`` (N), and limit analysis."""
    rows = [("static", 1148.2, 441.5), ("yade", load, 438.0), ("limit", 2000.0, None)]
    table = pd.DataFrame(rows, columns=["model", "load_N", "first_failure_load_N"])
    table["name"], table["static_load_N"] = "n3", 1148.2
    table["difference_to_static"] = table["load_N"] / 1148.2 - 1.0
    table.loc[0, ["static_load_N", "difference_to_static"]] = None
    return table


def test_a_study_names_engines_that_disagree() -> None:
    words = f"{WORDS}peak 53 % below its peak"
    assert disagreements(cases(542.0)) == [("n3", "yade", words)]
    (entry,) = _agreement(cases(542.0))
    assert entry["kind"] == "bad"
    assert entry["text"].endswith(f"1 of them disagree, such as n3: YADE {words}.")


def test_where_engines_agree_or_a_load_is_not_known_nothing_is_said() -> None:
    assert disagreement(300.0, 300.0, Failures(math.nan, 310.0)) == ""
    assert disagreements(cases(1140.0)) == []
    assert "disagree" not in _agreement(cases(1140.0))[0]["text"]


@pytest.mark.parametrize(("counts", "which"), [("peak", "peak"), ("first failure",) * 2])
def test_so_does_one_of_structures(counts: str, which: str) -> None:
    row = {"model": "yade", "counts": counts, "difference_to_static": -0.3}
    words = structure_disagreement(row)
    assert words == f"{WORDS}{which} 30 % below its {which}"
    assert structure_disagreement(row | {"difference_to_static": 0.05}) == ""
    assert structure_disagreement(row | {"model": "limit"}) == ""


@pytest.mark.parametrize(("share", "words"), [(0.98, ""), (0.85, "peak 15 % below its")])
def test_so_does_the_command(share: float, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    peak = answers("capacity", "-n", "3", "-m", "static")[0]["V_N"] * share

    def found(*_: object) -> Outcome:
        return Outcome((State(peak),), peak, peak, "bonds", peak_load=peak)

    monkeypatch.setattr(run, "engine_outcome", found)
    monkeypatch.setattr(Engine, "version", lambda _: "1")
    (row,) = answers("capacity", "-n", "3", "-m", "yade")
    assert ("disagrees" in row["note"], words in row["note"]) == (bool(words), True)


# --- one question has one answer at every door ---------------------------------------------------
JOINTS = {
    "published": Settings(),
    "pure shear": Settings(locks=3, eccentricity=0.0),
    "one piece": Settings(locks=4, one_piece=True),
    "under pressure": Settings(locks=2, pressure=50.0, eccentricity=0.2),
    "several peaks": Settings(locks=11, eccentricity=1.0),
}


def answer(state: Settings) -> JointAnswer:
    return joint_answer(state.joint, Loading(Direction(state.eccentricity)))


@pytest.mark.long
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
    assert printed["V_N"] == pytest.approx(shear, rel=1e-9)
    first = found.solution.first_failure_load / found.load
    assert printed["first_failure_over_load"] == pytest.approx(first, rel=1e-6)
    assert printed["peak_spread"] == found.solution.spread
    assert ("lowest peak found" in printed["note"]) == (found.why == "lowest peak found")
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
