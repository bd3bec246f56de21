"""The explorer as tests serve it, requests to it as anything may send them, and its pages."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from typing import Any

from chromium import PATIENCE, WATCH, Opened
from playwright.sync_api import Browser, Page, expect

from analysis.explore.app import LOOPBACK, serve

JSON = {"Content-Type": "application/json"}


@dataclass(frozen=True)
class Answered:
    """Status, headers and text of an answer."""

    status: int
    headers: dict[str, str]
    text: str

    @property
    def content(self) -> Any:
        return json.loads(self.text)


@dataclass(frozen=True)
class Served:
    """The page on a port of this machine."""

    port: int

    @property
    def url(self) -> str:
        return f"http://{LOOPBACK}:{self.port}"

    def send(
        self, method: str, path: str, headers: dict[str, str], body: bytes | str | None = None
    ) -> Answered:
        connection = HTTPConnection(LOOPBACK, self.port, timeout=60)
        try:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            return Answered(answer.status, dict(answer.headers), answer.read().decode())
        finally:
            connection.close()

    def get(self, path: str, **headers: str) -> Answered:
        return self.send("GET", path, {k.replace("_", "-"): v for k, v in headers.items()})

    def post(self, path: str, content: object, **headers: str) -> Answered:
        """``content`` as JSON, or as it is if it is a text."""
        body = content if isinstance(content, str) else json.dumps(content)
        more = {k.replace("_", "-"): v for k, v in headers.items()}
        return self.send("POST", path, JSON | more, body)

    def ask(self, values: object, page: str = "test", number: int = 1) -> Answered:
        """What the page asks for a joint."""
        return self.post("/answer", {"page": page, "number": number, "values": values})


@contextmanager
def explorer() -> Iterator[Served]:
    """Serve the page, on a free port."""
    server, _ = serve(0)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield Served(server.port)
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def opened_at(browser: Browser, address: str, *scripts: str, **window: Any) -> Opened:
    """A page of the explorer, with ``scripts`` from its beginning on."""
    page = browser.new_page(**({"viewport": {"width": 1400, "height": 900}} | window))
    found = Opened(page)
    for script in (WATCH, *scripts):
        page.add_init_script(script)
    page.goto(address)
    settle(page)
    return found


def settle(page: Page) -> None:
    """Wait until numbers and curve are of the sliders."""
    for part in page.locator("#answer, #curve").all():
        expect(part).to_have_attribute("aria-busy", "false", timeout=PATIENCE)


def choose(page: Page, name: str, value: str) -> None:
    """Type a value beside its slider."""
    page.fill(f"#{name}-value", value)
    page.keyboard.press("Tab")
    settle(page)
