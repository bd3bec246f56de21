"""Structures in the report: their drawings, motions and texts."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import WATCH, Opened, leaving_in_browser, leaving_in_html, needs_browser, until
from structures import ONLY_STRUCTURES, example
from test_report import MOST_BYTES

from analysis.report.page import content, page
from analysis.report.structures import structures_verdict
from sidmacib.scene.drawn import shape_of
from sidmacib.structure.files.structure_file import assembly_of
from workflow.cases import structure_cases
from workflow.command import REPORT
from workflow.configuration import read_study
from workflow.results.tables import BLOCKS, INTERFACES, STRUCTURES, read_table

pytestmark = pytest.mark.study

WIDE = {"width": 1200, "height": 900}
PLOTS = "document.querySelectorAll('#structures .js-plotly-plot .gl-container').length === 1"
OF_FREE, OF_FIRST = 1, 5  # traces


@pytest.fixture(scope="module")
def results(structures_study: Path) -> Path:
    """The study beside a joint, and a report of the structures alone."""
    cases = {case.name: case for case in structure_cases(read_study(ONLY_STRUCTURES))}
    data = content(None, tables_in(structures_study), [*cases.values()], structures_study)
    (structures_study / "alone.html").write_text(page(data, "", "summary"))
    return structures_study


def tables_in(folder: Path) -> dict[str, pd.DataFrame]:
    forms = {"structures": STRUCTURES, "interfaces": INTERFACES, "blocks": BLOCKS}
    return {name: read_table(form, folder / f"tables/{name}.csv") for name, form in forms.items()}


# --- data ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["trilith", "keyed", "stack"])
def test_triangles_close_each_block_and_fill_each_interface(name: str) -> None:
    assembly = assembly_of(example(name))
    shape = shape_of(assembly)
    for piece, block in zip(assembly.pieces, shape["blocks"], strict=True):
        points = np.array(block["points"])
        area = sum(areas(points, block["triangles"]))
        solids = getattr(piece, "solids", (piece,))
        sides = [side for solid in solids for side in solid.outlines]
        twice = [np.cross(side, np.roll(side, -1, axis=0)).sum(axis=0) for side in sides]
        assert area == pytest.approx(np.linalg.norm(twice, axis=1).sum() / 2.0, rel=1e-5)
        assert max(map(max, block["edges"])) < len(points)
    for face, region in zip(assembly.faces, shape["interfaces"], strict=True):
        points = np.array(region["points"])
        assert sum(areas(points, region["triangles"])) == pytest.approx(face.area, rel=1e-5)
        assert region["between"] == [face.below, face.above]


def areas(points: Any, triangles: list[list[int]]) -> Iterator[float]:
    for a, b, c in triangles:
        yield float(np.linalg.norm(np.cross(points[b] - points[a], points[c] - points[a]))) / 2


def test_the_verdict_has_loads_tilts_and_refusals(results: Path) -> None:
    table = tables_in(results)["structures"]
    found = {each["title"]: each["text"] for each in structures_verdict(table)}
    assert found["trilith"].startswith(
        "load: 7359 N, 0.2344 of the weight (static model, mesh error 3 %, first bond failure at "
        "1599.7 N); load, dry: "
    )
    tilt = table.set_index(["case", "model"]).loc[("stack-load", "static"), "tilt_degrees"]
    assert found["stack"] == f"load: tilt {tilt:.4g}° (static model, mesh error 1 %)."
    assert found["keyed"].endswith("(limit analysis, mesh error 0 %).")
    assert found["No answer"].startswith("1 of 8 cases")
    first = {"counts": "first failure", "load_N": 1600.0, "load_over_weight": 0.05}
    bonded = table[table["first_interface"].notna()].assign(mesh_error=0.002, **first)
    unsettled = {each["title"]: each["text"] for each in structures_verdict(bonded)}["trilith"]
    assert unsettled == (
        "load: 1600 N, 0.05 of the weight (static model, mesh error 0.2 %, first bond "
        "failure; the peak of 7358.6 N is not reliable)."
    )
    failed = table.assign(error="why", load_N=float("nan"), tilt_degrees=float("nan"))
    kinds = {each["title"]: each["kind"] for each in structures_verdict(failed)}
    assert kinds["Structures without a result"] == "bad"


def test_engines_that_differ_from_the_static_model_are_reported(results: Path) -> None:
    table = tables_in(results)["structures"]
    row = table[table["model"].eq("limit")].iloc[[0]]
    for apart, kind in ((-0.004, "good"), (0.03, "bad")):
        more = pd.concat([table, row.assign(model="yade", difference_to_static=apart)])
        found = {each["title"]: each for each in structures_verdict(more)}
        entry = found["Engines against the static model, structures"]
        assert entry["kind"] == kind
        assert f"{100 * abs(apart):.2f} %" in entry["text"]


@pytest.mark.parametrize("name", [REPORT, "alone.html"])
def test_the_page_is_one_file_that_asks_for_nothing(results: Path, name: str) -> None:
    text = (results / name).read_text()
    assert len(text.encode()) < MOST_BYTES
    assert leaving_in_html(text) == []
    assert ('id="curve-plot"' in text) == (name == REPORT)


# --- in a browser --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def alone(browser: Any, results: Path) -> Opened:
    """The report of the structures alone."""
    found = Opened(browser.new_page(viewport=WIDE))
    found.page.goto((results / "alone.html").as_uri())
    until(found.page, PLOTS)
    return found


@pytest.fixture
def opened(alone: Opened) -> Opened:
    """The same as it opens."""
    choose(alone, name="trilith", variant="reference", model="static")
    alone.page.check("#structure-forces")
    return alone


def points(opened: Opened, trace: int) -> Any:
    """The points of a trace, (N, 3) in m, without gaps between lines."""
    read = "([k]) => { const t = document.getElementById('structure-plot').data[k];"
    read += " return [[...t.x], [...t.y], [...t.z]]; }"
    rows = np.array(opened.page.evaluate(read, [trace]), float).T.reshape(-1, 3)
    return rows[~np.isnan(rows).any(axis=1)]


def choose(opened: Opened, **parts: str) -> None:
    for part, value in parts.items():
        opened.page.select_option(f"#structure-{part}", value)


@needs_browser
@pytest.mark.parametrize("name", [REPORT, "alone.html"])
def test_it_opens_without_an_error_or_a_request(browser: Any, results: Path, name: str) -> None:
    page = browser.new_page(viewport=WIDE)
    page.add_init_script(WATCH)
    found = Opened(page)
    page.goto((results / name).as_uri())
    until(page, PLOTS)
    assert found.errors == []
    assert [url for url in found.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert page.locator("#structures .modebar-btn").count() > 3
    assert leaving_in_browser(page) == []
    page.close()


@needs_browser
def test_it_opens_undeformed_and_moves_with_the_keyboard(opened: Opened) -> None:
    page = opened.page
    assert page.text_content("#structure-factor") == "undeformed"
    blocks = shape_of(assembly_of(example("trilith")))["blocks"]
    free = np.array([point for each in blocks if not each["fixed"] for point in each["points"]])
    at_rest = points(opened, OF_FREE)
    assert at_rest == pytest.approx(free)
    page.focus("#structure-motion")
    page.keyboard.press("End")
    moved = np.linalg.norm(points(opened, OF_FREE) - at_rest, axis=1).max()
    size = np.linalg.norm(np.ptp(np.array([p for each in blocks for p in each["points"]]), axis=0))
    assert 0.02 * size < moved < 0.16 * size
    assert points(opened, 0) == pytest.approx(np.array(blocks[0]["points"]))  # the ground stays
    assert (page.text_content("#structure-factor") or "").endswith("(at the load)")
    page.keyboard.press("Home")
    assert points(opened, OF_FREE) == pytest.approx(at_rest)


@needs_browser
def test_the_first_bond_to_fail_is_named_and_marked(opened: Opened) -> None:
    text = opened.page.text_content("#structure-order") or ""
    assert text.startswith("First bond failure: left-lintel (outlined in red) at 1600")
    regions = {
        each["name"]: each for each in shape_of(assembly_of(example("trilith")))["interfaces"]
    }
    corners = np.unique(points(opened, OF_FIRST), axis=0)
    expected = np.unique(np.array(regions["left-lintel"]["points"]), axis=0)
    assert corners == pytest.approx(expected)
    choose(opened, variant="dry")
    assert len(points(opened, OF_FIRST)) == 0
    assert "All interfaces are dry" in (opened.page.text_content("#structure-order") or "")


@needs_browser
def test_models_stand_side_by_side_and_a_refusal_is_shown(opened: Opened) -> None:
    page = opened.page
    head = page.locator("#structure-models th").all_text_contents()
    assert head[:4] == ["model", "load (N)", "load / weight", "governed by"]
    cells = page.locator("#structure-models tbody tr").first.locator("td").all_text_contents()
    assert cells[:3] == ["static model", "7359", "0.2344"]
    choose(opened, name="keyed", model="static")
    assert "No answer of the static model: base-block has condensed locks" in str(
        page.text_content("#structure-order")
    )
    assert page.is_disabled("#structure-play")
    assert len(points(opened, OF_FREE)) == 8
    choose(opened, name="stack")
    assert "tilt (°)" in page.locator("#structure-models th").all_text_contents()


@needs_browser
def test_everyone_can_read_it(opened: Opened) -> None:
    """What an automatic check of accessibility can see."""
    found = Axe().run(opened.page)
    assert found.violations_count == 0, found.generate_report()
