"""What the explorer answers: to any request, and of structures."""

import threading
import time
from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from explorer import Answered, Served

from analysis.explore import pictures
from analysis.explore.examples import (
    EXAMPLES,
    STUDIES,
    Chosen,
    checked_choice,
    defaults,
)
from analysis.explore.numbers import numbers_of, put_numbers
from analysis.explore.pictures import Answers
from analysis.explore.state import SLIDERS, Settings, from_query
from analysis.explore.structures import structure_answer
from sidmacib.answers.ask import Solved
from sidmacib.command.answers import Row
from sidmacib.command.structures import structure_rows
from sidmacib.structure.files.structure_file import Demand, structure_of
from sidmacib.yaml_text import parsed, read_yaml

QUICK = sorted(EXAMPLES.keys() - {"vault"})


def chosen(**given: object) -> Chosen:
    found = checked_choice(given)
    assert found.notes == ()
    return found.state


# --- examples ------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_opens_and_is_kept_as_its_file_has_it(name: str) -> None:
    path = STUDIES / EXAMPLES[name].file
    ours, theirs = structure_of(chosen(structure=name).description), structure_of(read_yaml(path))
    laws, known = ([face.material for face in each.assembly.faces] for each in (ours, theirs))
    assert laws == known
    assert np.array_equal(ours.assembly.nodes.position, theirs.assembly.nodes.position)
    assert ours.loads.raised.axis == theirs.loads.raised.axis
    assert ours.loads.variable == pytest.approx(theirs.loads.variable)
    state = chosen(structure=name, friction=0.55)
    assert parsed(state.text.encode()) == state.description  # the file to keep


def test_a_link_holds_the_whole_state() -> None:
    state = chosen(structure="keyed", locks=7, azimuth=-45, slope=5, friction=0.15, model="limit")
    assert from_query(state.query, checked_choice).state == state
    assert chosen(structure="wall").query == "structure=wall"
    assert from_query("", checked_choice) == checked_choice({})


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
def test_what_is_not_allowed_is_changed_with_a_note(given: dict[str, object], note: str) -> None:
    found = checked_choice(given)
    assert len(found.notes) == 1
    assert found.notes[0].startswith(note)
    sliders = EXAMPLES[found.state.example].sliders
    for name, value in found.state.values:
        assert sliders[name].least <= value <= sliders[name].most


# --- answers -------------------------------------------------------------------------------------
def command_rows(description: Any) -> list[Row]:
    return structure_rows(Solved.of(Demand(structure_of(description))))


@pytest.mark.long
@pytest.mark.parametrize("name", QUICK)
def test_its_table_is_what_the_command_prints_for_the_file(name: str) -> None:
    state = chosen(structure=name)
    rows = command_rows(parsed(state.text.encode()))
    answer = structure_answer(state)
    assert [dict(zip(answer["head"], row, strict=True)) for row in answer["rows"]] == rows


def test_a_model_without_an_answer_says_why() -> None:
    answer = structure_answer(chosen(structure="arch", friction=0.1))
    words = "The structure does not stand under its own weight"
    for row in answer["rows"]:
        assert row[1] is None and row[-1] == words
    assert words in answer["words"]
    assert answer["shape"]["blocks"] and answer["yaml"]


# --- requests ------------------------------------------------------------------------------------
def test_a_request_is_answered_for_what_the_sliders_allow(served: Served) -> None:
    asked = {"page": "wall", "number": 3, "values": {"structure": "wall", "friction": 7}}
    found = served.post("/structure", asked)
    assert found.status == 200, found.text
    assert found.content["number"] == 3
    assert found.content["values"] == defaults("wall") | {"friction": 1.0}
    assert found.content["notes"] == ["friction: 7 is outside 0 to 1; 1 is shown."]
    assert found.content["link"] == f"{served.url}/structures?structure=wall&friction=1"


def test_the_page_opens_as_its_link_says_and_shows_text_as_text(served: Served) -> None:
    found = served.get("/structures?structure=keyed&locks=99&%3Cscript%3E=1")
    assert found.status == 200
    assert '<option value="keyed"' in found.text and "locks: 99 is outside 1 to 15" in found.text
    assert "&#39;&lt;script&gt;&#39; is no parameter." in found.text
    assert "'<script>'" not in found.text
    assert 'href="/structures"' in served.get("/").text and 'href="/"' in found.text


