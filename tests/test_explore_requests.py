"""What the explorer answers, and to whom: real requests, also those of a hostile page."""

import json
import socket
import threading
import time
from collections.abc import Iterator

import pytest
from explorer import Served, explorer

from analysis.explore import app
from analysis.explore.desk import Desk, SupersededError
from analysis.explore.pictures import Answers
from analysis.explore.state import SLIDERS, Settings

FIRST = Settings().values


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with explorer() as found:
        yield found


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
@pytest.mark.parametrize("locks", ["400", "1e7", "9" * 400, "-1e999"])
def test_a_link_has_no_more_locks_than_the_slider(served: Served, locks: str) -> None:
    found = served.get(f"/?locks={locks}")
    most = 2 if locks.startswith("-") else 31
    assert found.status == 200
    assert f'id="locks" min="2" max="31" step="1" value="{most}"' in found.text
    assert f"is outside 2 to 31; {most} is shown." in found.text


def test_text_from_a_link_is_shown_as_text(served: Served) -> None:
    found = served.get("/?%3Cscript%3E=1&a=%3Cb%3E&b=nan&h=")
    assert "<script>&#39;" not in found.text and "<b>" not in found.text
    assert "&#39;&lt;script&gt;&#39; is no parameter." in found.text
    assert "a: &#39;&lt;b&gt;&#39; is not a number; 60 is shown." in found.text
    assert "b: &#39;nan&#39; is not a number" in found.text
    assert "h: &#39;&#39; is not a number" in found.text


def test_a_link_of_a_thousand_parameters_is_refused_in_a_line(served: Served) -> None:
    found = served.get("/?" + "&".join(f"x{k}=1" for k in range(1000)))
    assert found.text.count("<br>") == 1
    assert "more than 40 parameters" in found.text


@pytest.mark.parametrize(
    ("values", "shown"),
    [
        ({"locks": 400}, {"locks": 31}),
        ({"locks": 1e7}, {"locks": 31}),
        ({"locks": 10**400}, {"locks": 31}),
        ({"locks": -(10**400)}, {"locks": 2}),
        ({"locks": float("inf"), "a": float("-inf")}, {"locks": 31, "a": 15}),
        ({"locks": float("nan")}, {}),
        ({"locks": "many"}, {}),
        ({"locks": [31]}, {}),
        ({"locks": {"locks": 31}}, {}),
        ({"locks": None}, {}),
        ({"locks": 7.4}, {"locks": 7}),
        ({"friction": 30, "pressure": -1}, {"friction": 0.8, "pressure": 0}),
        ({"one_piece": 5}, {"one_piece": 1}),
        ({}, {}),
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
        *("", "null", "[]", "7", '"locks"', "{}", "not json", '{"page": "x"', "\x00"),
        "[" * 4000,
        '{"values":' * 400,
        '{"page": "x", "number": 1}',
        '{"page": "x", "number": 1, "values": [5]}',
        '{"page": "x", "number": true, "values": {}}',
        '{"page": "x", "number": -1, "values": {}}',
        '{"page": "x", "number": 1.5, "values": {}}',
        '{"page": "", "number": 1, "values": {}}',
        '{"page": ["x"], "number": 1, "values": {}}',
        json.dumps({"page": "x" * 41, "number": 1, "values": {}}),
    ],
)
@pytest.mark.parametrize("path", ["/answer", "/curve"])
def test_a_post_that_the_page_would_not_send_is_refused(
    served: Served, path: str, body: str
) -> None:
    found = served.post(path, body)
    assert found.status == 400
    assert found.text.startswith("400 Bad Request: ") and found.text.count("\n") == 1


def test_a_long_post_is_refused_before_it_is_read(served: Served) -> None:
    headers = f"Host: 127.0.0.1:{served.port}\r\nContent-Type: application/json"
    for length, status in (
        ("Content-Length: 4097", 413),
        ("Content-Length: 999999999999", 413),
        ("Transfer-Encoding: chunked", 411),
    ):
        with socket.create_connection(("127.0.0.1", served.port), timeout=30) as connection:
            connection.sendall(f"POST /answer HTTP/1.1\r\n{headers}\r\n{length}\r\n\r\n".encode())
            assert f" {status} " in connection.recv(100).decode().splitlines()[0]


def test_what_takes_no_post_gets_none(served: Served) -> None:
    for path in ("/", "/_dash-update-component", "/explore.js"):
        assert served.post(path, {}).status == 404
    assert served.get("/answer").status == 405
    assert served.get("/../app.py").status == 404
    assert served.send("PUT", "/answer", {}).status == 405


