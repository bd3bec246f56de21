"""Whether a structure carries what its file demands, at the command line and in Python."""

import html
import json
import re
from pathlib import Path
from typing import Any

import click
import pytest
import yaml
from click.testing import CliRunner
from command_runner import answers, assembly, run
from conftest import ROOT, run_study
from structures import CUBE, DEMANDED, DOWN, PUSH, WEIGHT, solved

from analysis.summary.structures import verdict_lines
from analysis.tables.structures import verdicts_table
from sidmacib.answers.answer import LIMIT, STATIC, Answer
from sidmacib.answers.said import of_static
from sidmacib.answers.structure import static_answer
from sidmacib.answers.verdict import verdict
from sidmacib.command import output
from sidmacib.command.options import units_option
from sidmacib.command.output import say
from sidmacib.errors import CapacityError, UnboundedError
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import read_yaml
from workflow.cases import structure_cases
from workflow.configuration import read_study
from workflow.results.tables import VERDICTS, read_table
from workflow.schema import with_changes


def said(path: Path, given: dict[str, Any], *more: str) -> tuple[int, str]:
    """The exit status and the first line of output."""
    found = assembly(path, given, *more)
    return found.exit_code, found.output.splitlines()[0]


@pytest.mark.parametrize(
    ("load", "factor", "line"),
    [
        ({**PUSH, "newtons": "5kN"}, 1.962, "Yes: it carries 5000 N with a factor of 1.96"),
        ({**PUSH, "over_weight": 0.4}, 1.25, "Yes: it carries 7848 N with a factor of 1.25"),
        ({**PUSH, "newtons": WEIGHT}, 0.5, "No: it does not carry 19620 N: its factor is 0.5"),
        ({**PUSH, "newtons": 9814}, 0.9996, "No: it does not carry 9814 N: its factor is 0.9996"),
    ],
)
def test_a_load_is_carried_with_the_factor_of_the_load_that_counts(
    path: Path, load: dict[str, Any], factor: float | None, line: str
) -> None:
    code, found = said(path, {**CUBE, "load": load})
    assert (code, found.partition(";")[0]) == (0 if line.startswith("Yes") else 1, line)
    rows = json.loads(run("assembly", str(path), "--format", "json").stdout)["rows"]
    assert [row["factor"] for row in rows] == [pytest.approx(factor, rel=1e-3)] * len(rows)


def test_the_path_decides_where_limit_analysis_has_no_limit(path: Path) -> None:
    """A cube that is pressed down beside its middle, until its joint has given way."""
    code, found = said(path, {**CUBE, "load": {**DOWN, "newtons": "100kN"}})
    assert code == 0
    assert found.startswith("Yes: it carries 100000 N with a factor of 8333")


def test_a_load_within_the_mesh_error_is_left_open(path: Path) -> None:
    code, found = said(path, {**CUBE, "load": {**PUSH, "newtons": 9790}})
    assert code == 1
    assert found.startswith("Open: it may carry 9790 N, within the mesh error of 1 %: its factor")
    cases = {name: {**PUSH, "newtons": load} for name, load in (("a", 9790), ("b", 100))}
    code, found = said(path, {**CUBE, "load_cases": cases})
    assert (code, found[:25]) == (1, "Open: a is left open; a g")


def test_words_are_in_the_units_that_were_asked_for(path: Path) -> None:
    note = path.with_suffix(".html")
    down = {"force": {**DOWN["force"], "newtons": 1000}}
    given = {**CUBE, "permanent": [down], "load": {**PUSH, "newtons": 5000}}
    given["interfaces"] = {"friction": 0.7, "compressive_strength": "50kPa"}
    code, line = said(path, given, "--units", "kN,mm", "--note", str(note))
    assert code == 0
    assert line.startswith("Yes: it carries 5 kN with a factor of")
    assert re.search(r"strength from \d+\.\d+ kN on; without crushing 14\.43 kN$", line)
    text = note.read_text()
    assert line in text
    assert "permanent loads beside weight, together (0, 0, -1) kN" in text
    assert not re.search(r"verdict\">[^<]* N[ ;.,]", text)
    rows = json.loads(run("assembly", str(path), "--format", "json", "--units", "kN").stdout)[
        "rows"
    ]
    assert " kN on; without crushing 14.43 kN" in rows[-1]["note"]


@pytest.mark.parametrize(
    ("units", "words"),
    [
        ("kN", "1.5 kN at (0, -2, 1) m, 3 N m, 4 N/m2, v5 N"),
        ("mm,kNm", "1500 N at (0, -2000, 1000) mm, 0.003 kNm, 4 N/m2, v5 N"),
        ("lbf", "337.2 lbf at (0, -2, 1) m, 3 N m, 4 N/m2, v5 N"),
    ],
)
def test_only_numbers_before_a_unit_that_was_asked_for_change(units: str, words: str) -> None:
    @click.command()
    @units_option
    def told() -> None:
        say("1500 N at (0, -2, 1) m, 3 N m, 4 N/m2, v5 N", "table")

    assert CliRunner().invoke(told, ["--units", units]).output == f"{words}\n"


