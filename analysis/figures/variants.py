"""Effects of variants: capacity against the stiffness of the block, and against fracture energy."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.figures import style
from analysis.figures.catalogue import shown_samples
from analysis.figures.material import FigureData
from sidmacib.joint.joint import UpperBody

BODIES = {  # those that are drawn: words and line
    UpperBody.COLUMNS: ("columns", "o-"),
    UpperBody.MONOLITHIC: ("one piece", "s--"),
}
RIGID = 30.0  # a rigid block is drawn this many times as stiff as the stiffest that bends


def shown_rows(material: FigureData) -> pd.DataFrame:
    """Rows of the table of variants that are drawn: at the finest mesh of the study."""
    table, study = material.variants, material.study
    return table[
        np.isclose(table["mesh_m"], min(study.meshes))
        & table["sample"].isin(shown_samples(study))
        & table["upper_body"].isin(BODIES)
    ]


def of_one_model(
    material: FigureData, rows: pd.DataFrame, varied: "pd.Series[bool]"
) -> pd.DataFrame:
    """The ``rows`` of the first detailed model that has any of the ``varied``; of none, no rows."""
    able = set(rows["model"][varied])
    return rows[rows["model"] == next((m for m in material.detailed if m in able), None)]


def stiffness(material: FigureData) -> Figure:
    """Capacity, lower locks' weights and the rule's error against the stiffness of the block."""
    rows = shown_rows(material)
    rows = of_one_model(material, rows, rows["stiffness_ratio"].notna())
    if rows.empty:
        return style.words_only("No block of another stiffness has a result; see the summary.")
    stiffest = rows["stiffness_ratio"].max()
    rows = rows.assign(drawn=rows["stiffness_ratio"].fillna(RIGID * stiffest))
    least = rows[np.isclose(rows["eccentricity_m"], rows["eccentricity_m"].min())]
    figure = Figure(figsize=(11.0, 4.8), layout="constrained")
    loads, weights, shares = figure.subplots(1, 3)
    _against(loads, least, "load_over_T0", "pure shear: largest V / T0")
    _against(weights, least, "lower_weight_sum", "pure shear: weights of the lower locks, summed")
    fitted = least.dropna(subset=["misfit"])
    _against(
        shares,
        fitted.assign(share=1.0 / (1.0 + fitted["largest_unsafe_error"])),
        "share",
        "carried / promised by (n \N{MINUS SIGN} 1)/2, worst direction",
    )
    if fitted.empty:
        shares.set_axis_off()
    shares.axhline(1.0, color="0.3", lw=1.0, ls=":")
    shares.set_ylim(0.0, 1.05)
    for axes in (loads, weights, shares):
        if axes.axison:
            _stiffness_axis(axes, sorted(set(rows["stiffness_ratio"].dropna())), stiffest)
    _key(figure, rows)
    style.caption(
        figure,
        f"{rows['model'].iloc[0]}, mesh {min(material.study.meshes):g} m. E: Young's modulus of "
        "the block, Kn b: stiffness of an inner face times the width of a lock. "
        "(n \N{MINUS SIGN} 1)/2: the paper's rule for how many locks count, with the option that "
        "fits that block best, without friction; below the dotted line it is unsafe.",
        height=0.13,
    )
    return figure


def fracture_energy(material: FigureData) -> Figure:
    """Capacity against the fracture energy of the bonds, direction by direction."""
    rows = shown_rows(material)
    rows = of_one_model(material, rows, rows["failure"] == "softening")
    if rows.empty:
        return style.words_only("No bond that softens has a result; see the summary.")
    faded = rows[rows["failure"] == "softening"]
    samples = [s for s in shown_samples(material.study) if s in set(faded["sample"])]
    figure = Figure(figsize=(3.3 * max(len(samples), 2), 3.9), layout="constrained")
    panels = figure.subplots(1, len(samples), squeeze=False)[0]
    for axes, sample in zip(panels, samples, strict=True):
        points = faded[faded["sample"] == sample]
        ends = rows[(rows["sample"] == sample) & (rows["failure"] != "softening")]
        directions = points.sort_values("fracture_energy_J_m2").groupby("eccentricity_m")
        for (e, curve), colour in zip(directions, style.COLOURS * 3, strict=False):
            ratio = e / material.study.joint(sample).a
            label = "torsion" if np.isinf(e) else f"e = {ratio:g} a"
            style_of = {"color": colour, "ms": 3.5}
            axes.plot(
                "fracture_energy_J_m2", "load_over_T0", "o-", data=curve, label=label, **style_of
            )
            for failure, line in (("brittle", ":"), ("ductile", "--")):
                there = ends[(ends["failure"] == failure) & (ends["eccentricity_m"] == e)]
                for load in there["load_over_T0"]:
                    axes.axhline(load, color=colour, lw=0.8, ls=line)
        axes.set_xscale("log")
        axes.set_ylim(bottom=0)
        axes.set_title(sample, loc="left", fontsize=10)
        axes.set_xlabel("fracture energy (J/m²)")
    figure.axes[0].legend(fontsize=7)
    figure.axes[0].set_ylabel("largest load along the path / T0")
    style.caption(
        figure,
        f"{rows['model'].iloc[0]}, mesh {min(material.study.meshes):g} m. Dotted: brittle bonds, "
        "dashed: ductile ones.",
        height=0.1,
    )
    return figure


def _against(axes: Axes, rows: pd.DataFrame, column: str, words: str) -> None:
    """Curves of ``column`` over the stiffness, one for each sample and body."""
    for (sample, body), colour in _curves(rows):
        points = rows[(rows["sample"] == sample) & (rows["upper_body"] == body)].sort_values(
            "drawn"
        )
        axes.plot(points["drawn"], points[column], BODIES[body][1], color=colour, ms=3.5)
    axes.set_ylabel(words)
    axes.set_ylim(bottom=0)


def _curves(rows: pd.DataFrame) -> Iterator[tuple[tuple[str, UpperBody], str]]:
    samples = dict.fromkeys(rows["sample"])
    for sample, colour in zip(samples, style.COLOURS * 3, strict=False):
        for body in BODIES:
            yield (sample, body), colour


def _stiffness_axis(axes: Axes, ratios: list[float], stiffest: float) -> None:
    axes.set_xscale("log")
    axes.set_xticks([*ratios, RIGID * stiffest], [*(f"{r:g}" for r in ratios), "rigid"])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("E / (Kn b)")


def _key(figure: Figure, rows: pd.DataFrame) -> None:
    """Draw the legend of samples (colours) and bodies (lines) once, above all panels."""
    samples = dict(zip(dict.fromkeys(rows["sample"]), style.COLOURS * 3, strict=False))
    handles = [Line2D([], [], color=colour, label=name) for name, colour in samples.items()]
    drawn = set(rows["upper_body"])
    for body, (words, line) in BODIES.items():
        if body in drawn:
            marker, dashes = line[0], line[1:]
            handles.append(
                Line2D([], [], color="0.3", marker=marker, ls=dashes, ms=3.5, label=words)
            )
    figure.legend(handles=handles, fontsize=8, ncols=len(handles), loc="outside upper center")
