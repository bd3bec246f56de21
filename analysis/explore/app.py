"""The explorer: a page with sliders and the joint's capacity, served to this machine only.

Requests are answered one at a time, and only those of its own page.
"""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from functools import cache, partial
from itertools import product
from pathlib import Path
from threading import Condition, Thread
from typing import Annotated, Any

from plotly.offline import get_plotlyjs, get_plotlyjs_version
from pydantic import BaseModel, Field, ValidationError
from werkzeug.exceptions import (
    BadRequest,
    Forbidden,
    HTTPException,
    MethodNotAllowed,
    NotFound,
    UnsupportedMediaType,
)
from werkzeug.serving import BaseWSGIServer, WSGIRequestHandler, make_server
from werkzeug.wrappers import Request, Response

from analysis.drawing import label_of
from analysis.explore import examples, pictures, state, structures
from analysis.explore.examples import Chosen
from analysis.explore.state import Checked, Read, Settings, Slider
from sidmacib.errors import CapacityError, ResultError
from sidmacib.mechanics.compilation import Kept
from sidmacib.scene.page import HERE as SCENE
from sidmacib.scene.page import rendered

HERE = Path(__file__).parent
LOOPBACK = "127.0.0.1"
PLOTLY = f"/plotly-{get_plotlyjs_version()}.js"
KINDS = {".js": "text/javascript", ".css": "text/css"}
FILES = {
    f"/{name}": folder / name
    for folder, names in (
        (HERE, ("server.js", "controls.js", "explore.js", "structures.js", "explore.css")),
        (SCENE, ("chart.js", "parts.js", "structure.js")),
    )
    for name in names
}
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
# Of the page of a file, which has its scripts in it and asks for pages of other files only.
POLICY_OF_FILES = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; form-action 'none'; base-uri 'none'; "
    "frame-ancestors 'none'"
)
SUPERSEDED = 204  # no content: a browser takes it for no error
MOST_PORT = 65535
PATIENCE = 20.0  # seconds, for the rest of a request
COMPILING = "Compiling the solvers, once, which takes up to a minute …"
FAULTS = (CapacityError, ResultError, ValueError, ArithmeticError, MemoryError)  # of a file

Content = dict[str, Any]
Turn = Callable[[], AbstractContextManager[None]]


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


