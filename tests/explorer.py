"""The explorer as its tests serve it, and requests to it as anything may send them."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.client import HTTPConnection
from typing import Any

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