def test_requests_that_never_end_are_ended_and_keep_nobody_waiting(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(app._Quiet, "timeout", 0.5)
    with explorer() as server:
        idle = [socket.create_connection(("127.0.0.1", server.port), timeout=30) for _ in range(40)]
        for connection in idle:
            head = f"POST /answer HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
            kind = "Content-Type: application/json\r\nContent-Length: 4000\r\n\r\n{"
            connection.sendall((head + kind).encode())
        assert server.get("/").status == 200
        for connection in idle:
            while connection.recv(1000):  # until the server ends it
                pass
            connection.close()


@pytest.mark.parametrize("port", ["65536", "-1", "999999999999"])
def test_a_port_that_does_not_exist_is_reported_in_one_line(
    port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["explore", f"--port={port}"])
    with pytest.raises(SystemExit) as error:
        app.main()
    assert error.value.code == f"--port must be from 0 to 65535 (got {port})"


# --- other pages ---------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_this_machine_is_answered_by_its_names(served: Served, name: str) -> None:
    assert served.get("/", Host=f"{name}:{served.port}").status == 200


@pytest.mark.parametrize(
    "host",
    [
        *("evil.example", "evil.example:{}", "127.0.0.1", "127.0.0.1:1", "", "192.168.1.5:{}"),
        *("127.0.0.1:{}.evil.example", "localhost.evil.example:{}", "127.0.0.1:{}@evil.example"),
    ],
)
def test_a_name_that_somebody_points_here_is_refused(served: Served, host: str) -> None:
    found = served.get("/", Host=host.format(served.port))
    assert found.status == 403
    assert f"127.0.0.1:{served.port}, localhost:{served.port}" in found.text
    asked = {"page": "x", "number": 1, "values": {}}
    assert served.post("/answer", asked, Host=host.format(served.port)).status == 403


def test_a_foreign_address_in_the_request_line_is_refused(served: Served) -> None:
    with socket.create_connection(("127.0.0.1", served.port), timeout=30) as connection:
        connection.sendall(
            f"GET http://evil.example/ HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\n\r\n".encode()
        )
        assert b" 403 " in connection.recv(100)


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://127.0.0.1:{}"]
)
def test_a_foreign_origin_is_refused(served: Served, origin: str, computed: list[int]) -> None:
    asked = {"page": "x", "number": 1, "values": {}}
    url = origin.format(served.port)
    assert served.post("/answer", asked, Origin=url).status == 403
    assert served.get("/", Origin=url).status == 403
    preflight = served.send("OPTIONS", "/answer", {"Origin": url})
    assert preflight.status == 403
    assert not [name for name in preflight.headers if name.startswith("Access-Control")]
    assert computed == []


def test_the_own_origin_is_answered(served: Served) -> None:
    asked = {"page": "own", "number": 1, "values": {}}
    assert served.post("/answer", asked, Origin=served.url).status == 200


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_another_page_can_link_to_the_page_and_do_nothing_else(served: Served, site: str) -> None:
    visit = {"Sec_Fetch_Site": site, "Sec_Fetch_Mode": "navigate"}
    assert served.get("/?locks=7", **visit, Sec_Fetch_Dest="document").status == 200
    assert served.get("/?locks=7", **visit, Sec_Fetch_Dest="iframe").status == 403
    assert served.get("/explore.js", Sec_Fetch_Site=site, Sec_Fetch_Mode="no-cors").status == 403
    asked = {"page": "x", "number": 1, "values": {}}
    assert served.post("/answer", asked, Sec_Fetch_Site=site).status == 403


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
def test_of_many_requests_the_first_and_the_last_are_computed(
    served: Served, computed: list[int]
) -> None:
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


def test_pages_do_not_supersede_each_other(served: Served, computed: list[int]) -> None:
    assert served.ask({}, "one", 9).status == 200
    assert served.ask({}, "two", 1).status == 200
    assert served.ask({}, "one", 8).status == 204
    assert len(computed) == 2


def test_a_curve_ends_where_the_page_asks_for_something_else(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    ratios: list[float] = []

    def slow(joint: object, ratio: float) -> None:
        ratios.append(ratio)
        while served.newest() != ("curve", 2):
            time.sleep(0.001)

    monkeypatch.setattr(app, "peak", slow)
    found: list[int] = []
    asked = {"page": "curve", "number": 1, "values": {}}
    thread = threading.Thread(target=lambda: found.append(served.post("/curve", asked).status))
    thread.start()
    while not ratios:
        time.sleep(0.001)
    assert served.ask({}, "curve", 2).status == 200
    thread.join()
    assert found == [204]
    assert len(ratios) == 1


def test_a_desk_remembers_few_pages() -> None:
    desk = Desk()
    for number in range(1000):
        with desk.turn(f"page {number}", 1):
            pass
    assert len(desk._latest) <= 64
    with desk.turn("page 999", 2):
        pass
    with pytest.raises(SupersededError), desk.turn("page 999", 1):
        pass


def test_a_model_that_fails_does_not_keep_others_waiting(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(state: Settings) -> None:
        raise ArithmeticError("no matrix")

    with monkeypatch.context() as patch:
        patch.setattr(app, "answers", broken)
        assert served.ask({}, "broken").status == 500
    assert served.ask({}, "whole").status == 200
