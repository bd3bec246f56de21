"""What the explorer's page of structures answers: examples, their sliders, and its models."""

import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from explorer import Answered, Served, explorer

from analysis.explore import app, structures
from analysis.explore.examples import (
    EXAMPLES,
    STRUCTURE_SLIDERS,
    STUDIES,
    Chosen,
    checked_choice,
    choice_in,
    defaults,
)
from analysis.explore.structures import limit, static, structure_answer
from sidmacib.command.structures import structure_rows
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.yaml_text import parsed, read_yaml

QUICK = sorted(EXAMPLES.keys() - {"vault"})


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with explorer() as found:
        yield found


def ask(served: Served, values: object, number: int = 1) -> Answered:
    return served.post("/structure", {"page": "test", "number": number, "values": values})


def chosen(**given: object) -> Chosen:
    found = checked_choice(given)
    assert found.notes == ()
    return found.state


# --- examples ------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_opens_as_its_file_has_it(name: str) -> None:
    path = STUDIES / EXAMPLES[name].file
    ours, theirs = structure_of(chosen(structure=name).description), structure_of(read_yaml(path))
    assert [face.material for face in ours.assembly.faces] == [
        face.material for face in theirs.assembly.faces
    ]
    assert np.array_equal(ours.assembly.nodes.position, theirs.assembly.nodes.position)
    assert ours.loads.axis == theirs.loads.axis
    assert ours.loads.variable == pytest.approx(theirs.loads.variable)


@pytest.mark.parametrize("name", EXAMPLES)
def test_defaults_are_on_the_sliders(name: str) -> None:
    first = defaults(name)
    assert list(first) == list(EXAMPLES[name].sliders)
    for slider, value in first.items():
        assert STRUCTURE_SLIDERS[slider].nearest(value) == pytest.approx(value)


def test_sliders_change_what_they_are_called_after() -> None:
    arch = chosen(structure="arch", friction=0.5, cohesion=20, tensile_strength=7).description
    assert arch["interfaces"] == {
        "friction": 0.5,
        "cohesion": 20e3,
        "tensile_strength": 7e3,
    }
    assert chosen(structure="arch", azimuth=90).description["load"]["acceleration"] == [0, 1, 0]
    up = chosen(structure="vault", slope=30, azimuth=180).description["load"]["force"]
    assert up["direction"] == pytest.approx([-(0.75**0.5), 0, 0.5])
    assert up["block"] == "block22"
    keyed = chosen(structure="keyed", locks=7, friction=0.2, cohesion=50).description["locks"][0]
    assert (keyed["count"], keyed["dry"]["friction"], keyed["inner"]["cohesion"]) == (7, 0.2, 50e3)
    trilith = chosen(structure="trilith", cohesion=30).description["special"][0]
    assert (trilith["cohesion"], trilith["tensile_strength"]) == (30e3, 5e3)


def test_gravity_turns_towards_the_chosen_direction() -> None:
    for azimuth in (-180, 0, 35):
        problem = structure_of(chosen(structure="stack", azimuth=azimuth).description)
        assert problem.loads.axis is not None
        leaning = np.cross(problem.loads.axis, (0, 0, -1))  # of gravity, as it begins to turn
        angle = np.radians(azimuth)
        assert leaning == pytest.approx([np.cos(angle), np.sin(angle), 0], abs=1e-8)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_file_to_keep_is_the_structure_that_was_computed(name: str) -> None:
    state = chosen(structure=name, friction=0.55)
    assert parsed(state.text.encode()) == state.description


def test_a_link_holds_the_whole_state() -> None:
    state = chosen(structure="keyed", locks=7, azimuth=-45, slope=5, friction=0.15, model="limit")
    assert choice_in(state.query).state == state
    assert chosen(structure="wall").query == "structure=wall"
    assert choice_in("") == checked_choice({})


@pytest.mark.parametrize(
    ("given", "note"),
    [
        ({"structure": "palace"}, "structure: 'palace' is not one of arch, wall, trilith"),
        ({"structure": ["arch"]}, "structure: 'list' is not one of"),
        ({"model": "yade"}, "model: 'yade' is not one of static, limit; static is shown."),
        ({"friction": 1e9}, "friction: 1e+09 is outside 0 to 1; 1 is shown."),
        ({"cohesion": "<b>"}, "cohesion: '<b>' is not a number; 0 is shown."),
        ({"locks": 5}, "'locks' is no parameter."),  # an arch has none
        ({"structure": "keyed", "locks": 10**400}, "locks: inf is outside 1 to 15; 15 is shown."),
        ({"azimuth": float("nan")}, "azimuth: 'float' is not a number; 0 is shown."),
    ],
)
def test_what_the_page_does_not_allow_is_brought_to_it_with_a_note(
    given: dict[str, object], note: str
) -> None:
    found = checked_choice(given)
    assert len(found.notes) == 1
    assert found.notes[0].startswith(note)
    sliders = EXAMPLES[found.state.example].sliders
    for name, value in found.state.values:
        assert sliders[name].least <= value <= sliders[name].most


# --- answers -------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", QUICK)
def test_its_numbers_are_those_that_the_command_prints_for_the_file(name: str) -> None:
    state = chosen(structure=name)
    rows = structure_rows(structure_of(parsed(state.text.encode())))
    printed = {str(row["model"]): row for row in rows}
    unit = "tilt (degrees)" if EXAMPLES[name].tilts else "load (N)"
    error = "mesh error / tilt" if EXAMPLES[name].tilts else "mesh error / load"
    for line, model in zip(structure_answer(state)["lines"], ("limit", "static"), strict=False):
        assert line[1] == pytest.approx(printed[model][unit], rel=2e-5)
        assert line[3] == pytest.approx(100 * (printed[model][error] or 0.0), rel=1e-3, abs=1e-3)
        if not EXAMPLES[name].tilts:
            assert line[2] == pytest.approx(printed[model]["load / weight"], rel=2e-5)


