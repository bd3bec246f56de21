"""Requests of the explorer: only those of its own page on this machine, and one at a time."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Condition

from werkzeug.exceptions import Forbidden, UnsupportedMediaType
from werkzeug.wrappers import Request

NAMES = ("127.0.0.1", "localhost", "[::1]")
MOST_BYTES = {"/file": 40_000_000}  # of a post
MOST_OF_OTHERS = 4096
PAGES = ("/", "/structures", "/opened")
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; form-action 'none'; base-uri 'none'; "
    "frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
MOST_PAGES = 64  # that are remembered


def require_own(request: Request, port: int) -> None:
    """An `HTTPException` for what is not of the page on ``port``, or not a request that it makes.

    Host names that resolve to this machine are refused like foreign origins: through either, a web
    page could use this server.
    """
    allowed = [f"{name}:{port}" for name in NAMES]
    headers, host = request.headers, request.headers.get("Host", "")
    if host not in allowed:
        raise Forbidden(f"The host must be one of {', '.join(allowed)}.")
    if headers.get("Origin", f"http://{host}") != f"http://{host}":
        raise Forbidden(f"The origin must be http://{host}.")
    # A browser opens a page itself, from a link for example.
    visit = (
        request.method == "GET"
        and request.path in PAGES
        and headers.get("Sec-Fetch-Mode") == "navigate"
        and headers.get("Sec-Fetch-Dest") == "document"
    )
    if not visit and headers.get("Sec-Fetch-Site", "none") not in ("same-origin", "none"):
        raise Forbidden("Only this page itself may ask for that.")
    if request.method == "POST" and request.mimetype != "application/json":
        raise UnsupportedMediaType("A post must be application/json.")
    request.max_content_length = MOST_BYTES.get(request.path, MOST_OF_OTHERS)


class SupersededError(Exception):
    """The page has asked for something newer."""


class Desk:
    """A queue of requests. A newer request of a page sends its older ones away at once."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._busy = False
        self._latest: dict[str, int] = {}

    @contextmanager
    def turn(self, page: str, number: int) -> Iterator[None]:
        """Wait for the turn of request ``number`` of ``page``; `SupersededError` if it has none."""
        with self._changed:
            self._latest[page] = max(number, self._latest.pop(page, number))  # to the end
            while len(self._latest) > MOST_PAGES:
                self._latest.pop(next(iter(self._latest)))
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._busy or self._is_old(page, number))
            if self._is_old(page, number):
                raise SupersededError
            self._busy = True
        try:
            yield
        finally:
            with self._changed:
                self._busy = False
                self._changed.notify_all()

    def _is_old(self, page: str, number: int) -> bool:
        return self._latest.get(page, number) > number
