"""The report: one page that works without a network, in a real browser."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import Opened, needs_browser, until

from analysis import paths
from analysis.paths import paths_of, shown_cases
from analysis.report import json_table
from analysis.report.page import as_yaml, page, provenance, versions_of
from sidmacib.yaml_text import parsed
from workflow.cases import cases_of
from workflow.command import REPORT
from workflow.configuration import read_study
from workflow.schema import Study

pytestmark = pytest.mark.study

MOST_BYTES = 10_000_000


@pytest.fixture(scope="module")
def study(solved_study: tuple[Study, Path]) -> Study:
    return solved_study[0]


@pytest.fixture(scope="module")
def report(solved_study: tuple[Study, Path]) -> Path:
    return solved_study[1] / REPORT


def test_data_cannot_end_their_script() -> None:
    evil = "</script><script>alert(1)</script>"
    source = provenance(None, {})
    content = {"names": [], "verdict": [], "tables": {}, "provenance": source, "evil": evil}
    text = page(content, "", "summary & <b>more</b>")
    assert "alert(1)</script>" not in text
    assert "summary &amp; &lt;b&gt;more&lt;/b&gt;" in text


def test_its_configuration_starts_the_same_study_again(study: Study) -> None:
    again = read_study(parsed(as_yaml(study.model_dump(mode="json")).encode()))
    assert again == study


def test_its_configuration_keeps_a_variant_that_takes_a_key_away() -> None:
    structure = {"description": {"span": 1.0}, "variants": {"dry": {"materials": None}}}
    again = parsed(as_yaml({"samples": {}, "structures": {"arch": structure}}).encode())
    assert again["structures"]["arch"] == structure


def test_the_versions_of_engines_are_those_of_the_cases() -> None:
    rows = pd.DataFrame({"versions": ["yade 2022.01a", None, "liggghts 3.8.0, yade 2022.01a"]})
    versions = dict(versions_of({"cases": rows}))
    assert (versions["YADE"], versions["LIGGGHTS"]) == ("2022.01a", "3.8.0")
    assert {"multilock", "Python", "numpy"} <= set(versions)


def test_what_is_missing_or_infinite_is_plain() -> None:
    table = pd.DataFrame({"a": [1.0, float("nan"), float("inf")], "b": ["x", None, "y"]})
    assert json_table(table)["rows"] == [[1.0, "x"], [None, None], ["inf", "y"]]


# --- in a browser --------------------------------------------------------------------------------


def shown(browser: Any, address: str) -> Opened:
    found = Opened(browser.new_page(viewport={"width": 1200, "height": 800}))
    found.page.goto(address)
    until(found.page, "document.querySelectorAll('.js-plotly-plot').length >= 6")
    return found


@pytest.fixture(scope="module")
def opened(browser: Any, report: Path) -> Iterator[Opened]:
    """The page, once: each part of it is changed by one test alone."""
    found = shown(browser, report.as_uri())
    yield found
    found.page.close()


def names(opened: Opened, plot: str) -> list[str]:
    """Of what a plot shows."""
    return [trace["name"] for trace in opened.traces(plot)]


@needs_browser
def test_it_opens_with_the_answer_and_without_an_error_or_a_request(opened: Opened) -> None:
    assert opened.errors == []
    assert [url for url in opened.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    page = opened.page
    assert "Is it safe to count (n \N{MINUS SIGN} 1)/2 of the n locks" in (
        page.text_content("#h-verdict") or ""
    )
    assert "No: unsafe by" in (page.text_content("#h-verdict strong") or "")
    assert "No laboratory test" in (page.text_content("#verdict .warning") or "")
    box = page.locator(".rules tr", has_text="(n \N{MINUS SIGN} 1)/2").bounding_box()
    assert box is not None
    assert box["y"] + box["height"] < 800
    half = "(n \N{MINUS SIGN} 1)/2, Option 4"
    assert names(opened, "answer-plot") == ["mesh error of static model", half, "static model"]
    # Nor is one possible, whatever a later version of the plotting library tries.
    sent = "fetch('http://127.0.0.1:9/').then(() => 'sent', (error) => error.message)"
    assert page.evaluate(sent) == "Failed to fetch"
    assert any("Content Security Policy" in error for error in opened.errors)


@needs_browser
def test_controls_change_what_is_shown(opened: Opened) -> None:
    page = opened.page
    whole = ["static model", "limit analysis", "SiDMACIB Option 4"]
    assert names(opened, "curve-plot") == whole
    before = opened.traces("curve-plot")[0]["x"]
    page.select_option("#sample", "n3")
    assert 1.5 * max(opened.traces("curve-plot")[0]["x"]) < max(before)
    page.select_option("#sample", "n5")
    page.select_option("#curve-reduction", "none")
    assert max(opened.traces("curve-plot")[-1]["x"]) == pytest.approx(1200, rel=1e-3)
    page.uncheck("#curve-models input[value=limit]")
    assert "limit analysis" not in names(opened, "curve-plot")
    page.check("#curve-options input[value=option1]")
    assert "SiDMACIB Option 1" in names(opened, "curve-plot")
    assert "n5" in (page.text_content("#curve-text") or "")


@needs_browser
def test_the_joint_opens_undeformed_and_the_slider_goes_along_its_load_path(opened: Opened) -> None:
    page = opened.page
    assert page.text_content("#joint-factor") == "undeformed"
    labels = "document.getElementById('joint-plot').data.flatMap(t => t.text || [])"
    texts = page.evaluate(labels)
    assert {"1", "2", "3"} <= set(texts)
    assert any(text.startswith("V = ") for text in texts)
    peak = page.text_content("#path-load")
    page.focus("#path-step")
    page.keyboard.press("Home")
    assert page.text_content("#path-load") == "0 N"
    page.keyboard.press("End")
    assert page.text_content("#path-load") == peak
    assert (peak or "").endswith(" N")
    page.select_option("#path-direction", "torsion")
    turned = page.text_content("#path-load") or ""
    assert turned.endswith(" N m")
    texts = page.evaluate(labels)
    assert any(text.startswith("M = ") for text in texts)
    assert not any(text.startswith("V = ") for text in texts)
    assert f"peak {turned} at" in (page.text_content("#move-text") or "")
    path = "chosenPath()"
    lever = page.evaluate(f"JOINTS.sizes[{path}.sample].a_m")
    data = "document.getElementById('move-plot').data"
    loads = page.evaluate(f"{data}.find((t) => t.name === 'static model, load raised').y")
    assert max(loads) == pytest.approx(lever * page.evaluate(f"{path}.curve.at(-1)[1]"))
    assert "Bonds fail first in lock" in (page.text_content("#order-text") or "")


def test_paths_are_shown_while_there_is_room(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    cases = shown_cases(cases_of(study).values())
    meshes = [case.subject.mesh for case in cases]
    assert meshes == sorted(meshes, reverse=True)
    monkeypatch.setattr(paths, "NODE_STATES", 200)
    whole = paths_of(cases)
    assert len(whole) == len(cases)
    monkeypatch.setattr(paths, "MOST_NODE_STATES", 500)
    fewer = paths_of(cases)
    assert fewer == whole[: len(fewer)]
    assert 0 < len(fewer) < len(cases)


@needs_browser
def test_tables_sort_filter_and_download(opened: Opened, tmp_path: Path) -> None:
    page = opened.page
    page.select_option("#table-name", "weights")
    place = page.locator("#table th button", has_text=re.compile(r"^weight$"))
    place.click()
    column = page.locator("#table th").all_text_contents().index("weight ▲") + 1

    def values() -> list[float]:
        cells = page.locator(f"#table tbody td:nth-child({column})").all_text_contents()
        return [float(cell) for cell in cells]

    assert values() == sorted(values())
    page.locator("#table th button", has_text="weight ▲").click()
    assert values() == sorted(values(), reverse=True)
    page.fill("#table-filter", "n5")
    with page.expect_download() as waiting:
        page.click("#table-csv")
    path = tmp_path / "table.csv"
    waiting.value.save_as(path)
    assert set(pd.read_csv(path)["sample"]) == {"n5"}


@needs_browser
def test_everyone_can_read_it(opened: Opened) -> None:
    """What an automatic check of accessibility can see."""
    found = Axe().run(opened.page)
    assert found.violations_count == 0, found.generate_report()


@needs_browser
def test_the_address_opens_what_was_chosen(browser: Any, report: Path, opened: Opened) -> None:
    page = opened.page
    assert page.locator("select option[value=n5]").count() == 1
    page.select_option("#sample", "n5")
    page.select_option("#table-name", "weights")
    page.uncheck("#curve-models input[value=limit]")
    assert "n5" in (page.text_content("#curve-text") or "")
    assert "n5: 5 locks" in (page.text_content("#answer-size") or "")
    assert len(page.evaluate("chosenPath().faces")) == 5
    found = shown(browser, page.url.replace("#", "#weights&"))
    again = found.page
    assert again.input_value("#sample") == "n5"
    assert again.input_value("#table-name") == "weights"
    assert not again.is_checked("#curve-models input[value=limit]")
    assert again.url.partition("#")[2].startswith("weights&")
    assert again.evaluate("scrollY") > 0
    assert found.errors == []
    again.close()


@needs_browser
def test_an_address_of_what_is_not_there_opens_the_page(browser: Any, report: Path) -> None:
    wrong = "#nowhere&sample=q&table-name=q&curve-models-q=true&q=1"
    found = shown(browser, f"{report.as_uri()}{wrong}")
    assert found.page.input_value("#sample") in ("n3", "n5")
    assert found.errors == []
    found.page.close()
