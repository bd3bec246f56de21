"""The explorer's page of structures in a browser."""

from collections.abc import Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import PATIENCE, Opened, needs_browser
from explorer import Served, explorer
from offline import WATCH, leaving_in_browser, leaving_in_html
from playwright.sync_api import Browser, Page, expect

from analysis.explore.examples import EXAMPLES, choice_in, defaults
from sidmacib.yaml_text import parsed

WIDE, NARROW = {"width": 1400, "height": 900}, {"width": 390, "height": 800}
# What is on the page each time that it is painted.
RECORDER = """
window.frames_seen = [];
function look() {
  const of = (id) => document.getElementById(id);
  if (of('yaml')?.textContent) window.frames_seen.push({
    slider: of('friction').valueAsNumber,
    typed: of('friction-value').valueAsNumber,
    yaml: Number(of('yaml').textContent.match(/friction: ([0-9.]+)/)[1]),
    table: Number(of('lines').rows[2].cells[1].textContent),
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


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with explorer() as found:
        found.post("/structure", {"page": "test", "number": 1, "values": {}})  # compiled
        yield found


def opened_at(browser: Browser, served: Served, query: str = "", **window: Any) -> Opened:
    page = browser.new_page(**{"viewport": WIDE, **window})
    found = Opened(page)
    page.add_init_script(WATCH)
    page.goto(f"{served.url}/structures{query}")
    settle(page)
    return found


@pytest.fixture
def opened(browser: Browser, served: Served) -> Iterator[Opened]:
    found = opened_at(browser, served)
    yield found
    found.page.close()


def settle(page: Page) -> None:
    expect(page.locator("#answer")).to_have_attribute("aria-busy", "false", timeout=PATIENCE)


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
    page.fill("#friction-value", "0.6")
    page.keyboard.press("Tab")
    assert not page.locator("#locks").is_visible()
    page.select_option("#structure", "keyed")
    settle(page)
    assert page.locator("#locks").is_visible()
    for name, value in defaults("keyed").items():
        assert float(page.input_value(f"#{name}")) == value
        assert float(page.input_value(f"#{name}-value")) == value
    assert description(page)["locks"][0]["count"] == 3
    page.fill("#locks-value", "5")
    page.keyboard.press("Tab")
    settle(page)
    assert description(page)["locks"][0]["count"] == 5
    assert page.evaluate("drawn.shape.interfaces.some((each) => each.name.includes('lock5'))")
    page.click("#reset")
    settle(page)
    assert page.input_value("#locks-value") == "3"


def test_the_address_opens_the_same_structure(
    opened: Opened, browser: Browser, served: Served
) -> None:
    page = opened.page
    page.select_option("#structure", "trilith")
    page.select_option("#model", "limit")
    page.fill("#azimuth-value", "180")
    page.keyboard.press("Tab")
    settle(page)
    query = page.url.partition("/structures")[2]
    assert choice_in(query).state.model == "limit"
    assert page.text_content("#link") == page.url
    again = opened_at(browser, served, query).page
    for part in ("#words", "#yaml", "#lines"):
        assert again.text_content(part) == page.text_content(part)
    assert again.input_value("#model") == "limit"
    assert again.evaluate("drawn.row.model") == "limit"
    again.close()


@pytest.mark.parametrize("window", [{}, {"color_scheme": "dark"}, {"viewport": NARROW}])
def test_everyone_can_read_it(browser: Browser, served: Served, window: dict[str, Any]) -> None:
    page = opened_at(browser, served, "?structure=keyed", **window).page
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    width = page.evaluate("innerWidth")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.close()


def test_nothing_leaves_the_machine(opened: Opened, served: Served) -> None:
    assert leaving_in_html(served.get("/structures").text) == []
    assert opened.page.locator("#structure option").count() == len(EXAMPLES)
    assert leaving_in_browser(opened.page) == []
    assert all(url.startswith((served.url, "data:", "blob:")) for url in opened.requests)
    assert opened.errors == []
