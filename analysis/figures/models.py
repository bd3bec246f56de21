"""The models of the joint's pieces beside each other, and the effects of variants."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analysis.drawing import label_of
from analysis.figures import shown_samples, style
from analysis.figures.curves import model_curve, published_point, rule_curve
from analysis.figures.style import FigureData
from analysis.paths import behind, path_again
from analysis.tables.collect import SHARES
from sidmacib.drawing import vm_axes
from sidmacib.joint import UpperBody
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.models import LAWS, REFERENCE_MODEL, detailed
from workflow.case import JointSubject, case_name
from workflow.cases import cases_of

MOST_BEHIND = 40  # points of a path behind its peak
BODIES = {  # those that are drawn: words and line
    UpperBody.COLUMNS: ("columns", "o-"),
    UpperBody.MONOLITHIC: ("one piece", "s--"),
}
RIGID = 30.0  # a rigid block is drawn this many times as stiff as the stiffest that bends


def models(material: FigureData) -> Figure:
    """Curves, weights, displacements and friction of all models of a sample, at the finest mesh."""
    study, mesh = material.study, min(material.study.meshes)
    if not material.shown_models:
        return style.words_only(f"No model has a result of {material.sample}; see the summary.")
    rows = material.in_order(material.models, material.sample, mesh)
    figure = Figure(figsize=(8.6, 8.2), layout="constrained")
    (curves, weights), (moved, friction) = figure.subplots(2, 2)
    for model in material.shown_models:
        model_curve(curves, material, model, material.sample, mesh)
    laws = [name for name in LAWS if name in study.models]
    for law in laws:
        rule_curve(curves, material, law, material.sample, mesh)
    names = " and ".join(label_of(law).name for law in laws)
    dotted = f"Dotted: {names}; the law gives first failures. " if laws else ""
    published_point(curves, material, material.sample)
    vm_axes(curves, "largest loads")
    curves.set_ylim(top=1.35 * curves.get_ylim()[1])  # room for the legend
    curves.legend(fontsize=7, loc="upper right")
    ratio = min(study.eccentricities)
    first = rows[rows["eccentricity_over_a"] == ratio].set_index("model")
    place = f"e = {ratio:g} a" if ratio else "e = 0"
    _weights(weights, material.shown_models, first, study.samples[material.sample].locks)
    weights.set_title(f"weights at {place}", loc="left", fontsize=10)
    _displacements(moved, material.shown_models, first)
    moved.set_ylabel("√(V² + (M / a)²) (N)" if ratio else "load (N)")
    path = _path(moved, material)
    moved.set_xlim(left=0)
    moved.set_ylim(bottom=0)
    moved.legend(fontsize=8)
    moved.set_title(f"displacement at {place}", loc="left", fontsize=10)
    _friction(friction, material.shown_models, rows)
    style.caption(
        figure,
        f"The same pieces and nodes, {study.samples[material.sample].locks} locks, mesh {mesh:g} "
        "m. Distinct elements and the static model follow brittle failure and Coulomb friction; "
        "limit analysis redistributes freely, has no friction here and does not move: its weights "
        "are one state of many. Weight: shear on a lock over T0. Displacement: the one that the "
        "load works on; marks: at a quarter, half and three quarters of the first failure. "
        f"{path}Friction: V that reaches the lower body other than by its locks. "
        f"{dotted}{material.assumed_geometry}",
        height=0.13,
    )
    return figure


def _weights(axes: Axes, models: Sequence[str], rows: pd.DataFrame, locks: int) -> None:
    numbers = np.arange(1, locks + 1)
    width = 0.8 / len(models)
    for index, model in enumerate(models):
        if model not in rows.index:
            continue
        row = rows.loc[model]
        values = [row[f"weight_lock{number}"] for number in numbers]
        shift = (index - (len(models) - 1) / 2) * width
        bar = axes.bar(numbers + shift, values, width, color=label_of(model).colour)
        axes.bar_label(bar, fmt="%.2f", fontsize=6, rotation=90, padding=2)
    axes.set_xticks(numbers)
    axes.set_xlabel("lock")
    axes.set_ylabel("weight")
    axes.set_ylim(0, 1.4)
    axes.set_axisbelow(True)
    axes.grid(axis="x", visible=False)


def _displacements(axes: Axes, models: Sequence[str], rows: pd.DataFrame) -> None:
    """Marks of all models but the static one, whose whole path is drawn."""
    for model in models:
        if model == REFERENCE_MODEL or model not in rows.index:
            continue
        row = rows.loc[model]
        moved = np.array([row[f"displacement_at_{100 * share:g}_percent_m"] for share in SHARES])
        loads = [share * row["given_load_N"] for share in SHARES]
        if not np.isnan(moved).any():
            axes.plot(1e6 * moved, loads, **style.of_model(model), label=label_of(model).name)
    axes.set_xlabel("displacement (µm)")


def _path(axes: Axes, material: FigureData) -> str:
    """The static model's whole path, to the peak and behind it; the sentence on it."""
    ratio = min(material.study.eccentricities)
    name = case_name(material.sample, min(material.study.meshes), ratio)
    case = cases_of(material.study).get(f"{JointSubject.kind}/{REFERENCE_MODEL}/{name}")
    if case is None or REFERENCE_MODEL not in material.shown_models:
        return ""
    again = path_again(case.subject)
    if again is None:
        return ""
    problem, solution = again
    path = solution.path
    followed = behind(problem, path[-1], ratio, MOST_BEHIND)
    label = label_of(REFERENCE_MODEL)

    def draw(points: Sequence[Equilibrium], style: str, **look: Any) -> None:
        places = [1e6 * point.displacement for point in points]
        axes.plot(places, [point.load for point in points], style, color=label.colour, **look)

    draw(path, "-", lw=1.2, label=label.name)
    if followed is not None:
        draw((path[-1], *followed), "o:", ms=3, lw=1.0, label="behind the peak")
    draw(path[-1:], "*", ms=9)
    if followed is None:
        return "Star: the peak. "
    if not followed:
        return "Star: the peak; behind it no equilibrium is left. "
    return (
        "Star: the peak; dotted: what is left behind it if the load is let down as bonds fail, "
        "one after the other. "
    )


