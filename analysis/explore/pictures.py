"""What the page shows of a joint: its V-M curve, its locks' weights, and a drawing."""

import math
from dataclasses import dataclass
from functools import lru_cache

import plotly.graph_objects as go

from analysis.explore.state import Playing
from analysis.looks import BLUE, GREY, look_of
from sidmacib.chain.rule import RULES, LawCapacity
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.load_path import load_path
from sidmacib.loading import Loading
from sidmacib.weights import LockWeight, lock_weights

RATIOS = (0.0, 0.1, 0.3, 1.0, math.inf)  # of the curve, e / a
COARSE = 0.999  # mesh over the shorter side of a lock: nine Lobatto nodes on each root
FONT = {"size": 13}


@dataclass(frozen=True)
class Peak:
    """Peak of the static model along a direction: shear (N), torque (N m), weights of the locks."""

    shear: float
    torque: float
    weights: tuple[LockWeight, ...]


@dataclass(frozen=True)
class Answers:
    """What models say of a joint at the chosen eccentricity, and why some do not."""

    peak: Peak | None
    rules: dict[str, LawCapacity]
    words: str


@lru_cache(maxsize=512)
def peak(joint: Joint, ratio: float) -> Peak | None:
    """The static model on its coarsest mesh; None if the joint carries nothing."""
    direction = Direction(ratio)
    try:
        assembly, solution = load_path(joint, Loading(direction), COARSE * joint.least_side)
    except CapacityError:
        return None
    load = float(solution.peak.load)
    weights = lock_weights(joint, assembly, solution.peak.force)
    return Peak(load * direction.shear, load * direction.torque * joint.a, weights)


def answers(state: Playing) -> Answers:
    """Peak, law and safe rule at the chosen eccentricity; a refusal is told, not raised."""
    joint, ratio = state.joint, state.eccentricity
    found = peak(joint, ratio)
    words = (
        f"At e = {ratio:g} a nothing carries the load."
        if found is None
        else f"At e = {ratio:g} a the peak is V = {found.shear:.4g} N, M = {found.torque:.3g} N m."
    )
    rules: dict[str, LawCapacity] = {}
    try:
        for name, rule in RULES.items():
            rules[name] = rule(joint, Direction(ratio))
    except (CapacityError, ValueError) as error:
        return Answers(found, rules, f"{words} No safe rule: {error}.")
    own = rules["safe"]
    words += f" Safe: V = {own.shear:.4g} N, M = {own.torque:.3g} N m. T0 = {joint.T0:.4g} N."
    return Answers(found, rules, words)


def curve(state: Playing, told: Answers) -> go.Figure:
    """The V-M curve of peaks, and what law and safe rule say at the chosen eccentricity."""
    figure = go.Figure()
    ratios = sorted({*RATIOS, state.eccentricity})
    points = [found for ratio in ratios if (found := peak(state.joint, ratio)) is not None]
    figure.add_scatter(
        x=[point.shear for point in points],
        y=[point.torque for point in points],
        name="peak, static model",
        mode="lines+markers",
        line={"color": look_of("static").colour},
    )
    marks = {"law": ("first failure, law", "x"), "safe": (look_of("safe").name, "star")}
    for name, (words, symbol) in marks.items():
        if name in told.rules:
            own = told.rules[name]
            figure.add_scatter(
                x=[own.shear],
                y=[own.torque],
                name=words,
                mode="markers",
                marker={"color": look_of(name).colour, "symbol": symbol, "size": 12},
            )
    return _laid_out(figure, "shear V (N)", "torque M (N m)")


def weights(told: Answers) -> go.Figure:
    """What each lock carries at the peak, over its strength."""
    figure = go.Figure()
    if told.peak is not None:
        for block, colour in (("upper", BLUE), ("lower", GREY)):
            own = [each for each in told.peak.weights if each.block == block]
            figure.add_bar(
                x=[f"{each.lock}" for each in own],
                y=[each.weight for each in own],
                name=f"{block} block",
                marker_color=colour,
            )
        figure.update_xaxes(
            categoryorder="array", categoryarray=[f"{e.lock}" for e in told.peak.weights]
        )
    figure = _laid_out(figure, "lock", "weight at the peak")
    figure.update_yaxes(range=[0, 1.05])
    return figure


def drawing(state: Playing) -> go.Figure:
    """The joint from the side: upper block blue, lower block grey, locks numbered."""
    joint, figure = state.joint, go.Figure()
    mm = 1e3
    width, top = mm * joint.total_width, mm * (joint.h + joint.H)
    _box(figure, 0.0, width, -mm * joint.H, 0.0, GREY, 0.5)
    for lock in joint.numbers:
        low, high = mm * joint.edge(lock - 1), mm * joint.edge(lock)
        colour = BLUE if joint.is_upper(lock) else GREY
        _box(figure, low, high, 0.0, mm * joint.h, colour, 0.9)
        if not state.one_piece:
            _box(figure, low, high, mm * joint.h, top, BLUE, 0.4)
        figure.add_annotation(
            x=(low + high) / 2, y=mm * joint.h / 2, text=str(lock), showarrow=False
        )
    if state.one_piece:
        _box(figure, 0.0, width, mm * joint.h, top, BLUE, 0.4)
    figure.add_annotation(x=0, y=top / 2, ax=-60, ay=0, text="V", showarrow=True, arrowwidth=2)
    figure = _laid_out(figure, "y (mm)", "z (mm)")
    figure.update_xaxes(range=[-0.15 * width, 1.05 * width])
    figure.update_yaxes(scaleanchor="x", range=[-mm * joint.H, 1.1 * top])
    return figure


def _box(
    figure: go.Figure,
    left: float,
    right: float,
    low: float,
    high: float,
    colour: str,
    opacity: float,
) -> None:
    figure.add_shape(
        type="rect",
        x0=left,
        x1=right,
        y0=low,
        y1=high,
        fillcolor=colour,
        opacity=opacity,
        line={"color": "#1c1f24", "width": 1},
    )


def _laid_out(figure: go.Figure, x: str, y: str) -> go.Figure:
    figure.update_layout(
        margin={"l": 60, "r": 15, "t": 15, "b": 50},
        font=FONT,
        plot_bgcolor="white",
        xaxis={"title": {"text": x}, "gridcolor": "#dddddd", "rangemode": "tozero"},
        yaxis={"title": {"text": y}, "gridcolor": "#dddddd", "rangemode": "tozero"},
        legend={"orientation": "h", "y": 1.08},
        uirevision="same",
    )
    return figure
