"""One question has one answer, whatever door it came through: twelve files at all of them.

The command's table, JSON, CSV, page and note; Python; a study's tables, summary and report; a file
that the explorer opens.
"""

import base64
import csv
import html
import io
import json
import math
import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
import yaml
from command_runner import run
from structures import CUBE, DEMANDED, PUSH, solved, study

import sidmacib
from analysis.explore.structures import SentFile, opened_file
from analysis.report import finding
from analysis.report.structures import structures_verdict
from analysis.summary.structures import summary, verdict_lines
from analysis.tables.structures import structures_table, verdicts_table
from sidmacib.answers.verdict import governing, on_all
from workflow.configuration import load_configuration
from workflow.schema import with_changes

BOX = """o base
v -1 -1 -0.5
v 2 -1 -0.5
v 2 2 -0.5
v -1 2 -0.5
v -1 -1 0
v 2 -1 0
v 2 2 0
v -1 2 0
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
o cube
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1.5
v 1 0 1.5
v 1 1 1.5
v 0 1 1.5
f 9 12 11 10
f 13 14 15 16
f 9 10 14 13
f 10 11 15 14
f 11 12 16 15
f 12 9 13 16
"""
WITHOUT_ENGINES = {"models": ["static", "limit"], "dem": {"engines": []}}
MORTAR = {"cohesion": "1kPa", "tensile_strength": "1kPa"}
ARCH = with_changes(study("arch/arch"), {"load": {"newtons": "2kN"}})
ASKED: dict[str, dict[str, Any]] = {
    **DEMANDED,
    "mortar": {
        **CUBE,
        "interfaces": {"friction": 0.6, **MORTAR},
        "load": {**PUSH, "newtons": "5kN"},
    },
    "tower on soft ground": {
        "blocks": {
            "base": {"low": [-1, -1, -1], "high": [1, 1, 0], "fixed": True},
            "tower": {"low": [-0.2, -0.2, 0], "high": [0.2, 0.2, 4]},
        },
        "interfaces": {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e9},
        "load": {**PUSH, "newtons": 900},
    },
    "arch": ARCH,
    "mesh": {
        "blocks": {"part": {"file": "box.obj", "fixed": ["base"]}},  # in m, as is assumed
        "interfaces": {"friction": 0.7},
        "load": {**PUSH, "over_weight": 0.6},
    },
    "from compas": {"blocks": {"it": {"file": "box.json"}}, "load": {**PUSH, "over_weight": 0.6}},
    "tilt": {**CUBE, "load": {"tilt": {"axis": [0, 1, 0]}}},
    "without a demand": {**CUBE, "load": PUSH},
}


def compas_assembly(text: str) -> str:
    """The two boxes of an OBJ as an assembly of COMPAS, the first a support."""
    lines = [line.split() for line in text.splitlines()]
    places = [
        dict(zip("xyz", map(float, each[1:]), strict=True)) for each in lines if each[0] == "v"
    ]
    faces = [[int(k) - 1 for k in each[1:]] for each in lines if each[0] == "f"]
    nodes = {
        str(number): {
            "block": {
                "vertex": {str(k): places[k] for k in range(8 * number, 8 * number + 8)},
                "face": {str(k): [*map(str, faces[k])] for k in range(6 * number, 6 * number + 6)},
            },
            "is_support": number == 0,
        }
        for number in range(2)
    }
    return json.dumps({"graph": {"node": nodes, "edge": {}}})


def in_words(text: str) -> str:
    """What a page or a note says, without its tags."""
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", " ", text)))


