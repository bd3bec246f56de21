"""The page, served to this machine only: sliders on one side, what follows on the other."""

import argparse
import logging
import sys
from collections.abc import Iterable
from typing import Any

import dash
import plotly.graph_objects as go
from dash import Input, Output, dcc, html
from werkzeug.serving import make_server

from analysis.explore.pictures import answers, curve, drawing, weights
from analysis.explore.state import Playing, as_configuration, as_python, as_query, from_query

LOOPBACK = "127.0.0.1"
SLIDERS = {  # least, most, step, and words
    "locks": (2, 31, 1, "locks n"),
    "a": (15.0, 150.0, 1.0, "length of a lock a (mm)"),
    "b": (20.0, 100.0, 1.0, "width of a lock b (mm)"),
    "h": (3.0, 40.0, 0.5, "height of a lock h (mm)"),
    "H": (15.0, 150.0, 1.0, "height of the body H (mm)"),
    "cohesion": (10.0, 300.0, 5.0, "cohesion (kPa)"),
    "friction": (0.0, 0.8, 0.01, "friction"),
    "young": (0.0, 50.0, 1.0, "E (GPa), 0: rigid"),
    "pressure": (0.0, 200.0, 5.0, "pressure on top (kPa), 0: fixed plate"),
    "eccentricity": (0.0, 3.0, 0.05, "eccentricity e / a"),
    "one_piece": (0, 1, 1, "upper body: columns (0), one piece (1)"),
}
ABOUT = (
    "Peaks of the static model on its coarsest mesh, of pieces that bend the law's first failure. "
    "Law and safe rule are those of docs/law.md, within the spans of their study; the tensile "
    "strength goes with the cohesion; the first lock is on the left. Nothing leaves this machine."
)
STYLE = {
    "fontFamily": "system-ui, sans-serif",
    "maxWidth": "80rem",
    "margin": "0 auto",
    "padding": "1rem",
}
SIDES = {"display": "flex", "flexWrap": "wrap", "gap": "1.5rem"}
PLOT = {"height": "19rem"}


def _slider(name: str, state: Playing) -> html.Div:
    """A slider of the browser's own: it comes with keys, focus and a label that is read out."""
    least, most, step, words = SLIDERS[name]
    slider = dcc.Input(
        id=name,
        type="range",
        min=least,
        max=most,
        step=step,
        value=float(getattr(state, name)),
        style={"width": "100%"},
    )
    told = html.Span(id=f"{name}-told", style={"float": "right"})
    return html.Div([html.Label([words, told], htmlFor=name, style={"display": "block"}), slider])


def layout(state: Playing) -> html.Div:
    """The page for a joint."""
    controls = [_slider(name, state) for name in SLIDERS]
    copies = [
        html.Div(
            [
                html.H2(words, style={"fontSize": "1rem"}),
                dcc.Clipboard(target_id=name, title=f"copy as {words}"),
                html.Pre(id=name, tabIndex="0", style={"overflow": "auto", "fontSize": "0.8rem"}),
            ]
        )
        for name, words in (("yaml", "configuration"), ("python", "Python"), ("link", "link"))
    ]
    plots = [
        dcc.Graph(id=name, style=PLOT, config={"displaylogo": False})
        for name in ("curve", "drawing", "weights")
    ]
    return html.Div(
        [
            dcc.Location(id="place", refresh=False),
            dcc.Store(id="values"),
            html.Header(html.H1("A joint to play with", style={"fontSize": "1.4rem"})),
            html.Main(
                [
                    html.Div(id="words", role="status", style={"flex": "1 1 100%"}),
                    html.Div(controls, style={"flex": "1 1 18rem"}),
                    html.Div(plots, style={"flex": "3 1 30rem"}),
                    html.Div(copies, style={"flex": "1 1 18rem", "minWidth": "0"}),
                    html.P(ABOUT),
                ],
                style=SIDES,
            ),
        ],
        style=STYLE,
    )


def playing(values: Iterable[float]) -> Playing:
    """The state of the page for the sliders' values, in their order."""
    given: dict[str, Any] = dict(zip(SLIDERS, map(float, values), strict=True))
    return Playing(**given | {"locks": int(given["locks"]), "one_piece": bool(given["one_piece"])})


def shown(*values: float) -> tuple[Any, ...]:
    """What follows the sliders at once: pictures, words, three ways to copy it, and the values.

    The curve is drawn after it: it takes as long as all else for each of its directions.
    """
    state = playing(values)
    told = answers(state)
    return (
        list(values),
        drawing(state),
        weights(told),
        told.words,
        as_configuration(state),
        as_python(state),
        f"?{as_query(state)}",
        *(f"{float(value):g}" for value in values),
    )


def drawn(values: Iterable[float]) -> go.Figure:
    """The curve for the sliders' values."""
    state = playing(values)
    return curve(state, answers(state))


def make_app() -> dash.Dash:
    """The page as an application; its scripts are served from here."""
    app = dash.Dash(
        "multilock", title="multilock: a joint to play with", serve_locally=True, update_title=""
    )
    app.index_string = app.index_string.replace("<html>", '<html lang="en">')
    app.layout = layout(Playing())
    names = list(SLIDERS)

    def begin(search: str) -> list[float]:
        state = from_query(search or "")
        return [float(getattr(state, name)) for name in SLIDERS]

    app.callback(
        [
            Output("values", "data"),
            *(Output(name, "figure") for name in ("drawing", "weights")),
            *(Output(name, "children") for name in ("words", "yaml", "python", "link")),
            *(Output(f"{name}-told", "children") for name in SLIDERS),
        ],
        [Input(name, "value") for name in names],
    )(shown)
    app.callback(Output("curve", "figure"), Input("values", "data"))(drawn)
    app.callback([Output(name, "value") for name in names], Input("place", "search"))(begin)
    return app


def main() -> None:
    """Serve the page until it is stopped."""
    parser = argparse.ArgumentParser(prog="make explore", description=__doc__)
    parser.add_argument("--port", type=int, default=8050)
    arguments = parser.parse_args()
    logging.getLogger("werkzeug").setLevel(logging.ERROR)  # not a line for each request
    try:
        server = make_server(LOOPBACK, arguments.port, make_app().server, threaded=True)
    except SystemExit:  # it has said why
        sys.exit(f"port {arguments.port} is taken; choose another with --port")
    print(f"Open http://{LOOPBACK}:{arguments.port} (stop with Ctrl+C)", flush=True)
    server.serve_forever()  # until Ctrl+C


if __name__ == "__main__":
    main()
