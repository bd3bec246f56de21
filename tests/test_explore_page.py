"""The explorer in a browser: what an impatient user sees, and what nobody should."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from chromium import Opened, leaving_in_browser, leaving_in_html, needs_browser
from explorer import Served, choose, explorer, opened_at, settle
from playwright.sync_api import Browser, Page, expect

from analysis.explore import pictures
from analysis.explore.examples import EXAMPLES
from analysis.explore.pictures import Answers
from analysis.explore.state import SLIDERS, Settings

# What is on the page each time that it is painted, and how many requests are under way at once.
RECORDER = """
window.frames_seen = []; window.most_in_flight = {}; window.posts = 0;
const in_flight = {}, fetch_it = window.fetch;
window.fetch = async (url, options) => {
  in_flight[url] = (in_flight[url] || 0) + 1; window.posts += 1;
  window.most_in_flight[url] = Math.max(window.most_in_flight[url] || 0, in_flight[url]);
  try { return await fetch_it(url, options); } finally { in_flight[url] -= 1; }
};
function look() {
  const of = (id) => document.getElementById(id);
  if (of('yaml')?.textContent) window.frames_seen.push({
    slider: of('locks').valueAsNumber,
    label: of('locks-value').valueAsNumber,
    words: parseInt(of('words').textContent),
    drawn: of('drawing').querySelectorAll('rect.lock').length,
    weights: of('drawing').querySelectorAll('rect.weight').length,
    yaml: parseInt(of('yaml').textContent.match(/locks: (\\d+)/)[1]),
    busy: of('answer').ariaBusy, curve: of('curve').ariaBusy,
    opacity: parseFloat(getComputedStyle(of('words')).opacity),
  });
  requestAnimationFrame(look);
}
requestAnimationFrame(look);
"""

pytestmark = [pytest.mark.study, needs_browser]


@pytest.fixture
def opened(browser: Browser, served: Served) -> Iterator[Opened]:
    found = opened_at(browser, served.url, RECORDER)
    yield found
    found.page.close()


def require_true(page: Page) -> list[dict[str, Any]]:
    """What was painted was of one joint, and of the sliders' joint or grey."""
    frames: list[dict[str, Any]] = page.evaluate("window.frames_seen")
    assert frames
    for frame in frames:
        assert frame["label"] == frame["slider"], frame
        shown = {frame[name] for name in ("words", "drawn", "weights", "yaml")}
        assert len(shown) == 1, frame
        if shown != {frame["slider"]}:
            assert frame["busy"] == frame["curve"] == "true", frame
            assert frame["opacity"] < 0.5, frame
    return frames


def test_numbers_follow_a_drag(opened: Opened) -> None:
    page = opened.page
    assert (page.text_content("#b-effect") or "").startswith("\N{RIGHTWARDS ARROW} +1.")
    box = page.locator("#locks").bounding_box()
    assert box is not None
    middle, ends = box["y"] + box["height"] / 2, (box["x"] + 8, box["x"] + box["width"] * 0.48)
    page.mouse.move(ends[0], middle)
    page.mouse.down()
    for step in range(50):
        page.mouse.move(ends[0] + (ends[1] - ends[0]) * step / 49, middle)
        page.wait_for_timeout(50)
    during = page.evaluate("window.frames_seen")
    page.mouse.up()
    settle(page)
    assert during[-1]["slider"] in (14, 15, 16)
    assert len({frame["words"] for frame in during}) >= 5
    require_true(page)
    assert page.evaluate("window.most_in_flight") == {"/answer": 1, "/curve": 1}
    assert opened.errors == []


