"""The look that all figures share, and how they are saved."""

import os
import re
import textwrap
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.drawing import SERIES, label_of
from sidmacib.models import MODELS, SOLVED

ASSUMED_POINTS = "Assumed: the positions of the contact points."
COLOURS = SERIES
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

mpl.use("Agg")
mpl.rcParams.update(
    {
        "font.size": 9.0,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#dddddd",
        "grid.linewidth": 0.6,
        # A frame: what is in it is no point of a curve.
        "legend.frameon": True,
        "legend.framealpha": 0.9,
        "legend.edgecolor": "#bbbbbb",
        "legend.fancybox": False,
        "figure.dpi": 150,
    }
)


MARKS = (
    {"linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "white"},
    {"linestyle": "none", "marker": "x", "markersize": 4},
    {"linestyle": "none", "marker": "s", "markersize": 4, "markerfacecolor": "white"},
    {"linestyle": "none", "marker": "D", "markersize": 4, "markerfacecolor": "white"},
)
LINES = ({"linestyle": "-", "linewidth": 1.0}, {"linestyle": "--", "linewidth": 1.0})


def of_model(model: str) -> dict[str, Any]:
    """The style of a model, the same in every figure: models solved here have lines, others marks.

    It hangs on no result: an engine may have none at all.
    """
    solved = model in SOLVED
    alike = [name for name in MODELS if (name in SOLVED) == solved]
    styles = LINES if solved else MARKS
    return {"color": label_of(model).colour, **styles[alike.index(model) % len(styles)]}


def words_only(words: str) -> Figure:
    """A figure that says in ``words`` why there is nothing to draw."""
    figure = Figure(figsize=(8, 2), layout="constrained")
    figure.text(0.5, 0.5, words, ha="center")
    return figure


def caption(figure: Figure, text: str, height: float = 0.2) -> None:
    """Write ``text`` into the lowest ``height`` (share) of the figure, below everything else."""
    width = int(figure.get_figwidth() * 16.5)
    figure.get_layout_engine().set(rect=(0, height, 1, 0.985 - height))
    together = re.sub(r"(\d) (N|m|kPa)\b", "\\1\u00a0\\2", text)  # numbers and their units
    figure.text(0.02, height - 0.02, textwrap.fill(together, width), va="top", fontsize=8)


def save(figure: Figure, paths: list[Path]) -> None:
    """Write the figure to each of ``paths``, always with the same bytes."""
    os.environ["SOURCE_DATE_EPOCH"] = "0"
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(
            path,
            metadata={"Software": None} if path.suffix == ".png" else None,
            bbox_inches="tight",  # captions are as high as they are long
        )