# --- files ---------------------------------------------------------------------------------------
CUBE = """blocks: {ground: {low: [0, 0, -0.1], high: [1, 1, 0], fixed: true}, \
cube: {low: [0.3, 0.3, 0], high: [0.5, 0.5, 0.2]}}
interfaces: {friction: 0.4}
"""


def send(served: Served, *names: str, **texts: str) -> Answered:
    """Files of studies/ by name, and others by their texts."""
    files = {Path(name).name: (STUDIES / name).read_bytes() for name in names}
    files |= {name.replace("_", "."): text.encode() for name, text in texts.items()}
    values = {"files": [{"name": n, "data": b64encode(d).decode()} for n, d in files.items()]}
    return served.post("/file", {"page": "files", "number": 1, "values": values})


@pytest.mark.long
def test_a_file_that_is_sent_opens_as_the_page_of_the_command(served: Served) -> None:
    assert served.get("/opened").status == 404
    page = send(served, "structures/trilith.yaml").content["page"]
    assert page == "/opened?file=1"
    opened = served.get(page)
    assert opened.status == 200
    assert "script-src 'unsafe-inline'" in opened.headers["Content-Security-Policy"]
    rows = command_rows(read_yaml(STUDIES / "structures/trilith.yaml"))
    for row in rows:
        assert row["note"] in opened.text
    assert "multilock assembly trilith.yaml" in opened.text


def test_blocks_come_with_the_yaml_that_says_what_they_lack(served: Served) -> None:
    cube = trimesh.creation.box(bounds=[(0, 0, 0), (1, 1, 1)]).export(file_type="obj")
    yaml = CUBE.replace("{low: [0.3, 0.3, 0], high: [0.5, 0.5, 0.2]}", "{file: x.obj}")
    yaml += "load: {acceleration: [1, 0, 0]}\n"
    found = send(served, x_obj=cube, x_yaml=yaml).content
    assert found["error"] is None
    assert "Peak at 7848 N, 0.4 of the weight" in served.get(found["page"]).text


def test_several_structures_are_opened_one_by_one(served: Served) -> None:
    text = CUBE + "load: {acceleration: [1, 0, 0]}\n"
    error = send(served, a_yaml=text, b_yaml=text).content["error"]
    assert error == "a.yaml, b.yaml: are 2 structures; open them one by one"


def test_a_changed_number_opens_the_changed_file(served: Served) -> None:
    """A block that slides at its friction, which is changed from 0.4 to 0.5 and on to 0.6."""
    page = send(served, cube_yaml=CUBE + "load: {acceleration: [1, 0, 0]}\n").content["page"]
    of = int(page.partition("file=")[2])
    for friction, load in ((0.5, "78.48"), (0.6, "94.18")):
        values = {"of": of, "numbers": {"interfaces.friction": friction}}
        found = served.post("/file", {"page": "f", "number": of, "values": values}).content
        of = int(found["page"].partition("file=")[2])
        text = served.get(found["page"]).text
        assert f"Peak at {load} N" in text
        assert f"changed here: interfaces.friction 0.4 \N{RIGHTWARDS ARROW} {friction}" in text
        assert f'data-number="interfaces.friction" value="{friction}"' in text
    values["numbers"] = {"interfaces.friction": -1.0}
    found = served.post("/file", {"page": "f", "number": 9, "values": values}).content
    assert "interfaces.friction: -1.0 is not allowed" in found["error"]
    values["of"] = 999
    found = served.post("/file", {"page": "f", "number": 9, "values": values}).content
    assert "no longer in memory" in found["error"]


