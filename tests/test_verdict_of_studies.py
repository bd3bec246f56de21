"""One file has one verdict: at the command, and in the tables, summary and report of a study."""

import html
import json
import math
from pathlib import Path
from typing import Any

import pytest
from command_runner import assembly, run
from conftest import run_study
from described import CUBE, DOWN, PUSH, study
from structures import condensed_keys, example, solved

from analysis.report import finding
from analysis.report.structures import structures_verdict
from analysis.summary.structures import summary, verdict_lines
from analysis.tables.structures import structures_table, verdicts_table
from workflow.cases import structure_cases
from workflow.configuration import read_study
from workflow.results.tables import VERDICTS, read_table
from workflow.schema import with_changes

FALLS = {"pressure": {"side": [-1, 0, 0], "pascals": 4e4}}
DEMANDED = {
    "bonds": with_changes(example("trilith"), {"load": {"newtons": "4kN"}}),
    "wall": example("retaining"),
    "arch": {  # a bond fails before the load is raised
        **study("arch/arch"),
        "interfaces": {"cohesion": "20kPa", "tensile_strength": "10kPa"},
        "load": {**PUSH, "newtons": "1kN"},
    },
    "locks": with_changes(condensed_keys(), {"load": {"newtons": 100}}),
    "crushed": {
        **CUBE,
        "interfaces": {"friction": 0.7, "compressive_strength": "50kPa"},
        "load": {**PUSH, "over_weight": 0.45},
    },
    "cases": {
        **CUBE,
        "permanent": [{"surcharge": {"pascals": 1e3}}],
        "load_cases": {
            "wind, full": {**PUSH, "newtons": 2e4},
            "crowd": {**DOWN, "newtons": "1kN"},
            "flood": {**PUSH, "newtons": 1, "permanent": [FALLS]},
        },
    },
}
SAID = {
    "bonds": "Yes: it carries 4000 N with a factor of 0.4 to the first failure, 1.96 to the peak; ",
    "locks": "to the limit; limit analysis, which may overestimate; the static model has no",
    "cases": "No: wind, full, flood are not carried; flood governs: the structure does not stand "
    "under its own weight and the other permanent loads",
}


def study_of(description: dict[str, Any], **keys: Any) -> dict[str, Any]:
    return {
        "structures": {"it": {"description": description, **keys}},
        "models": ["static", "limit"],
        "dem": {"engines": []},
    }


@pytest.mark.parametrize("name", DEMANDED)
def test_a_study_has_the_verdict_of_the_command(name: str, tmp_path: Path) -> None:
    file = tmp_path / "file.yaml"
    said = assembly(file, DEMANDED[name]).output.splitlines()[0]
    assert SAID.get(name, "") in said
    rows = json.loads(run("assembly", str(file), "--format", "json").stdout)
    records = solved(tmp_path / "study", **study_of(DEMANDED[name]))
    table, found = structures_table(records), verdicts_table(records)
    assert [(t, w) for t, w, _ in verdict_lines(found)] == [("it", said)]
    assert f"it: {said}\n" in summary("results", table, None, found)
    told = structures_verdict(table, found)[0]
    assert told == finding("it", f"{said}.", "good" if said.startswith("Yes") else "bad")
    if "load_cases" not in DEMANDED[name]:
        by_model = {row["model"]: row["factor"] for row in rows}
        factors = filter(None, (by_model["limit"], by_model["static"]))
        rows = [{"to limit": by_model["limit"], "factor": min(factors)}]
    names = {"factor": "factor", "to limit": "limit_factor"}
    names |= {"to first failure": "first_failure_factor", "to peak": "peak_factor"}
    for row, own in zip(rows, found.to_dict("records"), strict=True):
        for key in names.keys() & row.keys():
            value = math.nan if row[key] is None else row[key]
            assert own[names[key]] == pytest.approx(value, rel=1e-9, nan_ok=True)
        if "case" in row:
            told_of = (row["case"], row["carried"] == "yes", row["governs"] == "yes")
            assert told_of == (own["load"], own["carried"], own["governs"])


@pytest.mark.study
def test_the_summary_and_the_report_of_a_run_begin_with_the_verdict(tmp_path: Path) -> None:
    said = assembly(tmp_path / "file.yaml", DEMANDED["cases"]).output.splitlines()[0]
    run_study(study_of(DEMANDED["cases"]), tmp_path / "results", "summary.txt", "report.html")
    assert f"it: {said}\n" in (tmp_path / "results/summary.txt").read_text()
    assert said in html.unescape((tmp_path / "results/report.html").read_text())
    table = read_table(VERDICTS, tmp_path / "results/tables/verdicts.csv")
    assert table["governs"].tolist() == [False, False, True]


def test_without_one_of_the_models_a_verdict_says_so(tmp_path: Path) -> None:
    config = study_of(DEMANDED["bonds"], models=["limit"])
    (line,) = verdict_lines(verdicts_table(solved(tmp_path, **config)))
    assert line[1].endswith("the static model has no answer: static model is not in the study")


def test_loads_of_a_study_stand_in_place_of_load_cases() -> None:
    loads = {"push": {**PUSH, "newtons": 1}}
    study = read_study(study_of(DEMANDED["cases"], loads=loads))
    (case,) = {each.name: each for each in structure_cases(study)}.values()
    assert case.subject.demands
    assert case.subject.description["load"] == loads["push"]
    assert "load_cases" not in case.subject.description
