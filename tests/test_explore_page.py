"""The explorer in a browser: what an impatient user sees, and what nobody should."""

import re
import shutil
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from explorer import Served, explorer
from offline import WATCH, leaving_in_browser, leaving_in_html
from playwright.sync_api import Browser, Page, expect, sync_playwright

from analysis.explore import app
from analysis.explore.pictures import Answers
from analysis.explore.state import SLIDERS, Settings

CHROMIUM = shutil.which("chromium")
PATIENCE = 60_000  # ms, on a machine that does much else
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

pytestmark = [
    pytest.mark.study,
    pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed"),
]


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with explorer() as found:
        found.ask({})  # compiled
        yield found


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


class Opened:
    """The page in a browser, with what it said and asked for."""

    def __init__(self, browser: Browser, served: Served, query: str = "") -> None:
        self.context = browser.new_context(viewport={"width": 1400, "height": 900})
        self.context.grant_permissions(["clipboard-read", "clipboard-write"], origin=served.url)
        self.page: Page = self.context.new_page()
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", self._heard)
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.add_init_script(WATCH)
        self.page.add_init_script(RECORDER)
        self.page.goto(f"{served.url}/{query}")
        self.settle()

    def _heard(self, message: Any) -> None:
        if message.type == "error":
            self.errors.append(message.text)

    def settle(self, part: str = "curve") -> None:
        """Wait until numbers, or the curve too, are of the joint of the sliders."""
        expect(self.page.locator("#answer")).to_have_attribute(
            "aria-busy", "false", timeout=PATIENCE
        )
        expect(self.page.locator(f"#{part}")).to_have_attribute(
            "aria-busy", "false", timeout=PATIENCE
        )

    def frames(self) -> list[dict[str, Any]]:
        return list(self.page.evaluate("window.frames_seen"))


@pytest.fixture
def opened(browser: Browser, served: Served) -> Iterator[Opened]:
    found = Opened(browser, served)
    yield found
    found.context.close()


def require_true(frames: list[dict[str, Any]]) -> None:
    """What is painted is of one joint, and of the sliders' joint or grey."""
    assert frames
    for frame in frames:
        assert frame["label"] == frame["slider"], frame
        shown = {frame[name] for name in ("words", "drawn", "weights", "yaml")}
        assert len(shown) == 1, frame
        if shown != {frame["slider"]}:
            assert frame["busy"] == frame["curve"] == "true", frame
            assert frame["opacity"] < 0.5, frame


def test_numbers_follow_a_drag(opened: Opened) -> None:
    page = opened.page
    box = page.locator("#locks").bounding_box()
    assert box is not None
    middle, ends = box["y"] + box["height"] / 2, (box["x"] + 8, box["x"] + box["width"] * 0.48)
    page.mouse.move(ends[0], middle)
    page.mouse.down()
    for step in range(50):
        page.mouse.move(ends[0] + (ends[1] - ends[0]) * step / 49, middle)
        page.wait_for_timeout(50)
    during = opened.frames()
    page.mouse.up()
    opened.settle()
    assert during[-1]["slider"] in (14, 15, 16)
    assert len({frame["words"] for frame in during}) >= 5
    require_true(opened.frames())
    assert page.evaluate("window.most_in_flight") == {"/answer": 1, "/curve": 1}
    assert opened.errors == []


def test_below_each_slider_is_which_way_to_pull_it_and_never_that_of_another_joint(
    opened: Opened,
) -> None:
    page = opened.page
    opened.settle()
    assert (page.text_content("#b-effect") or "").startswith("\N{RIGHTWARDS ARROW} +1.")
    assert (page.text_content("#h-effect") or "").startswith("\N{LEFTWARDS ARROW} \N{MINUS SIGN}0.")
    assert page.text_content("#locks-effect") == ""
    before = page.text_content("#b-effect")
    page.focus("#young")
    page.keyboard.press("ArrowRight")  # blocks that bend
    assert page.text_content("#b-effect") == ""
    opened.settle()
    assert page.text_content("#b-effect") == ""
    page.keyboard.press("ArrowLeft")
    opened.settle()
    assert page.text_content("#b-effect") == before
    assert opened.errors == []


