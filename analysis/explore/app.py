"""The explorer: a page with sliders and the joint's capacity, served to this machine only."""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from threading import Thread
from typing import Annotated, Any

from plotly.offline import get_plotlyjs, get_plotlyjs_version
from pydantic import BaseModel, Field, ValidationError
from werkzeug.exceptions import BadRequest, HTTPException, MethodNotAllowed, NotFound
from werkzeug.serving import BaseWSGIServer, WSGIRequestHandler, make_server
from werkzeug.wrappers import Request, Response

from analysis.drawing import label_of
from analysis.explore.examples import (
    EXAMPLES,
    STRUCTURE_MODELS,
    STRUCTURE_SLIDERS,
    Chosen,
    checked_choice,
    defaults,
)
from analysis.explore.pictures import (
    answers,
    covered,
    effects,
    peak,
    pictures,
    ratios,
    results,
    which_counts,
)
from analysis.explore.requests import HEADERS, Desk, SupersededError, require_own
from analysis.explore.state import (
    SLIDERS,
    Checked,
    Figures,
    Read,
    Settings,
    Slider,
    State,
    as_configuration,
    as_python,
    beside,
    checked,
    compared,
    from_query,
    query_of,
)
from analysis.explore.structures import (
    OPENED,
    STAGES,
    OpenedFiles,
    SentFile,
    answered,
    same,
    structure_answer,
)
from sidmacib.errors import CapacityError, ResultError
from sidmacib.scene.page import HERE as SCENE
from sidmacib.scene.page import rendered

HERE = Path(__file__).parent
LOOPBACK = "127.0.0.1"
PLOTLY = f"/plotly-{get_plotlyjs_version()}.js"
SCRIPT, STYLE = "text/javascript", "text/css"
FILES = (
    *((HERE / f"{name}.js", SCRIPT) for name in ("server", "controls", "explore", "structures")),
    (HERE / "explore.css", STYLE),
    *((SCENE / f"{name}.js", SCRIPT) for name in ("chart", "parts", "structure")),
)
# Of the page of a file, which has its scripts in it and asks for pages of other files only.
POLICY_OF_FILES = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; form-action 'none'; base-uri 'none'; "
    "frame-ancestors 'none'"
)
SUPERSEDED = 204  # no content: a browser takes it for no error
MOST_PORT = 65535
PATIENCE = 20.0  # seconds, for the rest of a request
FAULTS = (CapacityError, ResultError, ValueError, ArithmeticError, MemoryError)  # of a file


class Explorer:
    """The page as a WSGI application."""

    def __init__(self) -> None:
        self._desk = Desk()
        self._posts: dict[str, Callable[[Request], Any]] = {
            "/answer": self._answer,
            "/curve": self._curve,
            "/structure": self._structure,
            "/file": self._file,
        }
        self._files = OpenedFiles()
        self._pages: dict[str, Callable[[str], str]] = {
            "/": lambda query: page(from_query(query, checked)),
            "/structures": lambda query: structures_page(from_query(query, checked_choice)),
        }

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
        with self._desk.turn("", 0):
            answers(Settings())
        with self._desk.turn("", 0):
            structure_answer(checked_choice({}).state)

    def _respond(self, request: Request) -> Response:
        if request.path in self._posts:
            if request.method != "POST":
                raise MethodNotAllowed(["POST"])
            found = self._posts[request.path](request)
            return Response(json.dumps(found, allow_nan=False), mimetype="application/json")
        if request.method == "POST":
            raise NotFound(f"A post goes to {' or '.join(self._posts)}.")
        if request.path in self._pages:
            query = request.query_string.decode("ascii", "replace")
            return Response(self._pages[request.path](query), mimetype="text/html")
        if request.path == OPENED:
            own = {"Content-Security-Policy": POLICY_OF_FILES}
            found = self._files.page(request.args)
            return Response(found, mimetype="text/html", headers=own)
        if request.path == PLOTLY:
            kept = {"Cache-Control": "max-age=86400"}
            return Response(_plotly(), mimetype=SCRIPT, headers=kept)
        for file, kind in FILES:
            if request.path == f"/{file.name}":
                return Response(file.read_bytes(), mimetype=kind)
        raise NotFound(f"There are {len(self._pages)} pages, {' and '.join(self._pages)}.")

    def _answer(self, request: Request) -> dict[str, Any]:
        """The answer that follows the sliders at once."""
        asked, given = _asked(request, checked)
        state = given.state
        with self._desk.turn(*asked.turn):
            found = [answers(each) for each in given.states]
        both = [*zip(given.states, found, strict=True)]
        (drawn, *kept), told = ([of(*each) for each in both] for of in (pictures, results))
        return {
            **asked.echo(given),
            "values": state.values,
            "words": found[0].words,
            **drawn,
            "kept": {"words": found[1].words, "marks": kept[0]["marks"]} if kept else None,
            "comparison": _compared(given, told),
            "yaml": as_configuration(state),
            "python": as_python(state),
            "link": _link(request, "", given),
        }

    def _curve(self, request: Request) -> dict[str, Any]:
        """The curve, which takes as long as all else for each of its directions."""
        asked, given = _asked(request, checked)
        state, lines, counted, told = given.state, [], [], []
        for each in given.states:
            points = []
            for ratio in ratios(each):
                with self._desk.turn(*asked.turn):
                    points.append(peak(each.joint, ratio))
            with self._desk.turn(*asked.turn):
                counted.append(which_counts(each))
                told.append(results(each, answers(each), counted[-1]))
            known = [point for point in points if point is not None]
            lines.append({name: [getattr(p, name) for p in known] for name in ("shear", "torque")})
        with self._desk.turn(*asked.turn):
            pulls = effects(state)
        return {
            **asked.echo(given),
            "values": state.values,
            **lines[0],
            "kept": {**lines[1], "name": given.kept.name} if given.kept else None,
            "comparison": _compared(given, told),
            "spread": counted[0].legend,
            "counts": counted[0].words,
            "covered": covered(state),
            "effects": pulls,
        }

    def _structure(self, request: Request) -> dict[str, Any]:
        """The answer to choices of the other page; a newer request ends it between stages."""
        asked, given = _asked(request, checked_choice)
        chosen = given.state
        for each in given.states:
            for stage in STAGES:
                with self._desk.turn(*asked.turn):
                    stage(same(each))
        with self._desk.turn(*asked.turn):
            found = structure_answer(chosen)
            both = [answered(same(each)) for each in given.states]
        return {
            **asked.echo(given),
            **found,
            "values": dict(chosen.values),
            "kept": {"words": both[1].views.answer} if both[1:] else None,
            "comparison": _compared(given, [each.carried for each in both]),
            "link": _link(request, "structures", given),
        }

    def _file(self, request: Request) -> dict[str, Any]:
        """The address of the page of a file that was sent, or what is wrong with it, in a line."""
        asked, given = _asked(request, _sent)
        try:
            with self._desk.turn(*asked.turn):
                page = self._files.opened(given.state.files, given.state.kept)
        except FAULTS as error:
            return {**asked.echo(given), "page": None, "error": " ".join(str(error).split())}
        return {**asked.echo(given), "page": page, "error": None}