def test_numbers_keep_their_kind_and_unit() -> None:
    description = {
        "blocks": {"1": {"low": [0, 0, 0], "density": "2.1t/m3", "scale": 2, "fixed": True}},
        "interfaces": {"friction": 0.7, "cohesion": 0},
        "locks": [{"between": ["1", "2"], "first": "2", "count": 3, "height": "20 mm"}],
    }
    shown = {each.name: (each.value, each.unit, *each.slider) for each in numbers_of(description)}
    assert shown == {
        "interfaces.friction": (0.7, "", 0.0, 1.4, 0.01),
        "interfaces.cohesion": (0.0, "", 0.0, 0.0, 0.0),
        "locks.1.count": (3.0, "", 1.0, 10.0, 1.0),
        "locks.1.height": (20.0, "mm", 0.0, 40.0, 0.4),
        "blocks.1.density": (2.1, "t/m3", 0.0, 4.2, 0.04),
    }
    told = put_numbers(description, {"locks.1.count": 4.0, "locks.1.height": 25.0})
    arrow = "\N{RIGHTWARDS ARROW}"
    assert told == [f"locks.1.count 3 {arrow} 4", f"locks.1.height 20 {arrow} 25 mm"]
    assert repr(description["locks"][0]["count"]) == "4"
    assert description["locks"][0]["height"] == "25.0mm"


def test_of_load_cases_the_one_that_governs_opens(served: Served) -> None:
    cases = "load_cases: {wind: {acceleration: [1, 0, 0], newtons: 30}, "
    cases += "big one: {acceleration: [0, 1, 0], newtons: 50}}\n"
    opened = served.get(send(served, cases_yaml=CUBE + cases).content["page"]).text
    assert "with a factor of 1.26" in opened  # 0.4 times 156.96 N over 50 N
    assert "multilock assembly cases.yaml --case &#39;big one&#39;" in opened
    none = send(served, x_yaml=CUBE).content["error"]
    assert none.startswith("load: missing; give one, such as load: {acceleration")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("blocks: {}", "blocks"),
        ("load: {acceleration: [1, 0, 0]}", "blocks: missing"),
        ("{", "not YAML"),
    ],
)
def test_a_file_of_other_things_is_refused_in_a_line(served: Served, text: str, error: str) -> None:
    found = send(served, x_yaml=text).content
    assert found["page"] is None
    assert error in found["error"]
    assert "\n" not in found["error"]


def test_requests_of_files_are_checked(served: Served) -> None:
    asked = {"page": "files", "number": 2, "values": {"files": [{"name": "..", "data": ""}]}}
    assert "must be the name of a file" in served.post("/file", asked).content["error"]
    asked["values"]["files"][0]["name"] = 305 * "a"
    assert "a file (File name too long)" in served.post("/file", asked).content["error"]
    assert served.post("/file", {**asked, "values": {"files": "x"}}).status == 400
    assert served.post("/file", {**asked, "values": {"files": [], "of": "x"}}).status == 400
    assert served.get("/opened?file=999").status == 404