def test_thirty_presses_of_a_key_end_in_the_joint_that_they_chose(opened: Opened) -> None:
    page = opened.page
    page.focus("#locks")
    posts = page.evaluate("window.posts")
    for _ in range(30):
        page.keyboard.press("ArrowRight")
    opened.settle()
    assert (page.text_content("#words") or "").startswith("31 locks, ")
    require_true(opened.frames())
    assert opened.frames()[-1]["words"] == 31
    assert page.evaluate("window.most_in_flight") == {"/answer": 1, "/curve": 1}
    assert page.evaluate("window.posts") - posts <= 2 * 26  # from 5 locks to 31


def test_a_slow_answer_is_waited_for_in_grey(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, quick, looked_at = opened.page, app.answers, threading.Event()

    def slow(state: Settings) -> Answers:
        looked_at.wait(PATIENCE / 1000)
        return quick(state)

    monkeypatch.setattr(app, "answers", slow)
    page.focus("#locks")
    page.keyboard.press("End")
    page.wait_for_timeout(200)
    assert page.get_attribute("#answer", "aria-busy") == "true"
    assert (page.text_content("#words") or "").startswith("5 locks, ")
    assert page.locator("#words").evaluate("part => getComputedStyle(part).opacity") == "0.4"
    looked_at.set()
    opened.settle()
    assert (page.text_content("#words") or "").startswith("31 locks, ")
    require_true(opened.frames())


def test_each_step_of_a_slider_asks_once_for_its_answer(opened: Opened) -> None:
    opened.page.route("**/curve", lambda route: route.fulfill(status=204))  # which comes later
    opened.page.focus("#locks")
    opened.requests.clear()
    for _ in range(3):
        opened.page.keyboard.press("ArrowRight")
        opened.settle("answer")
    assert (opened.page.text_content("#words") or "").startswith("8 locks, ")
    assert [url.rpartition("/")[2] for url in opened.requests].count("answer") == 3


def test_a_joint_that_cannot_be_computed_is_not_shown_as_if_it_were(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(state: Settings) -> Answers:
        raise ArithmeticError("no matrix")

    page = opened.page
    page.focus("#locks")
    with monkeypatch.context() as patch:
        patch.setattr(app, "answers", broken)
        page.keyboard.press("ArrowRight")
        expect(page.locator("#problem")).to_contain_text("could not be computed: 500")
        assert page.get_attribute("#answer", "aria-busy") == "true"
    page.keyboard.press("ArrowRight")
    opened.settle()
    expect(page.locator("#problem")).to_be_empty()
    require_true(opened.frames())


def test_a_server_that_was_stopped_is_reported(browser: Browser) -> None:
    with explorer() as server:
        opened = Opened(browser, server)
    opened.page.focus("#locks")
    opened.page.keyboard.press("ArrowRight")
    expect(opened.page.locator("#problem")).to_contain_text("The server does not answer.")
    assert opened.page.get_attribute("#answer", "aria-busy") == "true"
    require_true(opened.frames())
    opened.context.close()


def test_a_link_beyond_the_sliders_shows_the_joint_and_says_so(
    browser: Browser, served: Served
) -> None:
    opened = Opened(browser, served, "?locks=999")
    page = opened.page
    assert "locks: 999 is outside 2 to 31; 31 is shown." in (page.text_content("#notes") or "")
    assert (page.text_content("#words") or "").startswith("31 locks, ")
    assert page.text_content("#link") == f"{served.url}/?locks=31"
    page.focus("#locks")
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#notes")).to_be_empty()
    opened.context.close()


def test_a_typed_number_moves_its_slider_and_the_address_opens_the_same_joint(
    opened: Opened, browser: Browser, served: Served
) -> None:
    page = opened.page
    page.fill("#locks-value", "7")
    page.keyboard.press("Tab")
    opened.settle()
    assert page.input_value("#locks") == "7"
    page.select_option("#one_piece", label="one piece")
    opened.settle()
    words = page.text_content("#words")
    assert (words or "").startswith("7 locks, ")
    assert page.url == f"{served.url}/?locks=7&one_piece=1"
    again = Opened(browser, served, "?locks=7&one_piece=1")
    assert again.page.text_content("#words") == words
    assert again.page.input_value("#locks-value") == "7"
    again.context.close()


def test_a_typed_number_that_is_not_possible_is_told_and_brought_to_the_slider(
    opened: Opened,
) -> None:
    page = opened.page
    page.fill("#locks-value", "99")
    page.keyboard.press("Tab")
    opened.settle()
    assert page.input_value("#locks-value") == "31"
    expect(page.locator("#notes")).to_have_text(
        "locks: from 2 to 31 in steps of 1; the nearest is shown."
    )


def test_two_joints_stand_beside_each_other(opened: Opened) -> None:
    page = opened.page
    page.click("#keep")
    page.fill("#locks-value", "6")
    page.keyboard.press("Tab")
    opened.settle()
    text = page.text_content("#kept") or ""
    assert "5 locks, " in text
    assert "Changed since: n 5 → 6." in text
    names = page.evaluate("document.getElementById('curve').data.map(each => each.name)")
    assert any(name.startswith("kept: 5 locks, ") for name in names)
    page.click("#forget")
    assert page.text_content("#kept") == ""


def test_copies_are_reached_and_made_by_keyboard(opened: Opened) -> None:
    page = opened.page
    page.focus("#one_piece")
    copied = []
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.dataset.copy") is not None:
            page.keyboard.press("Enter")
            expect(page.locator(":focus")).to_have_text("Copied")
            copied.append(page.evaluate("navigator.clipboard.readText()"))
    shown = [page.text_content(f"#{name}") for name in ("yaml", "python", "link")]
    assert copied[:3] == shown
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", copied[2])


def test_nothing_leaves_the_machine(opened: Opened, served: Served) -> None:
    assert leaving_in_html(served.get("/").text) == []
    assert opened.page.locator(".modebar-btn").count() > 6
    assert leaving_in_browser(opened.page) == []
    assert all(url.startswith((served.url, "data:", "blob:")) for url in opened.requests)
    assert opened.errors == []


def test_another_page_cannot_frame_it_or_make_it_work(
    browser: Browser, served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    computed: list[Settings] = []

    def counted(state: Settings) -> Answers:
        computed.append(state)
        return Answers(None, {}, "counted")

    monkeypatch.setattr(app, "answers", counted)
    page = browser.new_page()
    page.route(
        "http://evil.example/",
        lambda route: route.fulfill(
            content_type="text/html",
            body=f'<iframe src="{served.url}/?locks=31"></iframe><img src="{served.url}/answer">',
        ),
    )
    page.goto("http://evil.example/")
    asked = '{"page": "evil", "number": 1, "values": {"locks": 31}}'
    for kind in ("text/plain", "application/json"):
        headers = f"{{'Content-Type': '{kind}'}}"
        options = f"{{method: 'POST', body: '{asked}', headers: {headers}}}"
        for mode in ("", "mode: 'no-cors', "):
            changed_options = options.replace("{method", f"{{{mode}method", 1)
            page.evaluate(f"fetch('{served.url}/answer', {changed_options}).catch(() => null)")
    page.wait_for_timeout(500)
    frames = [frame for frame in page.frames if frame != page.main_frame]
    assert all(frame.locator("#sliders").count() == 0 for frame in frames)
    assert computed == []
    page.close()


def test_everyone_can_read_it(opened: Opened) -> None:
    """What an automatic check of accessibility can see."""
    assert opened.page.locator("label").count() == len(SLIDERS)
    found = Axe().run(opened.page)
    assert found.violations_count == 0, found.generate_report()


def test_it_fits_a_narrow_window(browser: Browser, served: Served) -> None:
    page = browser.new_page(viewport={"width": 380, "height": 700})
    page.goto(served.url)
    expect(page.locator("#curve")).to_have_attribute("aria-busy", "false", timeout=PATIENCE)
    assert page.evaluate("document.documentElement.scrollWidth") <= 380
    page.close()