SLOW = "bonds"  # is solved on three meshes at each door


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [pytest.param(each, marks=[pytest.mark.study] if each == SLOW else []) for each in ASKED],
)
def test_a_file_has_one_answer_at_every_door(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "a folder"
    folder.mkdir()
    (folder / "box.obj").write_text(BOX)
    (folder / "box.json").write_text(compas_assembly(BOX))
    path = folder / "it.yaml"
    path.write_text(yaml.safe_dump(ASKED[name], sort_keys=False))

    printed = run("assembly", str(path))
    told = json.loads(run("assembly", str(path), "--format", "json").stdout)
    rows = {row.get("model"): row for row in told["rows"]}
    said = told.get("answer")
    if said is not None:
        assert printed.stdout.splitlines()[0] == said
        assert printed.exit_code == (0 if told["verdict"] == "yes" else 1)
    same_in_csv(run("assembly", str(path), "--format", "csv").stdout, told)

    asked = sidmacib.ask(path)
    names = list(ASKED[name].get("load_cases", asked))
    verdicts = [asked[each].verdict for each in names]
    if said is not None:
        assert str(on_all(names, verdicts) if len(verdicts) > 1 else verdicts[0]) == said
        assert next(iter(asked)) == names[governing(verdicts)]

    config = folder / "study.yaml"
    config.write_text(json.dumps({"structures": {"it": {"file": "it.yaml"}}, **WITHOUT_ENGINES}))
    records = solved(tmp_path / "study", **load_configuration(config, {}))
    of_study, found = structures_table(records), verdicts_table(records)
    if said is not None:
        assert [words for _, words, _ in verdict_lines(found)] == [said]
        assert f"it: {said}\n" in summary("results", of_study, None, found)
        kind = "good" if told["verdict"] == "yes" else "bad"
        assert structures_verdict(of_study, found)[0] == finding("it", f"{said}.", kind)
        governs = found[found["governs"]].iloc[0]
        assert governs["decides"] == told["decides"] or not told["decides"]
        expected = math.nan if told["deciding_factor"] is None else told["deciding_factor"]
        assert governs["factor"] == pytest.approx(expected, nan_ok=True)
    assert set(of_study["input_notes"].dropna()) == {"; ".join(told["notes"])} - {""}
    assert all(line in summary("results", of_study, None, found) for line in told["notes"])
    for row in of_study.to_dict("records"):
        if row["model"] in rows and len(asked) == 1:
            same_answer(row, rows[row["model"]])

    for option in ("--report", "--note"):
        page = tmp_path / f"page{option}.html"
        run("assembly", str(path), option, str(page))
        text = in_words(page.read_text())
        assert said is None or in_words(said) in text
        for line in told["notes"]:
            assert in_words(line) in text

    files = (path, folder / "box.obj", folder / "box.json")
    opened = opened_file([sent(each) for each in files])
    answer = opened.answer
    if said is not None and len(asked) == 1:
        assert answer.views.answer.startswith(said)
    if len(asked) == 1:
        assert [row["model"] for row in answer.rows] == [row["model"] for row in told["rows"]]
        for row, same in zip(answer.rows, told["rows"], strict=True):
            assert row["note"] == same["note"]


def same_in_csv(text: str, told: dict[str, Any]) -> None:
    """Rows, verdict, input and notes of a table in CSV, as JSON ``told`` them."""
    beside = {key: told[key] for key in ("verdict", "answer", "deciding_factor") if key in told}
    beside |= {"version": told["version"], "notes": "; ".join(told["notes"])}
    for row, same in zip(csv.DictReader(io.StringIO(text)), told["rows"], strict=True):
        assert json.loads(row["input"]) == told["input"]
        for key, value in (beside | same).items():
            assert row[key] == ("" if value is None else str(value))


def same_answer(of_study: dict[str, Any], row: dict[str, Any]) -> None:
    """The load or tilt of a model in a study's table, and what is said of it, as printed."""
    for key, name in (("load_N", "load_N"), ("tilt_degrees", "tilt_degrees")):
        if row.get(name) is not None:
            assert of_study[key] == pytest.approx(row[name], rel=1e-6)
    if pd.notna(of_study["note"]):
        assert row["note"] == of_study["note"]
    elif pd.notna(of_study["refused"]):
        assert row["note"] in of_study["refused"]
    else:
        assert of_study["because"] in row["note"]
        assert of_study["mode"] in row["note"]


def sent(path: Path) -> SentFile:
    """A file as a browser sends it to the explorer."""
    return SentFile(name=path.name, data=base64.b64encode(path.read_bytes()))
