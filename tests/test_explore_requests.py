"""What the explorer answers, and to whom: real requests, also those of a hostile page."""

import threading
import time

import pytest
from explorer import Served

from analysis.explore import app
from analysis.explore.pictures import Answers
from analysis.explore.state import SLIDERS, Settings

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

    monkeypatch.setattr(app, "answers", slow)
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
