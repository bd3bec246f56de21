"""What calculation notes of joints and structures have in common."""

import hashlib
import re
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import needs_browser
from command_runner import assembly, run
from conftest import ROOT
from structures import CUBE, PUSH

from sidmacib.quantities import four_digits

PUSHED: dict[str, Any] = {**CUBE, "load": {**PUSH, "newtons": "4kN"}}
DESIGN = "--gamma-g", "0.9", "--gamma-q", "1.5", "--gamma-m", "1.2"
JOINT = "capacity", "-m", "law", "-e", "0.3", "-V", "100", "--gamma-m", "1.5"


def checks(note: str) -> list[list[str]]:
    """Cells of the table of checks, without marks."""
    (table,) = re.findall(r"<table><thead><tr><th>what</th>.*?</table>", note)
    rows = re.findall(r"<tr>(.*?)</tr>", table)
    cells = [re.findall(r"<t[hd]>(.*?)</t[hd]>", row) for row in rows]
    return [[re.sub("<.*?>", "", cell) for cell in row] for row in cells]


@pytest.fixture(scope="module")
def notes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The notes of a structure and of a joint, and what they were made from."""
    folder = tmp_path_factory.mktemp("notes")
    (folder / "joint.yaml").write_text("locks: 4  # <four>\n")
    made = assembly(folder / "cube.yaml", PUSHED, *DESIGN, "--note", str(folder / "cube.html"))
    assert made.exit_code == 0, made.output
    made = run(*JOINT, "--file", str(folder / "joint.yaml"), "--note", str(folder / "joint.html"))
    assert made.exit_code in (0, 1), made.output
    return folder


def test_checks_have_a_formula_with_numbers_a_result_and_what_follows(notes: Path) -> None:
    head, *rows = checks((notes / "cube.html").read_text())
    assert head == ["what", "formula, with numbers", "result", "check"]
    assert rows[:3] == [
        ["Weight", "Gd = &gamma;G Gk = 0.9 · 19620 N", "17658 N", ""],
        ["Load to be carried", "Qd = &gamma;Q Qk = 1.5 · 4000 N", "6000 N", ""],
        ["Friction and strengths", "Xd = Xk / &gamma;M = Xk / 1.2", "laws in section 1", ""],
    ]
    what, formula, result, check = rows[3]
    assert (what, check) == ("Load carried: static model, peak", "≥ 1: verified")
    assert (formula, result) == ("FR / FE = 7358 N / 6000 N", "1.23")
    assert checks((notes / "joint.html").read_text())[-1][1].startswith("FE / FR = ")


def test_loads_of_large_joints_have_no_exponents(tmp_path: Path) -> None:
    note = tmp_path / "note.html"
    large = "-a", "1.2", "-b", "0.6", "-h", "0.2", "-H", "0.4", "--cohesion", "8e5"
    made = run(*JOINT, "--scatter", "0.2", *large, "--note", str(note))
    assert made.exit_code == 0, made.output
    numbers = re.findall(r"[\d.]+e[+]\d+", note.read_text() + made.output)
    assert set(numbers) <= {"1e+10"}  # the stiffness


@pytest.mark.parametrize(
    ("value", "words"),
    [(9999.4, "9999"), (9999.7, "10000"), (-103208.4, "-103208"), (2e9, "2e+09")],
)
def test_four_digits_grow_to_all_before_the_point(value: float, words: str) -> None:
    assert four_digits(value) == words


@pytest.mark.parametrize("name", ["cube", "joint"])
def test_the_input_is_appended_with_its_digest(notes: Path, name: str) -> None:
    note, given = (notes / f"{name}.html").read_text(), notes / f"{name}.yaml"
    assert hashlib.sha256(given.read_bytes()).hexdigest() in note
    assert "locks: 4  # &lt;four&gt;" in note or "newtons: 4kN" in note.partition("<pre>")[2]


def test_meshes_are_named_by_their_digests(tmp_path: Path) -> None:
    mesh, note = ROOT / "tests/cases/geometry/yup.obj", tmp_path / "note.html"
    found = run("assembly", str(mesh), "--up", "y", "--fixed", "ground", "--note", str(note))
    assert found.exit_code == 0, found.output
    assert hashlib.sha256(mesh.read_bytes()).hexdigest() in note.read_text()
    assert "<pre>" not in note.read_text()


def test_yaml_beside_a_mesh_is_appended_if_it_was_read(tmp_path: Path) -> None:
    mesh, note = tmp_path / "a.obj", tmp_path / "note.html"
    mesh.write_bytes((ROOT / "tests/cases/geometry/yup.obj").read_bytes())
    for text, read in (("permanent: []\n", True), ("blocks: {}\n", False)):
        mesh.with_suffix(".yaml").write_text(text)
        options = "--up", "y", "--fixed", "ground", "--note", str(note)
        assert run("assembly", str(mesh), *options).exit_code == 0
        assert ("a.yaml, SHA-256" in note.read_text()) is read


def test_a_load_that_is_not_carried_is_not_verified(tmp_path: Path) -> None:
    note = tmp_path / "note.html"
    weak = {**CUBE, "load": {**PUSH, "newtons": "40kN"}}
    assert assembly(tmp_path / "cube.yaml", weak, "--note", str(note)).exit_code == 1
    assert checks(note.read_text())[1][3] == "≥ 1: NOT verified"


@pytest.mark.study
@needs_browser
@pytest.mark.parametrize("name", ["cube", "joint"])
def test_everyone_can_read_it(notes: Path, name: str, browser: Any) -> None:
    """What an automatic check of accessibility can see."""
    page = browser.new_page()
    page.goto((notes / f"{name}.html").as_uri())
    found = Axe().run(page)
    page.close()
    assert found.violations_count == 0, found.generate_report()
