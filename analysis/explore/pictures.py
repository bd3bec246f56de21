"""What the page shows of a joint: its V-M curve, its locks' weights, and a drawing."""

import math
from dataclasses import dataclass
from functools import lru_cache

import plotly.graph_objects as go

from analysis.explore.state import Playing
from analysis.looks import BLUE, GREY, look_of
from analysis.outlines import MM, outlines
from sidmacib.chain.failure import first_failure
from sidmacib.chain.rule import RULES, LawCapacity
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.load_path import load_path
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.spread import static_capacity
from sidmacib.pieces import assemble
from sidmacib.weights import lock_weights

RATIOS = (0.0, 0.1, 0.3, 1.0, math.inf)  # of the curve, e / a
COARSE = 0.999  # mesh over the shorter side of a lock: nine Lobatto nodes on each root
FONT = {"size": 13}


@dataclass(frozen=True)
class Share:
    """A lock by number, its block, and what it carries over its strength."""

    lock: int
    block: str
    weight: float


@dataclass(frozen=True)
class Peak:
    """The largest load along a direction: shear (N), torque (N m), shares of the locks."""

    shear: float
    torque: float
    shares: tuple[Share, ...]


@dataclass(frozen=True)
class Answers:
    """What models say of a joint at the chosen eccentricity, and why some do not."""

    peak: Peak | None
    rules: dict[str, LawCapacity]
    words: str


@lru_cache(maxsize=512)
def peak(joint: Joint, ratio: float) -> Peak | None:
    """The static model on its coarsest mesh; None if the joint carries nothing.

    Of pieces that bend, where it takes minutes, the first failure of the law.
    """
    direction = Direction(ratio)
    return _peak(joint, direction) if joint.elastic is None else _first_failure(joint, direction)


def _first_failure(joint: Joint, direction: Direction) -> Peak | None:
    try:
        state = first_failure(joint, Loading(direction))
    except (CapacityError, ValueError):
        return None
    shares = tuple(
        Share(lock, "upper" if joint.is_upper(lock) else "lower", math.hypot(x, y) / joint.T0)
        for lock, x, y in zip(joint.numbers, state.force_x, state.force_y, strict=True)
    )
    return Peak(state.load * direction.shear, state.load * direction.torque * joint.a, shares)


@lru_cache(maxsize=512)
def spread_words(joint: Joint, ratio: float) -> str:
    """How far the static model's peak spreads along e / a, and what counts where it is too far.

    It takes longer than the peak: it stands in the legend of the curve, which is drawn last. Empty
    where there is no such peak.
    """
    if joint.elastic is not None:
        return ""
    direction = Direction(ratio)
    assembly = assemble(joint, COARSE * joint.least_side)
    try:
        found = static_capacity(assembly, lateral_load(joint, assembly, Loading(direction)))
    except CapacityError:
        return ""
    spread = 100.0 * found.spread
    if found.is_peak:
        return f" (spread {spread:.1f} % at {ratio:g} a)"
    return (
        f" (at {ratio:g} a peaks spread by {spread:.0f} % or more: count on the first failure, "
        f"V = {found.load * direction.shear:.4g} N)"
    )


def _peak(joint: Joint, direction: Direction) -> Peak | None:
    try:
        assembly, solution = load_path(joint, Loading(direction), COARSE * joint.least_side)
    except CapacityError:
        return None
    load = float(solution.peak.load)
    shares = tuple(
        Share(each.lock, each.block, each.weight)
        for each in lock_weights(joint, assembly, solution.peak.force)
    )
    return Peak(load * direction.shear, load * direction.torque * joint.a, shares)


def answers(state: Playing) -> Answers:
    """Peak, law and safe rule at the chosen eccentricity; a refusal is told, not raised."""
    joint, ratio = state.joint, state.eccentricity
    found = peak(joint, ratio)
    what = "peak" if joint.elastic is None else "first failure"
    words = (
        f"At e = {ratio:g} a nothing carries the load."
        if found is None
        else f"At e = {ratio:g} a the {what} is at V = {found.shear:.4g} N, M = {found.torque:.3g} "
        "N m."
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
    bends = state.joint.elastic is not None
    what, model = ("first failure", look_of("law")) if bends else ("peak", look_of("static"))
    figure.add_scatter(
        x=[point.shear for point in points],
        y=[point.torque for point in points],
        name=f"{what}, {model.name}{spread_words(state.joint, state.eccentricity)}",
        mode="lines+markers",
        line={"color": model.colour},
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
    """What each lock carries over its strength, where the joint carries most or first fails."""
    figure = go.Figure()
    if told.peak is not None:
        for block, colour in (("upper", BLUE), ("lower", GREY)):
            own = [each for each in told.peak.shares if each.block == block]
            figure.add_bar(
                x=[f"{each.lock}" for each in own],
                y=[each.weight for each in own],
                name=f"{block} block",
                marker_color=colour,
            )
        figure.update_xaxes(
            categoryorder="array", categoryarray=[f"{e.lock}" for e in told.peak.shares]
        )
    figure = _laid_out(figure, "lock", "weight")
    figure.update_yaxes(range=[0, 1.05])
    return figure


def drawing(state: Playing) -> go.Figure:
    """The joint from the side: upper block blue, lower block grey, locks numbered."""
    joint, figure = state.joint, go.Figure()
    for piece in outlines(joint):
        (_, left, low), (_, right, high) = piece.low, piece.high
        figure.add_shape(
            type="rect",
            x0=left,
            x1=right,
            y0=low,
            y1=high,
            fillcolor=BLUE if piece.upper else GREY,
            opacity=0.9 if piece.lock is not None else (0.4 if piece.upper else 0.5),
            line={"color": "#1c1f24", "width": 1},
        )
        if piece.lock is not None:
            middle = {"x": (left + right) / 2, "y": (low + high) / 2}
            figure.add_annotation(**middle, text=str(piece.lock), showarrow=False)
    width, top, bottom = MM * joint.total_width, MM * (joint.h + joint.H), -MM * joint.H
    figure.add_annotation(x=0, y=top / 2, ax=-60, ay=0, text="V", showarrow=True, arrowwidth=2)
    figure = _laid_out(figure, "y (mm)", "z (mm)")
    figure.update_xaxes(range=[-0.15 * width, 1.05 * width])
    figure.update_yaxes(scaleanchor="x", range=[bottom, 1.1 * top])
    return figure


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