class _Sent(BaseModel):
    """Files, and the number of the one that they are compared with, 0 for none."""

    files: list[SentFile]
    kept: int = 0


def _sent(values: Mapping[str, object]) -> Checked[_Sent]:
    try:
        return Checked(_Sent.model_validate(values), ())
    except ValidationError:
        raise BadRequest(
            "files must be a list of objects with name and data in base64, "
            "and kept the number of a file."
        ) from None


class _Post(BaseModel):
    """What a page sends: its name, the number of the request, and the value of each slider."""

    page: Annotated[str, Field(min_length=1, max_length=40)]
    number: Annotated[int, Field(ge=0)]
    values: dict[str, Any]
    kept: dict[str, Any] | None = None

    @property
    def turn(self) -> tuple[str, int]:
        """The page and the number that it waits with."""
        return self.page, self.number

    def echo(self, found: Checked[Any]) -> dict[str, Any]:
        """The beginning of each answer: the request's number, and changes made to it."""
        return {"number": self.number, "notes": list(found.notes)}


def _asked(request: Request, read: Read[State]) -> tuple[_Post, Checked[State]]:
    """The request's JSON, and its values by ``read``; `BadRequest` for any other."""
    try:
        sent = _Post.model_validate(json.loads(request.get_data(cache=False)), strict=True)
    except (ValueError, RecursionError):
        raise BadRequest("A post must have page, number and values, as this page sends.") from None
    kept = None if sent.kept is None else read(sent.kept)
    return sent, beside(read(sent.values), kept)


def _compared(found: Checked[Any], told: Sequence[Figures]) -> list[list[Any]]:
    """Lines of the comparison with what is kept; none if nothing is."""
    if found.kept is None:
        return []
    shown, kept = told
    return compared((found.state.told, found.kept.told), (shown, kept))


def _link(request: Request, path: str, found: Checked[Any]) -> str:
    query = query_of(found.state, found.kept)
    return f"{request.host_url}{path}?{query}".rstrip("?")


def page(link: Checked[Settings]) -> str:
    """The page of a joint as HTML, with the sliders as ``link`` has them."""
    kept = link.kept and link.kept.values
    return _rendered("joint", SLIDERS, link, values=link.state.values, kept=kept)


def structures_page(link: Checked[Chosen]) -> str:
    """The page of structures as HTML, with the sliders as ``link`` has them."""
    return _rendered(
        "structures",
        STRUCTURE_SLIDERS,
        link,
        examples={name: (each, defaults(name)) for name, each in EXAMPLES.items()},
        models={name: label_of(name).name for name in STRUCTURE_MODELS},
        chosen=link.state,
        values=dict(link.state.values),
        kept=link.kept and link.kept.chosen,
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
