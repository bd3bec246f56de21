"""The figure of fragility: motions that a structure stands, that bring it down, and the fit."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.stats import norm

from analysis.figures import style
from analysis.tables.earthquakes import CONFIDENCE, INTENSITIES, known
from sidmacib.drawing import BLUE, GREY, VERMILION
from workflow.results.tables import EARTHQUAKES, FRAGILITY, read_table
from workflow.step import Arguments, step


def figure(name: str, earthquakes: pd.DataFrame, fragilities: pd.DataFrame) -> Figure:
    """The motions of a structure that it stands, those that fell it, and its fragility."""
    rows = known(earthquakes[earthquakes["structure"] == name])
    drawn = Figure(figsize=(9.0, 3.6), layout="constrained")
    for axes, (column, (words, unit)) in zip(
        drawn.subplots(1, 2, sharey=True), INTENSITIES.items(), strict=True
    ):
        x, fell = rows[column] / unit, rows["falls"].astype(bool)
        axes.plot(x[fell], np.ones(fell.sum()), "x", color=VERMILION, label="falls")
        axes.plot(x[~fell], np.zeros((~fell).sum()), "o", mfc="none", color=BLUE, label="stands")
        same = (fragilities["structure"] == name) & (fragilities["intensity"] == column)
        for row in fragilities[same].dropna(subset=["median"]).to_dict("records"):
            along = np.linspace(1e-3, 1.1, 200) * float(x.max())
            share = norm.cdf(np.log(along * unit / row["median"]) / row["dispersion"])
            axes.plot(along, share, color=GREY, label="lognormal fit")
            if pd.notna(row["median_low"]):
                ends = [row["median_low"] / unit, row["median_high"] / unit]
                label = f"{100 * CONFIDENCE:g} %"
                axes.plot(ends, [0.5, 0.5], color=GREY, linewidth=4, alpha=0.5, label=label)
        axes.set_xlabel(words)
        axes.set_xlim(left=0.0)
    drawn.axes[0].set_ylabel("share that falls")
    drawn.axes[0].legend(loc="center right")
    drawn.suptitle(f"{name}: {len(rows)} ground motions", fontsize=10)
    return drawn


def run(arguments: Arguments, inputs: dict[str, Any], outputs: dict[str, Any]) -> None:
    """Draw the figure of each structure."""
    earthquakes = read_table(EARTHQUAKES, inputs["earthquakes"])
    fragilities = read_table(FRAGILITY, inputs["fragility"])
    for path in outputs["figures"]:
        name = path.stem.removeprefix("fragility-")
        style.save(figure(name, earthquakes, fragilities), [path])


if __name__ == "__main__":
    step(run)