def test_names_with_numbers_stay_as_they_are(path: Path) -> None:
    blocks = {"ground": CUBE["blocks"]["ground"], "pier 2 m": CUBE["blocks"]["cube"]}
    path.write_text(yaml.safe_dump({**CUBE, "blocks": blocks, "load": {**PUSH, "newtons": 5000}}))
    found = run("assembly", str(path), "--units", "kN,mm").stdout
    assert found.startswith("Yes: it carries 5 kN")
    assert "largest displacement: pier 2 m\n" in found


def test_numbers_of_loads_that_look_wrong_are_noted(path: Path) -> None:
    earth = {"side": [1, 0, 0], "level": 1, "coefficient": 30, "density": 18}
    outside = {"block": "cube", "at": [0.5, 0.5, -3], "direction": [0, 0, -1]}
    given = {**CUBE, "permanent": [{"earth": earth}, {"force": {**outside, "newtons": 1}}]}
    given["load"] = {"force": {"block": "cube", "at": [0, 0.5, 1], "direction": [1, 0, 0]}}
    notes = assembly(path, given).stderr.splitlines()
    assert [note.split(": ")[1] for note in notes] == [
        "permanent.1.earth.density",
        "permanent.1.earth.coefficient",
        "permanent.2.force.at",
    ]
    assert notes[2].endswith("is 3 m outside of block cube")


@pytest.mark.parametrize(
    ("options", "note"),
    [
        ((), "Note: assumed: friction 0.7, density 2000 kg/m3, unit m\n"),
        (("--friction", "0.5"), "Note: assumed: density 2000 kg/m3, unit m\n"),
        (("--friction", "0.5", "--density", "2200"), "Note: assumed: unit m\n"),
        (("--friction", "0.5", "--density", "2200", "--unit", "m"), ""),
    ],
)
def test_what_is_assumed_of_a_mesh_is_said(options: tuple[str, ...], note: str) -> None:
    mesh = ROOT / "tests/cases/geometry/yup.obj"
    found = run("assembly", str(mesh), "--up", "y", "--fixed", "ground", *options)
    assert found.stderr == note


@pytest.mark.parametrize("options", ["--unit mmm", "--fixed nope", "--friction x", "--tolerance 5"])
def test_a_fault_of_an_option_is_told_by_its_flag(options: str) -> None:
    mesh = ROOT / "tests/cases/geometry/yup.obj"
    flag, value = options.split()
    words = f"Error: {flag}: '{value}' is not "
    found = run("assembly", str(mesh), flag, value)
    assert found.exit_code == 2
    assert words in found.stderr


