"""The joint to play with: its state, what is copied, and the page in a browser."""

import shutil
import threading
from collections.abc import Iterator
from dataclasses import replace

import pytest
import yaml
from axe_playwright_python.sync_playwright import Axe
from hypothesis import given
from hypothesis import strategies as st
from playwright.sync_api import sync_playwright
from werkzeug.serving import make_server

from analysis.explore.app import LOOPBACK, SLIDERS, drawn, make_app, playing, shown
from analysis.explore.pictures import answers, curve, drawing, peak
from analysis.explore.state import Playing, as_configuration, as_python, as_query, from_query
from sidmacib.chain.rule import law
from sidmacib.joint import Direction
from workflow.configuration import read_study

CHROMIUM = shutil.which("chromium")
STATES = (
    Playing(),
    Playing(locks=9, H=60.0, one_piece=True, young=10.0),
    Playing(locks=4, friction=0.0, pressure=50.0, eccentricity=0.0),
)


@pytest.mark.parametrize("state", STATES)
def test_a_link_brings_the_joint_back(state: Playing) -> None:
    assert from_query("?" + as_query(state)) == state


@given(st.text(max_size=60))
def test_whatever_a_link_says_there_is_a_joint(query: str) -> None:
    assert from_query(query).joint


def test_what_is_not_possible_in_a_link_is_left() -> None:
    assert from_query("?a=-5&b=inf&locks=zero&magic=1") == Playing()


@pytest.mark.parametrize("state", STATES)
def test_the_configuration_is_a_study_of_the_same_joint(state: Playing) -> None:
    study = read_study(yaml.safe_load(as_configuration(state).replace("e+", "e")))
    joint, own = study.joint("mine"), state.joint
    for name in ("locks", "a", "b", "h", "H", "upper_body", "hold_down", "elastic"):
        assert getattr(joint, name) == getattr(own, name), name
    assert joint.inner.cohesion == own.inner.cohesion
    assert joint.dry.friction == own.dry.friction


@pytest.mark.parametrize("state", STATES)
def test_the_python_prints_the_law_of_the_same_joint(
    state: Playing, capsys: pytest.CaptureFixture[str]
) -> None:
    exec(as_python(state), {})
    expected = law(state.joint, Direction(state.eccentricity)).load
    assert f"{expected:.6g}"[:6] in capsys.readouterr().out


def test_a_joint_beyond_the_rule_is_told_and_drawn() -> None:
    state = Playing(a=150.0, b=20.0)
    told = answers(state)
    assert told.rules == {}
    assert "No safe rule: a / b: 7.5" in told.words
    assert told.peak is not None
    assert drawing(state).layout.shapes


def test_the_drawing_has_every_piece() -> None:
    columns, whole = (drawing(Playing(locks=4, one_piece=one)) for one in (False, True))
    assert len(columns.layout.shapes) == 1 + 4 + 4
    assert len(whole.layout.shapes) == 1 + 4 + 1


def test_peaks_fall_with_the_eccentricity() -> None:
    shears = [peak(Playing().joint, ratio).shear for ratio in (0.0, 0.1, 0.3, 1.0)]
    assert shears == sorted(shears, reverse=True)


def test_the_curve_tells_how_far_the_peak_spreads_and_what_counts_where_it_is_too_far() -> None:
    def legend(state: Playing) -> str:
        return str(curve(state, answers(state)).data[0].name)

    assert legend(Playing(eccentricity=0.3)).endswith("(spread 0.0 % at 0.3 a)")
    far = legend(Playing(locks=31, eccentricity=0.3))
    assert "peaks spread by 24 % or more: count on the first failure, V = 2" in far
    assert "spread" not in legend(Playing(young=10.0))


def values(state: Playing) -> list[float]:
    """The sliders' values, in their order."""
    return [float(getattr(state, name)) for name in SLIDERS]


def test_what_is_shown_follows_the_sliders() -> None:
    before, after = (shown(*values(replace(Playing(), H=height))) for height in (27.0, 80.0))
    assert before[3] != after[3]
    assert "H: 0.08" in after[4]
    assert drawn(before[0]) != drawn(after[0])


@pytest.mark.parametrize("state", STATES)
def test_sliders_say_what_the_state_is(state: Playing) -> None:
    assert playing(values(state)) == state


@pytest.fixture(scope="module")
def served() -> Iterator[str]:
    server = make_server(LOOPBACK, 0, make_app().server, threaded=True)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://{LOOPBACK}:{server.port}"
    server.shutdown()
    thread.join()


@pytest.mark.study
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_the_page_follows_while_a_slider_moves(served: str) -> None:
    errors: list[str] = []
    requests: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on(
            "console",
            lambda message: errors.append(message.text) if message.type == "error" else None,
        )
        page.on("request", lambda request: requests.append(request.url))
        page.goto(f"{served}/?locks=7")
        page.wait_for_function("document.getElementById('yaml')?.textContent.includes('locks: 7')")
        before = page.text_content("#words")
        page.focus("#locks")
        page.keyboard.press("ArrowRight")
        page.wait_for_function("document.getElementById('yaml').textContent.includes('locks: 8')")
        page.wait_for_function(
            "before => document.getElementById('words').textContent !== before", arg=before
        )
        assert page.locator("label").count() >= len(SLIDERS)
        found = Axe().run(page)
        assert found.violations_count == 0, found.generate_report()
        browser.close()
    assert errors == []
    assert all(url.startswith((served, "data:", "blob:")) for url in requests)