# --- what the explorer answers, and to whom: real requests, also hostile ones --------------------
FIRST = Settings().values
ASKED = {"page": "x", "number": 1, "values": {}}
POSTS = ("/answer", "/curve", "/structure", "/file")


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Locks of the joints that are computed; each takes a moment."""
    found: list[int] = []

    def slow(state: Settings) -> Answers:
        found.append(state.locks)
        time.sleep(0.2)
        return Answers(None, {}, "slow")

    monkeypatch.setattr(pictures, "answers", slow)
    return found


# --- values that the sliders do not have ---------------------------------------------------------


def test_text_from_a_link_is_shown_as_text(served: Served) -> None:
    found = served.get("/?%3Cscript%3E=1&a=%3Cb%3E&b=nan&h=")
    assert "<script>&#39;" not in found.text and "<b>" not in found.text
    assert "&#39;&lt;script&gt;&#39; is no parameter." in found.text
    assert "a: &#39;&lt;b&gt;&#39; is not a number; 60 is shown." in found.text
    assert "b: &#39;nan&#39; is not a number" in found.text
    assert "h: &#39;&#39; is not a number" in found.text


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ({"locks": 10**400, "a": float("-inf")}, {"locks": 31, "a": 15}),
        ({"locks": float("nan")}, {}),
        ({"locks": [31]}, {}),
        ({"locks": 7.4}, {"locks": 7}),
        ({"friction": 30, "pressure": -1}, {"friction": 0.8, "pressure": 0}),
    ],
)
def test_a_post_has_only_values_of_the_sliders(
    served: Served, values: dict[str, object], shown: dict[str, float]
) -> None:
    found = served.ask(values)
    assert found.status == 200, found.text
    assert found.content["values"] == FIRST | shown
    assert len(found.content["notes"]) == len(values)
    for name, value in found.content["values"].items():
        assert SLIDERS[name].least <= value <= SLIDERS[name].most


@pytest.mark.parametrize(
    "body",
    [
        *("", "null", "not json", '{"page": "x", "number": 1}'),
        '{"page": "x", "number": 1, "values": [5]}',
        '{"page": "x", "number": 1.5, "values": {}}',
        '{"page": "", "number": 1, "values": {}}',
    ],
)
@pytest.mark.parametrize("path", ["/answer", "/curve"])
def test_a_post_that_no_page_would_send_is_refused(served: Served, path: str, body: str) -> None:
    found = served.post(path, body)
    assert found.status == 400
    assert found.text.startswith("400 Bad Request: ") and found.text.count("\n") == 1


# --- other pages ---------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_this_machine_is_answered_by_its_names(served: Served, name: str) -> None:
    assert served.get("/", Host=f"{name}:{served.port}").status == 200


def refused(served: Served, **headers: str) -> bool:
    """Whether no question of a page with these ``headers`` is answered."""
    return all(served.post(path, ASKED, **headers).status == 403 for path in POSTS)


@pytest.mark.parametrize(
    "host",
    ["evil.example:{}", "127.0.0.1:1", "127.0.0.1:{}.evil.example", "127.0.0.1:{}@a.example"],
)
def test_a_name_that_somebody_points_here_is_refused(served: Served, host: str) -> None:
    found = served.get("/", Host=host.format(served.port))
    assert found.status == 403
    assert f"127.0.0.1:{served.port}, localhost:{served.port}" in found.text
    assert refused(served, Host=host.format(served.port))


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1:{}"]
)
def test_a_foreign_origin_is_refused(served: Served, origin: str, computed: list[int]) -> None:
    url = origin.format(served.port)
    assert refused(served, Origin=url)
    assert served.get("/", Origin=url).status == 403
    preflight = served.send("OPTIONS", "/answer", {"Origin": url})
    assert preflight.status == 403
    assert not [name for name in preflight.headers if name.startswith("Access-Control")]
    assert computed == []


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_another_page_can_link_to_the_page_and_do_nothing_else(served: Served, site: str) -> None:
    visit = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "navigate"}
    assert served.get("/?locks=7", **visit, Sec_Fetch_Dest="document").status == 200
    assert served.get("/?locks=7", **visit, Sec_Fetch_Dest="iframe").status == 403
    assert served.get("/explore.js", Sec_Fetch_Site=site, Sec_Fetch_Mode="no-cors").status == 403
    assert refused(served, Sec_Fetch_Site=site)


def test_a_form_of_another_page_cannot_post(served: Served) -> None:
    found = served.send("POST", "/answer", {"Content-Type": "text/plain"}, '{"page": "x"}')
    assert found.status == 415


@pytest.mark.parametrize("path", ["/", "/explore.js", "/nothing"])
def test_no_page_may_frame_it(served: Served, path: str) -> None:
    headers = served.get(path).headers
    assert headers["X-Frame-Options"] == "DENY"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


# --- what is superseded --------------------------------------------------------------------------
def test_of_many_requests_first_and_last_are_computed(served: Served, computed: list[int]) -> None:
    """The first is being computed when the others come; the last is what the page wants."""
    status: dict[int, int] = {}

    def send(number: int) -> None:
        status[number] = served.ask({"locks": number}, "fast", number).status

    threads = []
    for number in range(2, 22):
        threads.append(threading.Thread(target=send, args=[number]))
        threads[-1].start()
        while number == 2 and not computed:
            time.sleep(0.001)
    for thread in threads:
        thread.join()
    assert status[21] == 200
    assert len(computed) < 10
    assert computed[-1] == 21
    assert sum(found == 204 for found in status.values()) == 20 - len(computed)