def test_what_takes_long_tells_what_it_does(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not assembly(path, {**CUBE, "load": PUSH}).stderr
    monkeypatch.setattr(output, "PATIENCE", 0.0)
    loaded, still = (
        run("assembly", str(path)).stderr,
        run("assembly", str(path), "--reserve").stderr,
    )
    for words in (
        "reading ",
        "limit analysis ...",
        "limit: ",
        "static model ...",
        "without dilation ...",
    ):
        assert words in loaded
    for words in ("stands in limit analysis", "falls at ", "geometrical safety factor ..."):
        assert words in still


@pytest.mark.long
def test_each_load_case_has_a_line_and_the_lowest_factor_governs(path: Path) -> None:
    heavy = {"surcharge": {"pascals": WEIGHT}}
    cases = {
        "wind": {**PUSH, "newtons": 5000},
        "wind, full": {**PUSH, "newtons": 5000, "permanent": [heavy]},
        "crowd": {**DOWN, "newtons": 5000},
    }
    found = assembly(path, {**CUBE, "load_cases": cases}, "--format", "json")
    assert found.exit_code == 0
    assert found.stderr.startswith("Yes: all 3 cases; wind governs: it carries 5000 N with a fac")
    rows = json.loads(found.stdout)["rows"]
    assert [row["case"] for row in rows] == list(cases)
    assert [row["governs"] for row in rows] == ["yes", "", ""]
    assert [row["factor"] for row in rows[:2]] == pytest.approx([1.962, 3.924], rel=1e-3)
    assert rows[2]["factor"] > 1e5 and rows[2]["carried"] == "yes"
    assert [row["mesh_error_over_load"] for row in rows[:2]] == pytest.approx(
        [0.01, 0.01], abs=1e-3
    )
    note = path.with_suffix(".html")
    assembly(path, {**CUBE, "load_cases": cases}, "--note", str(note))
    for words in ("Mesh error, wind", "acceleration: [1, 0, 0], newtons: 5000", "surcharge:"):
        assert words in note.read_text()
    cases["wind"]["newtons"] = 20_000
    code, line = said(path, {**CUBE, "load_cases": cases})
    assert (code, line[:39]) == (1, "No: wind is not carried; wind governs: ")
    one = said(path, {**CUBE, "load_cases": cases}, "--case", "wind, full")
    assert one == (0, "Yes: it carries 5000 N with a factor of 3.92")


def test_the_retaining_wall_slides_where_friction_and_earth_say(tmp_path: Path) -> None:
    """The example of the documentation: at its base, pushed by earth and an earthquake."""
    weight = 2300 * GRAVITY * 0.5 * (1.0 + 0.9 + 0.8 + 0.7)
    earth = 0.33 * 1800 * GRAVITY * 2.0**2 / 2
    note = tmp_path / "note.html"
    rows = answers("assembly", f"{ROOT}/studies/structures/retaining.yaml", "--note", str(note))
    assert [row["governs"] for row in rows] == ["", "", "yes"]
    assert rows[2]["to_limit"] == pytest.approx((0.65 * weight - earth) / (0.1 * weight), rel=1e-6)
    words = " ".join(note.read_text().split())
    assert "earthquake governs: it carries 3836 N" in words
    assert "forces in proportion to the masses, along (-1, 0, 0)" in words


ONE_CASE = {"load_cases": {"a": {**PUSH, "newtons": 1}}}


@pytest.mark.parametrize(
    ("keys", "options", "message"),
    [
        ({"load": {**PUSH, "newtons": "5m"}}, (), "load.newtons: 5m is a length"),
        ({"load": {**PUSH, "newtons": 1, "over_weight": 1}}, (), "load: must have either newtons"),
        ({"load": {"tilt": {"axis": [1, 0, 0]}, "newtons": 1}}, (), "newtons: must not be given"),
        ({"load_cases": {"a": PUSH}}, (), "load_cases.a: must have either newtons or over_weight"),
        (ONE_CASE | {"load": PUSH}, (), "load_cases: must not be given beside load"),
        (ONE_CASE, ("--case", "b"), "--case: 'b' is not allowed; it must be a"),
        (ONE_CASE, ("--interfaces",), "needs --case"),
        ({"load": PUSH}, ("--case", "a"), "the file has no load_cases"),
    ],
)
def test_a_fault_is_named(
    path: Path, keys: dict[str, Any], options: tuple[str, ...], message: str
) -> None:
    found = assembly(path, {**CUBE, **keys}, *options)
    assert found.exit_code != 0
    assert message in found.output


def test_the_lower_of_the_two_models_decides(path: Path) -> None:
    """On any cells the static model has more twisting friction than a pressed face has.

    On cells of half the size it was 8 % more, on the smallest 0.4 %. What counts is limit analysis.
    """
    pressed = {**DOWN["force"], "at": [0.5, 0.5, 0.5], "newtons": 10190}
    aside = {"block": "cube", "at": [0.5, 0.95, 0], "direction": [1, 0, 0]}
    given = with_changes(CUBE, {"blocks": {"cube": {"high": [1, 1, 0.5]}}})
    given |= {"permanent": [{"force": pressed}], "load": {"force": aside, "newtons": 6400}}
    note = path.with_suffix(".html")
    found = said(path, given, "--note", str(note))
    assert found == (1, "No: it does not carry 6400 N: its factor is 0.954")
    # By hand: plastic friction under a uniform pressure, about the centre of rotation.
    by_hand = 6106
    assert pytest.approx(by_hand, rel=2e-3) == 6400 * 0.954
    answer = static_answer(structure_of(read_yaml(path)))
    assert answer.load == pytest.approx(by_hand, rel=2e-3)
    alone = float(re.search(r"static model alone, (\S+) N", answer.counts.why)[1])
    assert alone == pytest.approx(by_hand, rel=6e-3)
    assert alone > answer.load
    assert note.read_text().count("NOT verified") == 1  # the load, not the checks of the models


def test_limit_analysis_decides_a_verdict_where_it_is_lower() -> None:
    static = of_static(static_answer(structure_of({**CUBE, "load": PUSH})))
    assert static.value
    found = verdict(static.value, static, Answer(model=LIMIT, value=0.9 * static.value))
    assert (found.decides, found.told["verdict"]) == ("limit analysis", "no")
    assert found.factor == pytest.approx(0.9) and not found.passes
    assert found.peak == 1.0
    assert found.note == "limit analysis decides, as it is lower: the static model has 1"


def test_what_a_file_does_not_say_is_said(path: Path) -> None:
    cube = {key: value for key, value in CUBE["blocks"]["cube"].items() if key != "density"}
    text = {"blocks": CUBE["blocks"] | {"cube": cube}, "load": PUSH}
    assert "Note: assumed: friction 0.7, density 2000 kg/m3\n" in assembly(path, text).stderr
    assert "assumed" not in assembly(path, {**CUBE, "load": PUSH}).stderr


def test_mortar_never_makes_a_no_of_a_yes(path: Path) -> None:
    """Limit analysis with frictionless bonds had 1 kN for a cube that friction holds to 9.8 kN."""
    for strength in (0.0, 1e3, 1e4):
        bond = {**CUBE["interfaces"], "cohesion": strength, "tensile_strength": strength}
        text = {**CUBE, "interfaces": bond, "load": {**PUSH, "newtons": 5000}}
        code, found = said(path, text)
        assert code == 0, found
        assert found.startswith("Yes: it carries 5000 N")


def test_where_neither_model_finds_a_limit_any_load_is_carried(path: Path) -> None:
    stiff = {**CUBE["interfaces"], "normal_stiffness": 1e15, "shear_stiffness": 1e15}
    code, found = said(path, {**CUBE, "interfaces": stiff, "load": {**DOWN, "newtons": 100}})
    assert code == 0
    assert found.startswith("Yes: it carries 100 N and any multiple of it; ")


def test_limit_analysis_decides_where_the_static_model_finds_no_limit() -> None:
    endless = UnboundedError("no failure up to 1e+13 N: the load can grow without limit")
    static, limit = Answer(model=STATIC, error=endless), Answer(model=LIMIT, value=9810.0)
    found = verdict(9810.0, static, limit)
    assert str(found) == f"Yes: it carries 9810 N with a factor of 1 to the limit; {endless}"


@pytest.mark.parametrize("value", [500.0, 2000.0])
def test_nothing_is_decided_by_limit_analysis_that_is_no_bound(value: float) -> None:
    """Of brittle bonds: neither a yes nor a no."""
    limit = Answer(model=LIMIT, value=value, bounds=False)
    for error in (CapacityError("no path"), UnboundedError("any load")):
        found = verdict(1000.0, Answer(model=STATIC, error=error), limit)
        assert found.open and not found.passes and not found.decides


# --- in studies ----------------------------------------------------------------------------------
SAID = {
    "bonds": "Yes: it carries 4000 N with a factor of 0.4 to the first failure, 1.84 to the peak; ",
    "locks": "to the limit; base-block has condensed locks, which have no stiffness; cut them out",
    "cases": "No: wind, full, flood are not carried; flood governs: the structure does not stand "
    "under its own weight and the other permanent loads",
}


def study_of(description: dict[str, Any], **keys: Any) -> dict[str, Any]:
    return {
        "structures": {"it": {"description": description, **keys}},
        "models": ["static", "limit"],
        "dem": {"engines": []},
    }


@pytest.mark.long
@pytest.mark.parametrize("name", SAID)
def test_a_verdict_says_what_decides(name: str, path: Path) -> None:
    assert SAID[name] in assembly(path, DEMANDED[name]).stdout.splitlines()[0]


@pytest.mark.study
def test_the_summary_and_the_report_of_a_run_begin_with_the_verdict(tmp_path: Path) -> None:
    said = assembly(tmp_path / "file.yaml", DEMANDED["cases"]).stdout.splitlines()[0]
    run_study(study_of(DEMANDED["cases"]), tmp_path / "results", "summary.txt", "report.html")
    assert f"it: {said}\n" in (tmp_path / "results/summary.txt").read_text()
    assert said in html.unescape((tmp_path / "results/report.html").read_text())
    table = read_table(VERDICTS, tmp_path / "results/tables/verdicts.csv")
    assert table["governs"].tolist() == [False, False, True]


def test_without_one_of_the_models_a_verdict_says_so(tmp_path: Path) -> None:
    config = study_of(DEMANDED["bonds"], models=["limit"])
    (line,) = verdict_lines(verdicts_table(solved(tmp_path, **config)))
    words = "the static model has no answer: static model is not in the study; limit analysis: "
    assert line[1].startswith("Open: nothing shows that it carries 4000 N; ")
    assert words in line[1] and not line[2]


def test_loads_of_a_study_stand_in_place_of_load_cases() -> None:
    loads = {"push": {**PUSH, "newtons": 1}}
    study = read_study(study_of(DEMANDED["cases"], loads=loads))
    (case,) = {each.name: each for each in structure_cases(study)}.values()
    assert case.subject.demands
    assert case.subject.description["load"] == loads["push"]
    assert "load_cases" not in case.subject.description
