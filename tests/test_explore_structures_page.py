"""The explorer's page of structures in a browser."""

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import Opened, chromium, needs_browser
from explorer import Served, explorer
from offline import WATCH, leaving_in_browser, leaving_in_html
from playwright.sync_api import Browser, Page, expect

from analysis.explore import app
from analysis.explore.examples import EXAMPLES, Chosen, choice_in, defaults
from sidmacib.yaml_text import parsed

PATIENCE = 60_000  # ms, on a machine that does much else
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


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as opened:
        yield opened


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


def test_a_newer_choice_is_not_kept_waiting_by_an_older_one(
    opened: Opened, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, begun, newer = opened.page, [], threading.Event()

    def held(state: Chosen) -> None:
        begun.append(dict(state.values)["friction"])
        newer.wait(PATIENCE / 1000)

    def choose(friction: str, until: Callable[[], bool]) -> None:
        page.fill("#friction-value", friction)
        page.keyboard.press("Tab")
        give_up = time.monotonic() + PATIENCE / 1000
        while not until() and time.monotonic() < give_up:
            page.wait_for_timeout(10)
        assert until()
        assert page.get_attribute("#answer", "aria-busy") == "true"

    monkeypatch.setattr(app, "STAGES", (held,) * 6)
    choose("0.5", until=lambda: bool(begun))
    choose("0.6", until=lambda: served.newest()[1] == page.evaluate("latest"))
    newer.set()
    settle(page)
    assert begun == [0.5, *[0.6] * 6]
    assert description(page)["interfaces"]["friction"] == 0.6


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


def test_the_mechanism_moves_with_the_keyboard(browser: Browser, served: Served) -> None:
    opened = opened_at(browser, served, "?structure=trilith&model=limit")
    page = opened.page
    assert page.text_content("#structure-factor") == "undeformed"
    page.focus("#structure-motion")
    page.keyboard.press("End")
    assert (page.text_content("#structure-factor") or "").endswith("(mechanism)")
    colours = page.evaluate("[...document.getElementById('structure-plot').data[3].intensity]")
    assert max(colours) == pytest.approx(1, abs=1e-3)
    page.close()


def test_what_does_not_stand_is_drawn_with_the_reason_beside_it(
    browser: Browser, served: Served
) -> None:
    opened = opened_at(browser, served, "?structure=arch&friction=0.1")
    page = opened.page
    assert "no answer" in (page.text_content("#words") or "")
    assert "does not stand under its own weight" in (page.text_content("#lines") or "")
    assert len(page.evaluate("document.getElementById('structure-plot').data[1].x")) == 5 * 8
    assert page.locator("#structure-play").is_disabled()
    page.close()


def test_the_file_can_be_saved(opened: Opened) -> None:
    with opened.page.expect_download() as download:
        opened.page.click("#save")
    assert download.value.suggested_filename == "arch.yaml"
    assert download.value.path().read_text() == opened.page.text_content("#yaml")


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


def test_the_pages_lead_to_each_other(opened: Opened, served: Served) -> None:
    page = opened.page
    page.click("text=One joint")
    expect(page.locator("h1")).to_contain_text("interlocking joint")
    page.click("text=Structures of blocks")
    settle(page)
    assert page.url.startswith(f"{served.url}/structures")