def test_what_is_drawn_belongs_to_the_model_that_is_chosen() -> None:
    for model, record in (("limit", limit), ("static", static)):
        answer = structure_answer(chosen(structure="trilith", model=model))
        expected = record(chosen(structure="trilith"))
        assert answer["row"]["model"] == model
        assert answer["row"]["load_N"] == pytest.approx(expected.load_N, rel=1e-5)
        names = [each["interface"] for each in answer["interfaces"]]
        assert names == [each["name"] for each in answer["shape"]["interfaces"]]
        assert [each["block"] for each in answer["blocks"]] == [
            each["name"] for each in answer["shape"]["blocks"]
        ]


def test_locks_that_are_drawn_are_those_that_were_chosen() -> None:
    for locks in (1, 4):
        answer = structure_answer(chosen(structure="keyed", locks=locks))
        drawn = {each["name"] for each in answer["shape"]["interfaces"]}
        assert drawn == {each["interface"] for each in answer["interfaces"]}
        assert sum("lock" in name for name in drawn) >= locks


def test_a_model_without_an_answer_says_why() -> None:
    answer = structure_answer(chosen(structure="arch", friction=0.1))
    (limit_line, static_line) = answer["lines"]
    assert limit_line[1:] == [
        None,
        None,
        None,
        "The structure does not stand under its own weight",
    ]
    assert static_line[4] == "The structure does not stand under its own weight"
    assert "no answer" in answer["words"] and static_line[4] in answer["words"]
    assert answer["shape"]["blocks"] and answer["yaml"]


def test_a_peak_that_depends_on_the_mesh_is_not_the_answer() -> None:
    answer = structure_answer(chosen(structure="arch", cohesion=50, tensile_strength=20))
    lines = {line[0]: line for line in answer["lines"]}
    counts, peak = lines["static model"], lines["static model, peak"]
    assert counts[1] < peak[1] / 2.0 and counts[3] < 1.0
    assert peak[3:] == [None, "does not count"]
    words = f"first bond failure at {counts[1]:.4g} N, {counts[2]:.3g} of the weight; the first"
    assert words in answer["words"]


def test_the_first_failure_stands_beside_a_peak_that_counts() -> None:
    lines = {line[0]: line for line in structure_answer(chosen(structure="trilith"))["lines"]}
    first = lines["static model, first failure"]
    assert first[1] < lines["static model"][1] / 4.0
    assert first[4] == "at left-lintel"


def test_a_fault_in_one_model_is_a_line_and_the_other_model_is_shown(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(*given: object) -> None:
        raise ArithmeticError("no matrix")

    state = chosen(structure="wall", friction=0.37)
    monkeypatch.setattr(structures.structure_static, "solve", broken)
    lines = structure_answer(state)["lines"]
    assert lines[0][1] > 0
    assert lines[1] == ["static model", None, None, None, "no matrix"]


# --- requests ------------------------------------------------------------------------------------
def test_a_request_is_answered_for_what_the_sliders_allow(served: Served) -> None:
    found = ask(served, {"structure": "wall", "friction": 7}, number=3)
    assert found.status == 200, found.text
    assert found.content["number"] == 3
    assert found.content["values"] == defaults("wall") | {"friction": 1.0}
    assert found.content["notes"] == ["friction: 7 is outside 0 to 1; 1 is shown."]
    assert found.content["link"] == f"{served.url}/structures?structure=wall&friction=1"


def test_a_superseded_request_is_dropped_between_models(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[str] = []
    newer: list[Answered] = []

    def send() -> None:
        newer.append(ask(served, {"structure": "wall"}, number=8))

    thread = threading.Thread(target=send)

    def first(state: Chosen) -> None:
        seen.append(f"first {state.example}")
        if state.example == "arch":
            thread.start()
            while served.newest()[1] < 8:  # the newer request arrives, and waits
                time.sleep(0.001)

    def second(state: Chosen) -> None:
        seen.append(f"second {state.example}")

    monkeypatch.setattr(app, "STAGES", (first, second))
    monkeypatch.setattr(app, "structure_answer", lambda state: {})
    assert ask(served, {"structure": "arch"}, number=7).status == 204
    thread.join()
    assert newer[0].status == 200
    assert seen == ["first arch", "first wall", "second wall"]


def test_the_page_opens_as_its_link_says_and_shows_text_as_text(served: Served) -> None:
    found = served.get("/structures?structure=keyed&locks=99&%3Cscript%3E=1")
    assert found.status == 200
    assert '<option value="keyed"' in found.text and "locks: 99 is outside 1 to 15" in found.text
    assert "&#39;&lt;script&gt;&#39; is no parameter." in found.text
    assert "'<script>'" not in found.text
    assert 'href="/structures"' in served.get("/").text and 'href="/"' in found.text


@pytest.mark.parametrize(
    "headers",
    [{"Origin": "http://evil.example"}, {"Host": "evil.example"}, {"Sec_Fetch_Site": "cross-site"}],
)
def test_structures_are_computed_for_this_page_only(
    served: Served, headers: dict[str, str]
) -> None:
    found = served.post("/structure", {"page": "x", "number": 1, "values": {}}, **headers)
    assert found.status == 403


def test_another_site_may_link_to_the_page_but_not_frame_it(served: Served) -> None:
    site = {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "navigate"}
    assert served.get("/structures", **site, Sec_Fetch_Dest="document").status == 200
    assert served.get("/structures", **site, Sec_Fetch_Dest="iframe").status == 403
