"""Rendered scripts and the data beside them."""

import ast
import json
from pathlib import Path

import pytest

from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.engines import ENGINES
from workflow.render import DATA_FILE, TEMPLATES, write_case


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    case = cases_of(read_study({"samples": {"n3": {"locks": 3}}}))["yade", "n3-mesh0.02-e0.5a"]
    write_case(case, tmp_path)
    return tmp_path


def test_every_engine_has_its_template() -> None:
    for engine in ENGINES.values():
        assert (TEMPLATES / engine.template).is_file()


def test_the_script_is_python_without_traces_of_the_template(folder: Path) -> None:
    text = (folder / ENGINES["yade"].script).read_text()
    ast.parse(text)
    assert "{{" not in text and "{%" not in text
    assert "n3-mesh0.02-e0.5a: 3 locks, mesh 0.02 m." in text


def test_the_data_hold_every_piece_face_and_node(folder: Path) -> None:
    data = json.loads((folder / DATA_FILE).read_text())
    assert [piece["name"] for piece in data["pieces"]] == [
        *("lower", "plate", "lock1", "lock2", "lock3", "column1", "column2", "column3")
    ]
    assert len(data["faces"]) == 3 * 3 + 2 * 2
    assert len(data["nodes"]["face"]) == len(data["nodes"]["area_m2"]) == 99
    assert [load["piece"] for load in data["loads"]] == [2, 5]


def test_rendering_twice_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    case = cases_of(read_study({"samples": {"n3": {"locks": 3}}}))["yade", "n3-mesh0.02-e0.5a"]
    write_case(case, folder)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