class Explorer:
    """The page as a WSGI application."""

    def __init__(self) -> None:
        self._desk, self._files = Desk(), structures.OpenedFiles()
        self._posts: dict[str, tuple[Read[Any], Callable[[Turn, Checked[Any]], Content]]] = {
            "/answer": (state.checked, self._answer),
            "/curve": (state.checked, self._curve),
            "/structure": (examples.checked_choice, self._structure),
            "/file": (_sent, self._file),
        }
        self._pages = {"/": page, "/structures": structures_page}
        self._first_words = "computing …"

    def __call__(self, environ: dict[str, Any], start_response: Any) -> Iterable[bytes]:
        """Answer a request; a fault of the request, or of a model, is described in one line."""
        request = Request(environ)
        try:
            require_own(request, int(environ["SERVER_PORT"]))
            response = self._respond(request)
        except HTTPException as error:
            response = Response(f"{error.code} {error.name}: {error.description}\n", error.code)
        except SupersededError:
            response = Response(status=SUPERSEDED)
        for name, value in HEADERS.items():
            response.headers.setdefault(name, value)
        return response(environ, start_response)

    def warm_up(self) -> None:
        """Compile the static model before the first request needs it."""

        def tell() -> None:
            self._first_words = COMPILING
            print(COMPILING, flush=True)

        Kept.at_first = tell
        with self._desk.turn("", 0):
            pictures.answers(state.Settings())
        with self._desk.turn("", 0):
            structures.structure_answer(examples.checked_choice({}).state)
        self._first_words = "computing …"

    def _respond(self, request: Request) -> Response:
        path = request.path
        if path in self._posts:
            if request.method != "POST":
                raise MethodNotAllowed(["POST"])
            found = self._posted(request, *self._posts[path])
            return Response(json.dumps(found, allow_nan=False), mimetype="application/json")
        if request.method == "POST":
            raise NotFound(f"A post goes to {' or '.join(self._posts)}.")
        if path in self._pages:
            query = request.query_string.decode("ascii", "replace")
            return Response(self._pages[path](query, self._first_words), mimetype="text/html")
        if path == structures.OPENED:
            own = {"Content-Security-Policy": POLICY_OF_FILES}
            return Response(self._files.page(request.args), mimetype="text/html", headers=own)
        if path == PLOTLY:
            kept = {"Cache-Control": "max-age=86400"}
            return Response(_plotly(), mimetype=KINDS[".js"], headers=kept)
        if path in FILES:
            return Response(FILES[path].read_bytes(), mimetype=KINDS[FILES[path].suffix])
        raise NotFound(f"There are {len(self._pages)} pages, {' and '.join(self._pages)}.")

    def _posted(
        self, request: Request, read: Read[Any], answer: Callable[[Turn, Checked[Any]], Content]
    ) -> Content:
        """The ``answer`` to the values in a request, ``read``; `BadRequest` if it has none."""
        try:
            sent = _Post.model_validate(json.loads(request.get_data(cache=False)), strict=True)
        except (ValueError, RecursionError):
            words = "A post must have page, number and values, as this page sends."
            raise BadRequest(words) from None
        given = state.read_both(read, sent.values, sent.kept)
        found = answer(partial(self._desk.turn, sent.page, sent.number), given)
        if "link" in found:
            found["link"] = f"{request.host_url}{found['link']}".rstrip("?")
        return {"number": sent.number, "notes": list(given.notes), **found}

    def _answer(self, turn: Turn, given: Checked[Settings]) -> Content:
        """The answer that follows the sliders at once."""
        shown = given.state
        with turn():
            found = [pictures.answers(each) for each in given.states]
        both = [*zip(given.states, found, strict=True)]
        drawn, *kept = (pictures.pictures(*each) for each in both)
        return {
            "values": shown.values,
            "words": found[0].words,
            **drawn,
            "kept": {"words": found[1].words, "marks": kept[0]["marks"]} if kept else None,
            "comparison": given.comparison([pictures.results(*each) for each in both]),
            "yaml": state.as_configuration(shown),
            "python": state.as_python(shown),
            "link": f"?{given.query}",
        }

    def _curve(self, turn: Turn, given: Checked[Settings]) -> Content:
        """The curve, which takes as long as all else for each of its directions."""
        shown, lines, counted, told = given.state, [], [], []
        for each in given.states:
            points = []
            for ratio in pictures.ratios(each):
                with turn():
                    points.append(pictures.peak(each.joint, ratio))
            with turn():
                counted.append(pictures.which_counts(each))
                told.append(pictures.results(each, pictures.answers(each), counted[-1]))
            known = [point for point in points if point is not None]
            lines.append({name: [getattr(p, name) for p in known] for name in ("shear", "torque")})
        with turn():
            pulls = pictures.effects(shown)
        return {
            "values": shown.values,
            **lines[0],
            "kept": {**lines[1], "name": given.kept.name} if given.kept else None,
            "comparison": given.comparison(told),
            "spread": counted[0].legend,
            "counts": counted[0].words,
            "covered": pictures.covered(shown),
            "effects": pulls,
        }

    def _structure(self, turn: Turn, given: Checked[Chosen]) -> Content:
        """The answer to choices of the other page; a newer request ends it between stages."""
        same = [structures.same(each) for each in given.states]
        for each, stage in product(same, structures.STAGES):
            with turn():
                stage(each)
        with turn():
            found = structures.structure_answer(given.state)
            both = [structures.answered(each) for each in same]
        return {
            **found,
            "values": dict(given.state.values),
            "kept": {"words": both[1].views.answer} if both[1:] else None,
            "comparison": given.comparison([each.carried for each in both]),
            "link": f"structures?{given.query}",
        }

    def _file(self, turn: Turn, given: Checked[structures.Sent]) -> Content:
        """The address of the page of a file that was sent, or what is wrong with it, in a line."""
        try:
            with turn():
                return {"page": self._files.opened(given.state), "error": None}
        except FAULTS as error:
            return {"page": None, "error": " ".join(str(error).split())}