def _friction(axes: Axes, models: Sequence[str], rows: pd.DataFrame) -> None:
    for model in models:
        curve = rows[(rows["model"] == model) & np.isfinite(rows["eccentricity_m"])]
        line = style.of_model(model)
        shares = 100 * curve["friction_share"]
        axes.plot(curve["eccentricity_m"], shares, **line, label=label_of(model).name)
    axes.set_xlabel("eccentricity e (m)")
    axes.set_ylabel("friction (% of V)")
    axes.set_title("friction share at the peak", loc="left", fontsize=10)
    axes.legend(fontsize=8)


def variant_rows(
    material: FigureData, varied: "Callable[[pd.DataFrame], pd.Series[bool]]"
) -> pd.DataFrame:
    """Rows of the table of variants that are drawn: of one model, at the finest mesh.

    The model is the first detailed one that has any of the ``varied`` rows; of none, no rows.
    """
    table, study = material.variants, material.study
    models = detailed(study.model_names)
    rows = table[
        np.isclose(table["mesh_m"], min(study.meshes))
        & table["sample"].isin(shown_samples(study))
        & table["upper_body"].isin(BODIES)
    ]
    able = set(rows["model"][varied(rows)])
    return rows[rows["model"] == next((model for model in models if model in able), None)]


def stiffness(material: FigureData) -> Figure:
    """Capacity, lower locks' weights and the rule's error against the stiffness of the block."""
    rows = variant_rows(material, lambda rows: rows["stiffness_ratio"].notna())
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
            ratios = sorted(set(rows["stiffness_ratio"].dropna()))
            axes.set_xscale("log")
            axes.set_xticks([*ratios, RIGID * stiffest], [*(f"{r:g}" for r in ratios), "rigid"])
            axes.set_xticks([], minor=True)
            axes.set_xlabel("E / (Kn b)")
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
    rows = variant_rows(material, lambda rows: rows["failure"] == "softening")
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
    samples = rows["sample"].unique()
    for sample, colour in zip(samples, style.COLOURS * 3, strict=False):
        for body, (_, line) in BODIES.items():
            points = rows[(rows["sample"] == sample) & (rows["upper_body"] == body)]
            points = points.sort_values("drawn")
            axes.plot(points["drawn"], points[column], line, color=colour, ms=3.5)
    axes.set_ylabel(words)
    axes.set_ylim(bottom=0)


def _key(figure: Figure, rows: pd.DataFrame) -> None:
    """Draw the legend of samples (colours) and bodies (lines) once, above all panels."""
    samples = zip(rows["sample"].unique(), style.COLOURS * 3, strict=False)
    handles = [Line2D([], [], color=colour, label=name) for name, colour in samples]
    for body, (words, line) in BODIES.items():
        if body in set(rows["upper_body"]):
            look = {"color": "0.3", "marker": line[0], "ls": line[1:], "ms": 3.5}
            handles.append(Line2D([], [], label=words, **look))
    figure.legend(handles=handles, fontsize=8, ncols=len(handles), loc="outside upper center")
