"""Pages, pictures and notes of a structure, and what they draw."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from chromium import Opened, leaving_in_html, needs_browser, until
from command_runner import assembly
from conftest import ROOT
from structures import PUSH, study
from test_supports import BEAM

from sidmacib.models import structure_limit, structure_static
from sidmacib.problem import Problem
from sidmacib.scene.drawn import Drawn, shape_of, with_condensed_locks
from sidmacib.scene.forces import arrows_of, chains, load_of, total
from sidmacib.scene.picture import picture, view_axes
from sidmacib.structure.analysis.limit import limit_state
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.structure import owners_of
from workflow.schema import with_changes

ARCH = study("arch/arch")
MOST_BYTES = 10_000_000
BLOCK = {
    "blocks": {
        "ground": {"low": [0, 0, -0.1], "high": [1, 1, 0], "fixed": True},
        "<cube>": {"low": [0.3, 0.3, 0], "high": [0.5, 0.5, 0.2]},
    },
    "interfaces": {"friction": 0.4},
    "load": PUSH,
}
SLIDES = 0.4 * 2000 * 9.81 * 0.2**3  # N
TILTED = BLOCK | {"load": {"tilt": {"axis": [0, 1, 0]}}}
LOCKED = study("arch/config")["structures"]["arch"]["variants"]


def drawn(problem: Problem) -> Drawn:
    return Drawn("limit", problem, structure_limit.solve(problem))


@pytest.fixture(scope="module")
def arch() -> Drawn:
    return drawn(structure_of(ARCH))


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of a block on the ground that slides."""
    folder = tmp_path_factory.mktemp("views")
    names = {"--report": "block.html", "--picture": "block.svg", "--note": "note.html"}
    options = [each for option, name in names.items() for each in (option, str(folder / name))]
    found = assembly(folder / "block.yaml", BLOCK, *options)
    assert found.exit_code == 0, found.output
    (folder / "printed.txt").write_text(found.output)
    return folder


# --- what is drawn -------------------------------------------------------------------------------
def test_reactions_balance_the_weight_and_the_load(arch: Drawn) -> None:
    loads = arch.problem.loads.at(arch.load or 0.0)[:, :3].sum(axis=0)
    assert [each.support for each in arch.reactions] == ["left", "right"]
    assert np.array(total(arch.reactions)) == pytest.approx(-loads, abs=1e-6 * np.abs(loads).max())


def test_reactions_balance_the_loads_in_the_frames_of_blocks_that_have_turned() -> None:
    """Supports that the file has last are above their interfaces, whose frames then turn."""
    blocks = {**ARCH["blocks"]}
    blocks |= {name: blocks.pop(name) for name in ("left", "right")}
    problem = structure_of({**ARCH, "blocks": blocks})
    static = Drawn("static", problem, structure_static.solve(problem))
    assert static.load and max(abs(row.move[4]) for row in static.blocks if row.move) > 1e-3
    loads = problem.loads.at(static.load)[:, :3].sum(axis=0)
    assert np.array(total(static.reactions)) == pytest.approx(
        -loads, abs=1e-6 * np.abs(loads).max()
    )


def test_a_stack_has_a_thrust_line_and_what_branches_has_none() -> None:
    assert chains([(0, 1), (2, 3), (1, 2)], {1, 2, 3}) == [[(0, 1), (1, 2), (2, 3)]]
    assert chains([(0, 1), (0, 2), (1, 2), (2, 3)], {1, 2, 3}) == []


def test_there_is_no_thrust_line_where_bonds_carry_the_bending() -> None:
    strong = drawn(structure_of(ARCH | LOCKED["locks"]))
    assert strong.thrust == []
    assert None in [each.near for each in strong.reactions]


@pytest.mark.parametrize("variant", ["reference", "locks"])
def test_forces_on_one_side_of_a_joint_go_through_the_thrust_line(variant: str) -> None:
    problem = structure_of(ARCH | LOCKED.get(variant, {}))
    state = limit_state(*problem, most=500.0)
    found = Drawn("limit", problem, structure_limit.outcome_of(problem, state))
    pieces, loads = problem.assembly.pieces, problem.loads.at(found.load or 0.0)[:, :3]
    owners = owners_of(problem.assembly)
    (line,) = found.thrust
    assert len(line) == 6
    (first,) = set(line[0]["between"]) - set(line[1]["between"])
    start = next(each for each in found.reactions if each.support == pieces[first].name)
    acting = [(np.array(start.at), np.array(start.force))]
    left, scale = {first}, np.abs(loads).sum()
    for each in line:
        for number in left:
            parts = [k for k, owner in enumerate(owners) if owner == number]
            acting += [(pieces[k].centre, loads[k]) for k in parts if not pieces[k].fixed]
        moment = sum(np.cross(place - np.array(each["point"]), force) for place, force in acting)
        assert moment[1] == pytest.approx(0.0, abs=1e-6 * scale)
        left = set(each["between"]) - {first} - left
        first = next(iter(left))


