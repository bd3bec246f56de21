"""The explorer's page of structures in a browser."""

from collections.abc import Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import Opened, needs_browser
from explorer import Served, choose, opened_at, settle
from playwright.sync_api import Browser, Page, expect

from analysis.explore.examples import STUDIES, checked_choice, defaults
from analysis.explore.state import from_query
from sidmacib.yaml_text import parsed

# What is on the page each time that it is painted.
RECORDER = """
window.frames_seen = [];
function look() {
  const of = (id) => document.getElementById(id);
  if (of('yaml')?.textContent) window.frames_seen.push({
    slider: of('friction').valueAsNumber,
    typed: of('friction-value').valueAsNumber,
    yaml: Number(of('yaml').textContent.match(/friction: ([0-9.]+)/)[1]),
    table: Number([...of('lines').rows].at(-1).cells[1].textContent),
    drawn: Number(drawn.row.load_N.toPrecision(4)),
    words: Number(of('words').textContent.match(/at ([0-9.]+) N/)[1]),
    busy: of('answer').ariaBusy,
    opacity: parseFloat(getComputedStyle(of('words')).opacity),
  });
  requestAnimationFrame(look);
}
requestAnimationFrame(look);
"""

pytestmark = [pytest.mark.study, needs_browser]


@pytest.fixture
def opened(browser: Browser, served: Served) -> Iterator[Opened]:
    found = opened_at(browser, f"{served.url}/structures")
    yield found
    found.page.close()


def description(page: Page) -> Any:
    """The structure in the file to keep."""
    return parsed((page.text_content("#yaml") or "").encode())


def test_all_that_is_painted_is_of_one_structure_or_grey(opened: Opened) -> None:
    page = opened.page
    page.evaluate(RECORDER)
    page.focus("#friction")
    for _ in range(12):
        page.keyboard.press("ArrowLeft")
        page.wait_for_timeout(60)
    settle(page)
    page.wait_for_timeout(100)
    frames = page.evaluate("window.frames_seen")
    for frame in frames:
        assert frame["typed"] == frame["slider"], frame
        assert frame["table"] == frame["drawn"] == frame["words"], frame
        if frame["yaml"] != frame["slider"]:
            assert frame["busy"] == "true", frame
            assert frame["opacity"] < 0.5, frame
    assert frames[-1]["slider"] == 0.58
    assert frames[-1]["table"] < frames[0]["table"]  # an arch with less friction carries less
    assert opened.errors == []


def test_another_structure_comes_with_its_sliders_and_numbers(opened: Opened) -> None:
    page = opened.page
    choose(page, "friction", "0.6")
    assert not page.locator("#locks").is_visible()
    page.select_option("#structure", "keyed")
    settle(page)
    assert page.locator("#locks").is_visible()
    for name, value in defaults("keyed").items():
        assert float(page.input_value(f"#{name}")) == value
        assert float(page.input_value(f"#{name}-value")) == value
    assert description(page)["locks"][0]["count"] == 3
    choose(page, "locks", "5")
    assert description(page)["locks"][0]["count"] == 5
    assert page.evaluate("drawn.shape.interfaces.some((each) => each.name.includes('lock5'))")
    page.click("#reset")
    settle(page)
    assert page.input_value("#locks-value") == "3"


def test_the_address_opens_the_same_structure(opened: Opened, browser: Browser) -> None:
    page = opened.page
    page.select_option("#structure", "trilith")
    page.select_option("#model", "limit")
    choose(page, "azimuth", "180")
    query = page.url.partition("/structures")[2]
    assert from_query(query, checked_choice).state.model == "limit"
    assert page.text_content("#link") == page.url
    again = opened_at(browser, page.url).page
    for part in ("#words", "#yaml", "#lines"):
        assert again.text_content(part) == page.text_content(part)
    assert again.input_value("#model") == "limit"
    assert again.evaluate("drawn.row.model") == "limit"
    again.close()


def test_variants_are_compared_undone_and_shared(opened: Opened, browser: Browser) -> None:
    page = opened.page
    page.click("#keep")
    choose(page, "friction", "0.4")
    lines = page.locator("#comparison tbody tr").all_text_contents()
    assert lines[0] == "friction0.70.4\N{MINUS SIGN}0.3\N{MINUS SIGN}42.9 %"
    again = opened_at(browser, page.url).page
    assert again.locator("#comparison tbody tr").all_text_contents() == lines
    again.close()
    page.select_option("#structure", "stack")
    settle(page)
    page.click("#undo")
    settle(page)
    assert page.input_value("#structure") == "arch"
    assert page.input_value("#friction-value") == "0.4"
    assert page.locator("#comparison tbody tr").all_text_contents() == lines
    assert opened.errors == []


def test_a_dropped_file_opens(opened: Opened) -> None:
    page = opened.page
    text = (STUDIES / "structures/trilith.yaml").read_text()
    drop = """([text]) => {
      const data = new DataTransfer();
      data.items.add(new File([text], "rougher.yaml"));
      dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
    }"""
    page.evaluate(drop, [text])
    page.wait_for_url("**/opened?file=*")
    page.select_option("#structure-model", "limit")
    assert page.url.endswith("#structure-model=limit")
    shown = page.text_content("#reactions tbody")
    page.reload()
    expect(page.locator("#structure-model")).to_have_value("limit")
    assert page.text_content("#reactions tbody") == shown
    assert Axe().run(page).violations_count == 0
    assert opened.errors == []


def test_a_number_of_a_file_is_changed_in_sight_of_the_picture(
    browser: Browser, served: Served
) -> None:
    opened = opened_at(browser, f"{served.url}/structures", viewport={"width": 1280, "height": 800})
    page = opened.page
    box = page.locator("#structure-plot").bounding_box()
    assert box is not None and box["y"] + box["height"] <= 800
    page.set_input_files("#open", STUDIES / "structures/trilith.yaml")
    page.wait_for_url("**/opened?file=*")
    box = page.locator("#structure-plot").bounding_box()
    assert box is not None and box["y"] < 400 and box["y"] + box["height"] <= 820
    field = page.locator("[data-number='interfaces.friction']")
    field.fill("-1")
    page.keyboard.press("Tab")
    expect(page.locator("#problem")).to_contain_text("interfaces.friction: -1.0")
    before = page.url
    field.fill("0.77")
    page.keyboard.press("Tab")
    page.wait_for_url(lambda url: url != before)
    expect(page.locator("#verdict")).to_contain_text("changed here: interfaces.friction 0.7")
    with page.expect_download() as saved:
        page.click("#save-file")
    assert parsed(saved.value.path().read_bytes())["interfaces"]["friction"] == 0.77
    assert Axe().run(page).violations_count == 0
    assert opened.errors == []
    page.close()