def _sent(values: Mapping[str, object]) -> Checked[structures.Sent]:
    try:
        return Checked(structures.Sent.model_validate(values), ())
    except ValidationError:
        raise BadRequest(
            "files must be a list of objects with name and data in base64, of the number of a "
            "file, and numbers have a number for each name."
        ) from None


class _Post(BaseModel):
    """What a page sends: its name, the number of the request, and the value of each slider."""

    page: Annotated[str, Field(min_length=1, max_length=40)]
    number: Annotated[int, Field(ge=0)]
    values: dict[str, Any]
    kept: dict[str, Any] | None = None


def page(query: str, first_words: str) -> str:
    """The page of a joint as HTML, with the sliders as the ``query`` of a link has them.

    ``first_words``: those in place of an answer, until there is one.
    """
    link = state.from_query(query, state.checked)
    kept = link.kept and link.kept.values
    return _rendered(
        "joint", state.SLIDERS, link, values=link.state.values, kept=kept, first_words=first_words
    )


def structures_page(query: str, first_words: str) -> str:
    """The page of structures as HTML, as `page` is of a joint."""
    link = state.from_query(query, examples.checked_choice)
    known, models = examples.EXAMPLES, examples.STRUCTURE_MODELS
    return _rendered(
        "structures",
        examples.STRUCTURE_SLIDERS,
        link,
        examples={name: (each, examples.defaults(name)) for name, each in known.items()},
        models={name: label_of(name).name for name in models},
        chosen=link.state,
        values=dict(link.state.values),
        kept=link.kept and link.kept.chosen,
        kinds=structures.READ,
        first_words=first_words,
    )


def _rendered(name: str, sliders: Mapping[str, Slider], link: Checked[Any], **content: Any) -> str:
    template = HERE / f"{name}.html.j2"
    return rendered(template, plotly=PLOTLY, sliders=sliders, notes=link.notes, **content)


@cache
def _plotly() -> bytes:
    return str(get_plotlyjs()).encode()


class _Quiet(WSGIRequestHandler):
    """Not a line for each request, and no thread for one that never ends."""

    timeout = PATIENCE

    def log(self, type: str, message: str, *args: object) -> None:
        if type == "error":
            super().log(type, message, *args)


def serve(port: int) -> tuple[BaseWSGIServer, Explorer]:
    """The page on a port of this machine, any free one for 0; `SystemExit` if it is taken."""
    explorer = Explorer()
    return make_server(LOOPBACK, port, explorer, threaded=True, request_handler=_Quiet), explorer


def main() -> None:
    """Serve the page until it is stopped."""
    parser = argparse.ArgumentParser(prog="make explore", description=__doc__)
    parser.add_argument("--port", type=int, default=8050, help="0: any that is free")
    arguments = parser.parse_args()
    if not 0 <= arguments.port <= MOST_PORT:
        sys.exit(f"--port must be from 0 to {MOST_PORT} (got {arguments.port})")
    try:
        server, explorer = serve(arguments.port)
    except SystemExit:  # it has said why
        sys.exit(f"port {arguments.port} is taken; choose another with --port")
    Thread(target=explorer.warm_up, daemon=True).start()
    print(f"Open http://{LOOPBACK}:{server.port} (stop with Ctrl+C)", flush=True)
    server.serve_forever()  # until Ctrl+C


if __name__ == "__main__":
    main()