def test_arrows_add_up_to_the_load_with_locks_as_parts_of_their_blocks() -> None:
    problem = structure_of(ARCH | LOCKED["locks"])
    names = [piece.name for piece in problem.assembly.pieces]
    owners = {names[k]: names[number] for k, number in enumerate(owners_of(problem.assembly))}
    locks = [name for name in names if "-lock" in name]
    assert len(locks) == 30
    assert all(owners[lock] in lock and "-lock" not in owners[lock] for lock in locks)
    arrows = arrows_of(*problem)["variable"]
    assert sum(each["force"][0] for each in arrows) == pytest.approx(1.0)
    assert all("-lock" not in each["block"] for each in arrows)


def test_the_load_is_told_in_words() -> None:
    assert load_of(structure_of(BLOCK)).endswith("in proportion to the masses, along (1, 0, 0)")
    force = {"block": "<cube>", "at": [0.4, 0.4, 0.2], "direction": [0, 0, -2]}
    found = load_of(structure_of(BLOCK | {"load": {"force": force}}))
    assert found == "Load raised: a force on <cube> at (0.4, 0.4, 0.2) m, along (0, 0, -1)"
    assert load_of(structure_of(TILTED)) == "Load: gravity, turned about the axis (0, 1, 0)"


def test_locks_that_the_model_condenses_are_drawn() -> None:
    description = ARCH | LOCKED["condensed_locks"]
    condensed = structure_of(description).assembly
    made = with_condensed_locks(description, ROOT)
    assert [solid.name for solid in made] == [piece.name for piece in condensed.pieces]
    plain, cut = shape_of(condensed)["blocks"], shape_of(condensed, made)["blocks"]
    assert all(len(d["points"]) > len(p["points"]) for p, d in zip(plain, cut, strict=True))
    assert with_condensed_locks(BLOCK, ROOT) == []


# --- pictures ------------------------------------------------------------------------------------
def test_a_picture_has_hinges_thrust_line_load_and_reactions(arch: Drawn) -> None:
    figure = picture(arch, shape_of(arch.assembly), "arch")
    (axes,) = figure.axes
    labels = axes.get_legend_handles_labels()[1]
    assert labels == ["hinge", "slides", "thrust line", f"load, {arch.load:.4g} N", "reaction"]
    hinges, slides, thrust = axes.lines[:3]
    assert (len(hinges.get_xdata()), len(slides.get_xdata())) == (3, 1)
    assert len(thrust.get_xdata()) == len(arch.assembly.faces)
    written = [text.get_text() for text in axes.texts]
    assert any(text.startswith("Rx") and "Rz" in text for text in written)


@pytest.mark.parametrize(
    ("sides", "pushed", "towards"),
    [
        ((2.0, 0.3, 1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0)),
        ((0.3, 2.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)),
        ((2.0, 0.3, 1.0), (0.0, 1.0, 0.0), None),
        ((2.0, 2.0, 2.0), (0.0, 0.0, -1.0), None),
    ],
)
def test_flat_structures_are_seen_from_their_front(sides: Any, pushed: Any, towards: Any) -> None:
    axes = view_axes(np.array(sides), np.array(pushed))
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)
    if towards is None:
        assert (np.abs(axes[2]) > 0.2).all()
    else:
        assert axes[2] == pytest.approx(towards)


# --- files ---------------------------------------------------------------------------------------
def test_page_and_picture_have_the_printed_answer_and_need_no_other_file(written: Path) -> None:
    page = (written / "block.html").read_text()
    assert len(page.encode()) < MOST_BYTES
    assert leaving_in_html(page) == []
    assert f"Peak at {SLIDES:.4g} N, 0.4 of the weight" in page
    for row in (written / "printed.txt").read_text().splitlines():
        for word in row.split("  ")[0].split():
            assert word in page
    assert "<cube>" not in page.split('<script id="data"')[0]
    svg = (written / "block.svg").read_text()
    assert svg.startswith("<?xml") and svg.count("<path") > 20