def test_a_failed_computation_is_not_shown(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(state: Settings) -> Answers:
        raise ArithmeticError("no matrix")

    page = opened.page
    page.focus("#locks")
    with monkeypatch.context() as patch:
        patch.setattr(pictures, "answers", broken)
        page.keyboard.press("ArrowRight")
        expect(page.locator("#problem")).to_contain_text("could not be computed: 500")
        assert page.get_attribute("#answer", "aria-busy") == "true"
    page.keyboard.press("ArrowRight")
    settle(page)
    expect(page.locator("#problem")).to_be_empty()
    require_true(page)


def test_a_server_that_was_stopped_is_reported(browser: Browser) -> None:
    with explorer() as server:
        page = opened_at(browser, server.url, RECORDER).page
    page.focus("#locks")
    page.keyboard.press("ArrowRight")
    expect(page.locator("#problem")).to_contain_text("The server does not answer.")
    require_true(page)
    page.close()


def test_a_typed_number_moves_its_slider_and_the_address_opens_the_same_joint(
    opened: Opened, browser: Browser, served: Served
) -> None:
    page = opened.page
    choose(page, "locks", "7")
    assert page.input_value("#locks") == "7"
    page.select_option("#one_piece", label="cut into columns")
    settle(page)
    words = page.text_content("#words")
    assert (words or "").startswith("7 locks, ")
    assert page.url == f"{served.url}/?locks=7&one_piece=0"
    again = opened_at(browser, f"{served.url}/?locks=7&one_piece=0").page
    assert again.text_content("#words") == words
    again.close()


def compared(page: Page) -> dict[str, list[str]]:
    """The lines of the comparison by their names."""
    rows = page.locator("#comparison tbody tr")
    lines = [row.locator("td").all_text_contents() for row in rows.all()]
    return {name: cells for name, *cells in lines}


def test_joints_are_compared_and_shared(opened: Opened, browser: Browser, served: Served) -> None:
    page = opened.page
    assert not page.is_visible("#kept")
    page.click("#keep")
    choose(page, "cohesion", "160")
    assert "5 locks, " in (page.text_content("#kept-words") or "")
    lines = compared(page)
    assert lines["cohesion (kPa)"] == ["80", "160", "+80", "+100.0 %"]
    assert "locks n" not in lines
    assert lines["load that counts"][:2] == ["peak", "peak"]
    assert lines["strength of a lock T0 (N)"] == ["240", "480", "+240", "+100.0 %"]
    assert lines["peak, static model: V (N)"][3] == lines["load that counts: V (N)"][3]
    assert ("kept: 5 locks, 60 \N{MULTIPLICATION SIGN} 50 mm", "dash") in dashes(page)
    again = opened_at(browser, page.url)
    assert compared(again.page) == lines
    assert dashes(again.page) == dashes(page)
    again.page.click("#swap")
    settle(again.page)
    assert again.page.input_value("#cohesion") == "80"
    less = "\N{MINUS SIGN}80", "\N{MINUS SIGN}50.0 %"
    assert compared(again.page)["cohesion (kPa)"] == ["160", "80", *less]
    again.page.click("#forget")
    settle(again.page)
    assert not again.page.is_visible("#kept")
    assert again.page.url == f"{served.url}/"
    assert again.errors == opened.errors == []
    again.page.close()


def dashes(page: Page) -> set[tuple[str, str]]:
    read = "document.getElementById('curve').data.map(each => [each.name, each.line?.dash || ''])"
    return {(name, dash) for name, dash in page.evaluate(read)}


def test_undo_restores_the_earlier_joint_and_its_numbers(opened: Opened) -> None:
    page = opened.page
    assert page.is_disabled("#undo") and page.is_disabled("#redo")
    seen = [(page.url, page.text_content("#words"), page.text_content("#yaml"))]
    for name, value in (("locks", "7"), ("a", "80")):
        choose(page, name, value)
        seen.append((page.url, page.text_content("#words"), page.text_content("#yaml")))
    assert len(set(seen)) == 3
    steps: list[tuple[Callable[[], object], int]] = [
        (lambda: page.click("#undo"), 1),
        (lambda: page.keyboard.press("Control+z"), 0),
        (lambda: page.keyboard.press("Control+z"), 0),  # there is nothing to undo
        (lambda: page.keyboard.press("Control+Shift+Z"), 1),
        (lambda: page.click("#redo"), 2),
        (page.go_back, 1),
        (lambda: page.keyboard.press("Control+y"), 2),
    ]
    for step, place in steps:
        step()
        expect(page.locator("#words")).to_have_text(seen[place][1] or "")
        settle(page)
        assert (page.url, page.text_content("#words"), page.text_content("#yaml")) == seen[place]
        assert page.input_value("#locks") == page.input_value("#locks-value")
    assert page.is_disabled("#redo") and page.is_enabled("#undo")
    page.click("#undo")
    choose(page, "b", "60")  # another way from there
    assert page.is_disabled("#redo")
    assert opened.errors == []


def test_a_drag_is_one_step_and_text_in_a_field_has_an_undo_of_its_own(opened: Opened) -> None:
    page = opened.page
    page.focus("#locks")
    for _ in range(6):
        page.keyboard.press("ArrowRight")
    settle(page)
    assert page.input_value("#locks") == "11"
    page.keyboard.press("Control+z")
    settle(page)
    require_true(page)
    page.keyboard.press("Control+Shift+z")
    settle(page)
    assert require_true(page)[-1]["words"] == 11
    page.focus("#a-value")
    page.keyboard.press("Control+a")
    page.keyboard.type("77")
    page.keyboard.press("Control+z")  # of the text
    assert page.input_value("#locks") == "11"
    page.keyboard.press("Escape")
    page.fill("#a-value", page.input_value("#a"))
    page.keyboard.press("Control+z")
    expect(page.locator("#locks-value")).to_have_value("5")
    settle(page)
    assert page.is_disabled("#undo")
    page.keyboard.press("Control+Shift+z")
    expect(page.locator("#locks-value")).to_have_value("11")


# --- both pages ----------------------------------------------------------------------------------
PARTS = {"/": ".modebar-btn", "/structures": "#structure option"}


@pytest.mark.parametrize("path", PARTS)
def test_nothing_leaves_the_machine(browser: Browser, served: Served, path: str) -> None:
    opened = opened_at(browser, f"{served.url}{path}")
    assert leaving_in_html(served.get(path).text) == []
    assert opened.page.locator(PARTS[path]).count() >= len(EXAMPLES)
    assert leaving_in_browser(opened.page) == []
    assert all(url.startswith((served.url, "data:", "blob:")) for url in opened.requests)
    assert opened.errors == []
    opened.page.close()


NARROW = {"viewport": {"width": 380, "height": 800}}


@pytest.mark.parametrize(
    ("path", "window"),
    [
        ("/", NARROW),
        *(("/structures?structure=keyed", each) for each in ({}, {"color_scheme": "dark"}, NARROW)),
    ],
)
def test_everyone_can_read_it(browser: Browser, served: Served, path: str, window: Any) -> None:
    """What an automatic check of accessibility can see."""
    page = opened_at(browser, f"{served.url}{path}", **window).page
    found = Axe().run(page)
    assert found.violations_count == 0, found.generate_report()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    if path == "/":
        assert page.locator("label").count() == len(SLIDERS)
    page.close()
