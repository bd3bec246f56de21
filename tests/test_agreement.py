"""Where an engine and the static model disagree, every door says so."""

import math

import pandas as pd
import pytest
from command_runner import answers

from analysis.report.joints import _agreement
from analysis.summary import disagreements
from analysis.summary.structures import structure_disagreement
from analysis.summary.summary import _disagreements
from sidmacib.engines import Engine, run
from sidmacib.engines.results import disagreement
from sidmacib.problem import Failures, Outcome, State

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
    assert list(_disagreements(cases(542.0)))[-1] == f"  n3 (yade) {words}"
    (entry,) = _agreement(cases(542.0))
    assert entry["kind"] == "bad"
    assert entry["text"].endswith(f"1 of them disagree, such as n3: YADE {words}.")


def test_where_engines_agree_or_a_load_is_not_known_nothing_is_said() -> None:
    assert disagreement(300.0, 300.0, Failures(math.nan, 310.0)) == ""
    assert disagreements(cases(1140.0)) == []
    assert not any("disagree" in line for line in _disagreements(cases(1140.0)))
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
    peak = answers("capacity", "-n", "3", "-m", "static")[0]["V (N)"] * share

    def found(*_: object) -> Outcome:
        return Outcome((State(peak),), peak, peak, "bonds", peak_load=peak)

    monkeypatch.setattr(run, "engine_outcome", found)
    monkeypatch.setattr(Engine, "version", lambda _: "1")
    (row,) = answers("capacity", "-n", "3", "-m", "yade")
    assert ("disagrees" in row["note"], words in row["note"]) == (bool(words), True)