def test_the_note_has_answer_reactions_checks_and_assumptions(written: Path) -> None:
    note = (written / "note.html").read_text()
    assert leaving_in_html(note) == []
    assert f"Peak at {SLIDES:.4g} N, 0.4 of the weight" in note
    assert "&lt;cube&gt;" in note and "<cube>" not in note
    row = f'<td>ground</td><td class="n">-{SLIDES:.4g}</td><td class="n">0</td>'
    assert row in note
    assert "Reactions balance the loads</td>" in note and "verified" in note
    assert "NOT verified" not in note
    assert "No laboratory test" in note


def test_the_note_of_a_tilt_has_the_mesh_errors_of_the_tilt(tmp_path: Path) -> None:
    note = tmp_path / "note.html"
    assert assembly(tmp_path / "block.yaml", TILTED, "--note", str(note)).exit_code == 0
    assert "% of the tilt" in note.read_text() and "% of the load" not in note.read_text()


def test_what_does_not_stand_is_drawn_and_said(tmp_path: Path) -> None:
    over = {"low": [0.9, 0.3, 0], "high": [1.5, 0.5, 0.2]}
    tower = with_changes(BLOCK, {"blocks": {"<cube>": over}})
    page, drawing, note = (tmp_path / name for name in ("a.html", "a.png", "b.html"))
    options = "--report", str(page), "--picture", str(drawing), "--note", str(note)
    assert assembly(tmp_path / "tower.yaml", tower, *options).exit_code == 1
    for file in (page, note):
        assert "The structure does not stand under its own weight" in file.read_text()
    assert drawing.stat().st_size > 0


def test_without_plotly_a_page_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    found = assembly(tmp_path / "block.yaml", BLOCK, "--report", str(tmp_path / "x.html"))
    assert found.exit_code == 2
    remedy = "pip install '.[report]' in the clone of multilock"
    words = f"Error: --report: needs the package plotly: {remedy}"
    assert found.output.splitlines()[-1] == words


@pytest.mark.parametrize("option", ["--report", "--note", "--interfaces"])
def test_a_support_that_moves_has_no_page_and_no_interfaces(option: str, tmp_path: Path) -> None:
    written = [] if option == "--interfaces" else [str(tmp_path / "x.html")]
    found = assembly(tmp_path / "beam.yaml", BEAM, option, *written)
    assert found.exit_code == 2
    assert f"{option}: must not be given where a support moves" in found.output


# --- in a browser --------------------------------------------------------------------------------
@pytest.fixture
def opened(browser: Any, written: Path) -> Iterator[Opened]:
    found = Opened(browser.new_page(viewport={"width": 390, "height": 800}))
    found.page.goto((written / "block.html").as_uri())
    until(found.page, "!!document.querySelector('#structure-plot .gl-container')")
    yield found
    found.page.close()


@pytest.mark.study
@needs_browser
def test_the_page_opens_without_an_error_and_fits_a_telephone(opened: Opened) -> None:
    assert opened.errors == []
    assert [url for url in opened.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert opened.page.evaluate("document.documentElement.scrollWidth") == 390
    assert opened.page.locator("#reactions tbody tr").count() == 1
    names = {trace["name"]: len(trace["x"]) for trace in opened.traces("structure-plot")}
    assert names["load"] and names["reaction"]


@pytest.mark.study
@needs_browser
def test_blocks_move_apart_and_as_the_mechanism_does(opened: Opened) -> None:
    page = opened.page
    read = "[...document.getElementById('structure-plot').data[1].z]"
    at_rest = page.evaluate(read)
    page.focus("#structure-apart")
    page.keyboard.press("End")
    assert min(page.evaluate(read)) > min(at_rest)
    page.keyboard.press("Home")
    page.select_option("#structure-model", "limit")
    page.click("#structure-play")
    until(page, "Number(document.getElementById('structure-motion').value) > 0")
    assert page.text_content("#structure-play") == "Stop"
    page.focus("#structure-motion")
    page.keyboard.press("End")  # which stops it
    assert page.text_content("#structure-play") == "Play"
    assert page.input_value("#structure-motion") == "100"
    assert "(mechanism)" in (page.text_content("#structure-factor") or "")
    assert opened.errors == []
