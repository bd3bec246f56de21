"""The joint to play with: its state, what is copied, and the page in a browser."""

import json
import re
from dataclasses import replace

import pytest
import yaml
from command_runner import run
from hypothesis import given
from hypothesis import strategies as st

from analysis.explore.pictures import Counted, answers, covered, effects, pictures, which_counts
from analysis.explore.state import (
    SLIDERS,
    Checked,
    Settings,
    as_configuration,
    as_python,
    checked,
    compared,
    from_query,
)
from sidmacib import Direction, NodeLayout, law, static_first_failure
from sidmacib.answers.joint import meshes
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.parameters import PARAMETERS
from workflow.configuration import read_study

STATES = (
    Settings(),
    Settings(locks=3, H=60.0, one_piece=True, young=10.0),
    Settings(locks=4, friction=0.0, pressure=50.0, eccentricity=0.0),
    Settings(a=15.0, b=20.0),
    Settings(locks=9, scatter=20.0, gamma_m=1.5),
    checked({name: slider.least + 9 * slider.step for name, slider in SLIDERS.items()}).state,
)


@pytest.mark.parametrize("state", STATES)
def test_a_link_brings_the_joint_back(state: Settings) -> None:
    found = from_query("?" + state.query, checked)
    assert found.state == state
    assert found.notes == ()


@given(st.text(max_size=60))
def test_whatever_a_link_says_there_is_a_joint(query: str) -> None:
    assert from_query(query, checked).state.joint


def test_values_of_a_link_that_are_not_allowed_are_noted_and_limited_to_the_sliders() -> None:
    found = from_query("?a=-5&b=inf&locks=zero&magic=1&h=8.2", checked)
    assert found.state == Settings(a=15.0, b=100.0)
    assert found.notes == (
        "a: -5 is outside 15 to 150; 15 is shown.",
        "b: inf is outside 20 to 100; 100 is shown.",
        "locks: 'zero' is not a number; 5 is shown.",
        "'magic' is no parameter.",
        "h: 8.2 lies between steps of 0.5; 8 is shown.",
    )


@given(st.fixed_dictionaries({name: st.floats() for name in SLIDERS}))
def test_whatever_is_posted_lies_on_the_sliders(values: dict[str, float]) -> None:
    found = checked(values).state
    assert found.joint
    for name, value in found.values.items():
        slider = SLIDERS[name]
        assert slider.least <= value <= slider.most
        assert slider.nearest(value) == value


@pytest.mark.parametrize("state", STATES)
def test_the_configuration_is_a_study_of_the_same_joint(state: Settings) -> None:
    study = read_study(yaml.safe_load(as_configuration(state).replace("e+", "e")))
    joint, expected = study.joint("mine"), state.joint
    for name in {*PARAMETERS} & {*SLIDERS, "upper_body", "hold_down", "poisson"}:
        assert PARAMETERS[name].of(joint) == PARAMETERS[name].of(expected), name
    assert study.meshes == pytest.approx(sorted(meshes(expected), reverse=True))
    assert study.nodes is NodeLayout.LOBATTO


