"""Figures of the campaign: the law on one curve, its errors, the rules, and a nomogram."""

from collections.abc import Callable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from analysis.figures import style
from sidmacib.rule.pairs import Pairs
from studies.locks.tables import POINTS, known
from workflow.results.tables import read_table
from workflow.step import Arguments, FileLists, Files, step

MOST_DRAWN = 20_000  # points of a figure: more would not be seen
REACH = 10.0  # %, of errors of the law that are drawn
RANGES = 12  # of first failures, each with its percentiles
FEWEST = 10  # points of a range that has percentiles


def smooth_shear(points: pd.DataFrame) -> pd.DataFrame:
    """Smooth columns under a plate in pure shear: locks that work over those of a long joint."""
    smooth = points[
        points["eccentricity_over_a"].eq(0.0)
        & points["plate"]
        & points["upper_body"].eq("columns")
        & points["friction"].eq(0.0)
        & points["first_failure"].gt(0.0)
        & points["saturation"].gt(0.0)
    ]
    return smooth.assign(
        working=smooth["first_failure"] / smooth["saturation"],
        row=smooth["pairs"] / smooth["saturation"],
    )


def collapse(points: pd.DataFrame) -> Figure:
    """Pure shear on one curve, and the law against the static model in all directions."""
    figure = Figure(figsize=(9.6, 4.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    smooth = smooth_shear(points)
    left.plot(smooth["row"], smooth["working"], ".", ms=2.5, color=style.COLOURS[0], label="joints")
    reach = np.linspace(0.0, max(4.0, float(smooth["row"].max())), 300)
    left.plot(reach, np.tanh(reach), color="0.2", lw=1.2, label="tanh")
    left.set_xlabel("pairs of locks P / locks that work if there are many")
    left.set_ylabel("locks that work / locks that work if there are many")
    left.set_xlim(0, 5)
    left.set_ylim(bottom=0)
    left.legend(fontsize=8)
    _errors(right, points)
    style.caption(
        figure,
        f"{_origin(points)}{len(smooth)} smooth ones with columns in pure shear (left), "
        f"{points['law'].notna().sum()} points in "
        "all directions (right). Locks that work: load at the first failure of the static model "
        "over T0; many: 41 locks, after the law. Errors beyond "
        f"{REACH:g} % are drawn there. Most points off the curve are even joints pushed "
        "from the side of a lower lock: the curve knows no such end, the law does.",
        height=0.12,
    )
    return figure


def _origin(points: pd.DataFrame) -> str:
    """A sentence with the number of joints of each sampling."""
    counts = points.groupby("sampling", sort=True)["number"].nunique()
    listed = ", ".join(f"{count} of {name}" for name, count in counts.items())
    return f"Joints of the samplings: {listed}. "


def _errors(axes: Axes, points: pd.DataFrame) -> None:
    """The law's error in per cent over the first failure, each point and percentiles of ranges."""
    held = points[points["law"].gt(0.0) & known(points) & points["plate"]]
    error = 100.0 * (held["law"] / held["first_failure"] - 1.0)
    shown = held.iloc[:: max(1, len(held) // MOST_DRAWN)]
    for rough, colour in ((True, style.COLOURS[1]), (False, style.COLOURS[0])):
        rows = shown[shown["friction"].gt(0.0).eq(rough)]
        look = {"ms": 2.0, "color": colour, "alpha": 0.6, "label": "rough" if rough else "smooth"}
        axes.plot(rows["first_failure"], error[rows.index].clip(-REACH, REACH), ".", **look)
    edges = np.geomspace(held["first_failure"].min(), held["first_failure"].max(), RANGES + 1)
    ranges = pd.cut(held["first_failure"], edges, include_lowest=True)
    grouped = error.groupby(ranges, observed=True)
    bands = grouped.quantile([0.05, 0.5, 0.95]).unstack()[grouped.size() >= FEWEST]
    middles = [np.sqrt(each.left * each.right) for each in bands.index]
    axes.plot(middles, bands[0.5], color="0.1", lw=1.4, label="median")
    for share in (0.05, 0.95):
        label = "5 and 95 %" if share == 0.05 else None
        axes.plot(middles, bands[share], color="0.1", lw=1.0, ls="--", label=label)
    axes.axhline(0.0, color="0.4", lw=0.8)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(-REACH, REACH)
    axes.set_xlabel("first failure / T0, static model")
    axes.set_ylabel("law over first failure, less 1 (%)")
    axes.legend(fontsize=8, markerscale=4)


def margins(points: pd.DataFrame) -> Figure:
    """Margins of law and safe rule over the loads that they stand for."""
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    held = points[points["plate"] & points["peak"].gt(0.0) & known(points)]
    kinds = (
        ("law", "first_failure", "law over first failure (%)", (-20, 20)),
        ("safe", "peak", "safe rule over brittle peak (%)", (-50, 10)),
    )
    for axes, (value, reference, words, reach) in zip(figure.subplots(1, 2), kinds, strict=True):
        for (least, most), colour in zip(
            ((0, 0.1), (0.3, 1), (3, np.inf)), style.COLOURS, strict=False
        ):
            rows = held[held["eccentricity_over_a"].between(least, most) & held[value].gt(0.0)]
            error = 100.0 * (rows[value] / rows[reference] - 1.0)
            label = "e from 3 a to torsion" if least == 3 else f"e from {least:g} to {most:g} a"
            axes.hist(
                error.clip(*reach), bins=70, range=reach, histtype="step", color=colour, label=label
            )
        axes.axvline(0.0, color="0.2", lw=1.0)
        axes.set_xlabel(words)
        axes.set_ylabel("points")
        axes.legend(fontsize=8)
    style.caption(
        figure,
        f"{_origin(points)}{len(held)} points under a plate; values beyond the axis are counted "
        "at its ends. The peak lies above the first failure under torque, so the margin is larger "
        "there.",
        height=0.08,
    )
    return figure


def nomogram(points: pd.DataFrame) -> Figure:
    """The lag from sizes and stiffnesses, and locks that work from it and the pairs."""
    figure = Figure(figsize=(9.6, 4.9), layout="constrained")
    left, right = figure.subplots(1, 2)
    pair = np.logspace(-2.5, 1.5, 200)  # k / (Kn a b)
    for height, colour in zip((0.3, 0.6, 1.0, 2.0, 3.0), style.COLOURS, strict=False):
        lag = 2.0 * pair / height
        left.loglog(pair, lag, color=colour, label=f"H / b = {height:g}")
    left.set_xlabel("k / (Kn a b),   1 / k = 2 / (Ks a b) + 1 / (Kd a h)")
    left.set_ylabel("lag r = 2 k / (Kn a H)")
    left.legend(fontsize=8)
    lags = np.logspace(-3, 1.5, 200)
    for count, colour in zip((1, 2, 3, 4, 5, 7, 10, 15), style.COLOURS * 2, strict=False):
        right.semilogx(lags, [Pairs(count, lag).working for lag in lags], color=colour)
        right.annotate(f"{count}", (lags[0], Pairs(count, lags[0]).working), fontsize=7)
    right.semilogx(lags, [Pairs(1, lag).most for lag in lags], "k--", lw=1.0, label="any number")
    right.set_ylim(0, 15.5)
    right.set_xlabel("lag r")
    right.set_ylabel("locks that work, V / T0")
    right.legend(fontsize=8)
    style.caption(
        figure,
        "Columns, smooth dry faces, pure shear, closed form of the pairs (numbers at the curves); "
        "one rigid piece has no lag. Valid where a dry face is softer than a root, Kd h < Ks b.",
        height=0.08,
    )
    return figure


DRAWN: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "law": collapse,
    "law_margins": margins,
    "law_nomogram": nomogram,
}


def run(arguments: Arguments, inputs: Files, outputs: FileLists) -> None:
    """Draw every figure into the files that are named after it."""
    points = read_table(POINTS, inputs["points"])
    for name, draw in DRAWN.items():
        style.save(draw(points), [path for path in outputs["figures"] if path.stem == name])


if __name__ == "__main__":
    step(run)
