"""The data that figures are drawn from, the look that they share, and how they are saved."""

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pandas as pd
from matplotlib.figure import Figure

from analysis.drawing import SERIES, label_of
from analysis.figures import IN_THE_PAPER, FigureSpec, followed_models
from analysis.published import read_published
from analysis.tables import study_points
from sidmacib.drawing import write_figure
from sidmacib.models import MODELS, SOLVED, detailed
from workflow.case import REFERENCE
from workflow.results.joint_part import JointRecord
from workflow.schema import Study

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


MARKS = tuple(
    {"linestyle": "none", "marker": marker, "markersize": 4, "markerfacecolor": "white"}
    for marker in ("o", "x", "s", "D")
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
    """Write the figure to each of ``paths``, as high as its caption is long."""
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        write_figure(figure, path, bbox_inches="tight")


@dataclass(frozen=True)
class FigureData:
    """A figure's specification, the study, its tables, and the stresses that the figure shows.

    ``stresses``: record and nodes, in `NODE_COLUMNS`, of the figure's case; None if it failed.
    """

    spec: FigureSpec
    study: Study
    stresses: tuple[JointRecord, pd.DataFrame] | None
    capacity: pd.DataFrame
    validation: pd.DataFrame
    models: pd.DataFrame
    envelopes: pd.DataFrame
    variants: pd.DataFrame

    @property
    def shown_models(self) -> tuple[str, ...]:
        """The models of the joint's pieces, the leading one first, those from elsewhere last."""
        rows = self.models
        if self.spec.sample is not None:
            rows = rows[rows["sample"] == self.spec.sample]
        names = rows["model"].unique()
        ordered = [m for m in (*detailed(self.study.model_names), *self.study.models) if m in names]
        return *dict.fromkeys(ordered), *(model for model in names if model not in ordered)

    @property
    def leading(self) -> str:
        """The model that SiDMACIB is shown against."""
        return followed_models(self.study, self.sample)[0]

    def in_order(self, table: pd.DataFrame, sample: str, mesh: float) -> pd.DataFrame:
        """Rows of ``table`` for a sample at a mesh (m), from pure shear to pure torsion."""
        rows = study_points(self.study, table[table["sample"] == sample])
        return rows[rows["mesh_m"] == mesh].sort_values("eccentricity_over_a", kind="stable")

    def curve(self, model: str, sample: str, mesh: float) -> pd.DataFrame:
        """Capacities of a model in the reference variant, from pure shear to pure torsion."""
        rows = self.capacity[
            (self.capacity["model"] == model) & (self.capacity["variant"] == REFERENCE)
        ]
        return self.in_order(rows, sample, mesh).dropna(subset=["load_N"])

    @property
    def sample(self) -> str:
        """The sample that the figure shows."""
        assert self.spec.sample is not None, f"{self.spec.name} shows no single sample"
        return self.spec.sample

    @property
    def assumed_geometry(self) -> str:
        """Words on geometry and friction where they stand for the paper's."""
        published = read_published()
        samples = published.samples(self.study)
        if not samples:
            return ""
        words = "Assumed: a, b, h and H (the paper's text gives a·b only)."
        shown = [s for s in samples if self.spec.sample in (None, s)]
        if other := [s for s in shown if not published.as_printed(self.study, s)]:
            frictions = {f"{self.study.joint(s).dry.friction:.4g}" for s in other}
            words += (
                f" {', '.join(other)}: friction {', '.join(sorted(frictions))} on dry faces, to "
                f"fit, not the printed {published.numbers['sample']['friction']:g}."
            )
        return words

    @property
    def place_in_paper(self) -> str:
        """A sentence that names the figure of the paper this redraws; empty if none."""
        numbers = IN_THE_PAPER.get(self.spec.kind, {})
        published = read_published().samples(self.study)
        shown = self.spec.sample
        locks = [n for sample, n in published.items() if shown in (None, sample)]
        found = [numbers[n] for n in locks if n in numbers]
        return f"{' and '.join(dict.fromkeys(found))} of the paper, redrawn. " if found else ""