@pytest.mark.parametrize("state", [*STATES[:-1], replace(STATES[-1], young=0.0)])
def test_the_script_prints_the_law(state: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    exec(as_python(state), {})
    expected = law(state.joint, Direction(state.eccentricity)).load
    printed = re.search(r"load=([\d.]+)", capsys.readouterr().out)
    assert printed and float(printed[1]) == pytest.approx(expected, rel=1e-5)


def test_resistances_are_those_of_the_command() -> None:
    state = Settings(locks=9, a=80.0, H=60.0, scatter=20.0, gamma_m=1.5)
    flags = ("-n", "9", "-a", "80mm", "-H", "60mm", "-e", "0.3", "--scatter", "0.2")
    found = run("capacity", *flags, "--gamma-m", "1.5", "--format", "json")
    printed = {row["model"]: row["V_N"] for row in json.loads(found.stdout)["rows"]}
    shown = {name: load.shear for name, load in answers(state).rules.items()}
    assert shown == {name: pytest.approx(printed[name], rel=1e-9) for name in shown}
    assert {"safe", "characteristic", "design"} <= shown.keys()
    assert "characteristic" not in answers(replace(state, scatter=0.0)).rules


def test_a_joint_beyond_the_rule_is_noted_and_drawn() -> None:
    state = Settings(H=150.0, b=20.0)
    answer = answers(state)
    assert answer.rules == {}
    assert "No safe rule: H / b: 7.5" in answer.words
    assert answer.peak is not None
    assert pictures(state, answer)["pieces"]


@pytest.mark.long
def test_the_curve_states_the_lowest_peak_found_where_it_is_below_the_curve() -> None:
    near = which_counts(Settings(eccentricity=0.3))
    assert (near.legend, near.words) == (" (no lower peak found at 0.3 a)", "")
    far = which_counts(Settings(locks=11, eccentricity=1.0, one_piece=False))
    assert far.words.startswith("The load that counts is the lowest peak found: V = ")
    assert which_counts(Settings(young=10.0)) == Counted()


@pytest.mark.parametrize("name", ["a", "b", "h", "H"])
def test_the_law_answers_at_ends_of_a_range_and_not_a_tenth_of_a_slider_beyond(name: str) -> None:
    state, slider = Settings(locks=5), SLIDERS[name]
    span = covered(state)[name]
    assert span is not None
    tenth = (slider.most - slider.least) / 10
    for end in span:
        assert law(replace(state, **{name: end}).joint, Direction(0.3)).load > 0
    for beyond in (span[0] - tenth, span[1] + tenth):
        if slider.least <= beyond <= slider.most:
            with pytest.raises(ValueError, match="where the rule was tested"):
                law(replace(state, **{name: beyond}).joint, Direction(0.3))


# --- comparison ----------------------------------------------------------------------------------
def test_a_link_brings_back_what_is_kept_and_notes_what_was_changed_of_it() -> None:
    kept, shown = Settings(locks=9), Settings(a=80.0)
    found = from_query(Checked(shown, (), kept).query, checked)
    assert (found.state, found.kept, found.notes) == (shown, kept, ())
    assert from_query(Checked(shown, (), Settings()).query, checked).kept == Settings()
    wrong = from_query("kept=locks%3D99%26kept%3Dx", checked)
    assert wrong.kept == Settings(locks=31)
    assert wrong.notes == (
        "Kept: locks: 99 is outside 2 to 31; 31 is shown.",
        "Kept: 'kept' is no parameter.",
    )


def test_two_variants_are_compared_in_what_differs_and_in_all_results() -> None:
    shown, kept = {"a": 3.0, "same": 1.0, "kind": "x"}, {"a": 4.0, "same": 1.0 + 1e-12, "b": 0.0}
    less = "\N{MINUS SIGN}1", "\N{MINUS SIGN}25.0 %"
    assert compared((shown, kept), ({"V": 2.0, "M": 1.0}, {"V": 0.0, "M": 1.000001})) == [
        ["a", 4.0, 3.0, *less],
        ["kind", "\N{EN DASH}", "x", "", ""],
        ["b", 0.0, "\N{EN DASH}", "", ""],
        ["V", 0.0, 2.0, "+2", ""],
        ["M", 1.000001, 1.0, "0", "0.0 %"],  # the same in four digits
    ]
    many = {str(number): float(number) for number in range(100)}
    assert compared((many, {}), ({}, {}))[-1][0] == "and 80 more"


@pytest.mark.long
# --- effects ------------------------------------------------------------------------------------
def test_an_arrow_points_to_where_the_first_failure_is_larger() -> None:
    state = Settings(locks=5, eccentricity=0.3, pressure=50.0)
    found, loading = effects(state), Loading(Direction(state.eccentricity))
    assert found.keys() == {"a", "b", "h", "H", "cohesion", "friction", "pressure"}
    for name, said in found.items():
        value = state.values[name]
        joints = [replace(state, **{name: value * share}).joint for share in (0.98, 1.02)]
        less, more = (
            static_first_failure(*posed(joint, loading, meshes(joint)[1])).point.load
            for joint in joints
        )
        rise = 100.0 * (more - less) / (more + less) / 2.0
        arrow, number, _ = said.split(" ")
        assert arrow == ("\N{RIGHTWARDS ARROW}" if rise > 0.0 else "\N{LEFTWARDS ARROW}")
        assert float(number.replace("\N{MINUS SIGN}", "-")) == pytest.approx(rise, abs=0.02)
    smooth = replace(state, friction=0.0, pressure=0.0)
    assert effects(smooth).keys() == found.keys() - {"friction", "pressure"}
