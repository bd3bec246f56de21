"""V-M capacities of the models as curves, and peaks and weights beside the published ones."""

import math
from itertools import cycle, pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.drawing import PUBLISHED, label_of, option_colour, option_name, rule_name
from analysis.figures import REVISED, followed_models, shown_samples, style
from analysis.figures.style import FigureData
from sidmacib.drawing import GREY, vm_axes, vm_curve
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import four_digits
from workflow.case import REFERENCE


def first_quadrant(vertices: Floats) -> Floats:
    """The part of a convex polygon around the origin with V >= 0 and M >= 0, from the V axis on."""
    closed = np.vstack([vertices, vertices[:1]])
    crossings = []
    for start, end in pairwise(closed):
        for axis in (0, 1):
            if start[axis] * end[axis] < 0:
                share = start[axis] / (start[axis] - end[axis])
                point = start + share * (end - start)
                point[axis] = 0.0
                crossings.append(point)
    points = np.array([*vertices, *crossings])
    inside = points[(points >= -1e-9).all(axis=1)] + 0.0
    return np.asarray(inside[np.argsort(np.arctan2(inside[:, 1], inside[:, 0]))])


def options(material: FigureData) -> Figure:
    """All contact-point options of a sample, every lock counting."""
    study, joint = material.study, material.study.joint(material.sample)
    given = joint.pressing_force
    overload = study.sidmacib.overload if given is None else given
    figure = Figure(figsize=(8, 4.4), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for axis, friction in zip(axes, (False, True), strict=True):
        for name in study.sidmacib.options:
            rows = material.envelopes[
                (material.envelopes["sample"] == material.sample)
                & (material.envelopes["option"] == name)
                & (material.envelopes["friction"] == friction)
            ]
            shear, torque = first_quadrant(rows[["shear_N", "torque_Nm"]].to_numpy()).T
            vm_curve(axis, shear, torque, option_name(name), color=option_colour(name))
    vm_axes(axes[0], "without friction along the locks")
    vm_axes(axes[1], "with friction along the locks")
    axes[0].legend()
    style.caption(
        figure,
        f"{material.place_in_paper}SiDMACIB, {joint.locks} locks, every lock counting: exact "
        f"envelopes, overload {four_digits(overload)} N; {'ΣT0' if joint.different else 'n·T0'} = "
        f"{four_digits(math.fsum(joint.strengths))} N. {style.ASSUMED_POINTS} "
        f"{material.assumed_geometry}",
    )
    return figure


def meshes(material: FigureData) -> Figure:
    """The curves of every model of the pieces and sample, at every mesh."""
    samples = shown_samples(material.study)
    across = min(len(samples), 2)
    down = -(-len(samples) // across)
    figure = Figure(figsize=(8, 1.2 + 3.4 * down), layout="constrained")
    places = figure.subplots(down, across, squeeze=False).ravel()
    for axis in places[len(samples) :]:
        axis.remove()
    for axis, sample in zip(places, samples, strict=False):
        for mesh, colour in zip(material.study.meshes, cycle(style.COLOURS), strict=False):
            for model in followed_models(material.study, sample):
                model_curve(axis, material, model, sample, mesh, color=colour)
        published_point(axis, material, sample)
        measured_points(axis, material, sample)
        vm_axes(axis, f"{sample}: {material.study.samples[sample].locks} locks")
        axis.set_ylim(top=1.5 * axis.get_ylim()[1])  # room for the legend
        axis.legend(fontsize=7, loc="upper right")
    style.caption(
        figure,
        f"{material.place_in_paper}Peak loads of the models of the joint's pieces; nodes: "
        f"{material.study.nodes}. {mesh_error_words(material)}{material.assumed_geometry}",
        height=0.9 / figure.get_figheight(),
    )
    return figure


def mesh_error_words(material: FigureData) -> str:
    """The largest mesh error at each mesh of the study, as a sentence; empty if none is known."""
    rows = material.capacity[material.capacity["variant"] == REFERENCE]
    largest = rows.groupby("mesh_m")["mesh_error"].max()
    found = [
        f"{100 * error:.1f} % at {mesh:g} m"
        for mesh, error in largest.items()
        if not np.isnan(error) and np.isclose(float(str(mesh)), material.study.meshes).any()
    ]
    return f"Mesh error, estimated from two meshes: up to {', '.join(found)}. " if found else ""


def revised(material: FigureData) -> Figure:
    """Revised SiDMACIB by two reductions, and the leading detailed model."""
    study = material.study
    titles = {name: rule_name(name) for name in REVISED if name in study.sidmacib.reductions}
    figure = Figure(figsize=(8, 4.8), layout="constrained")
    axes = figure.subplots(1, len(titles), sharex=True, sharey=True, squeeze=False)[0]
    rows = material.in_order(material.capacity, material.sample, min(study.meshes))
    limit = rows[
        rows["model"].eq("sidmacib")
        & rows["friction"].eq(False)
        & rows["weights_from"].eq(material.leading)
    ]
    for axis, reduction in zip(axes, titles, strict=True):
        for name in study.sidmacib.options:
            rows = limit[(limit["option"] == name) & (limit["reduction"] == reduction)]
            vm_curve(
                axis,
                rows["shear_N"],
                rows["torque_Nm"],
                option_name(name),
                color=option_colour(name),
            )
        for mesh, marker in zip(study.meshes, cycle(style.MARKERS), strict=False):
            curve = material.curve(material.leading, material.sample, mesh)
            label = f"{label_of(material.leading).name}, mesh {mesh:g} m"
            mark = {"linestyle": "none", "marker": marker, "markersize": 4, "color": "#444444"}
            mark |= {"markerfacecolor": "white", "clip_on": False, "zorder": 3}
            vm_curve(axis, curve["shear_N"], curve["torque_Nm"], label, **mark)
        published_point(axis, material, material.sample)
    for axis, title in zip(axes, titles.values(), strict=True):
        vm_axes(axis, title)
    axes[0].legend(fontsize=8)
    style.caption(
        figure,
        f"{material.place_in_paper}Revised SiDMACIB without friction (lines) against "
        f"{label_of(material.leading).name} (marks), "
        f"{study.samples[material.sample].locks} locks; weights read "
        f"at e = {min(study.eccentricities):g} a, mesh {min(study.meshes):g} m. "
        f"{style.ASSUMED_POINTS} {material.assumed_geometry}",
    )
    return figure


def model_curve(
    axis: Axes, material: FigureData, model: str, sample: str, mesh: float, **changes: Any
) -> None:
    """The V-M curve of a model of the pieces, in the style of the model but for ``changes``."""
    curve = material.curve(model, sample, mesh)
    label = f"{label_of(model).name}, mesh {mesh:g} m"
    line = style.of_model(model) | changes
    vm_curve(axis, curve["shear_N"], curve["torque_Nm"], label, clip_on=False, zorder=3, **line)


def rule_curve(axis: Axes, material: FigureData, rule: str, sample: str, mesh: float) -> None:
    """The V-M curve of the law or the safe rule, if the study asks for it."""
    curve, label = material.curve(rule, sample, mesh), label_of(rule)
    line = {"linestyle": ":", "linewidth": 1.2, "color": label.colour}
    vm_curve(axis, curve["shear_N"], curve["torque_Nm"], label.name, **line)


def published_point(axis: Axes, material: FigureData, sample: str) -> None:
    """The paper's peak in pure shear, if it has the sample."""
    capacity = material.capacity
    rows = capacity[(capacity["sample"] == sample) & (capacity["variant"] == "3dec")]
    mark = {"linestyle": "none", "marker": "*", "markersize": 11, "markerfacecolor": "none"}
    mark |= {"color": PUBLISHED.colour, "clip_on": False, "zorder": 4}
    vm_curve(axis, rows["shear_N"], rows["torque_Nm"], f"{PUBLISHED.name}, e = 0", **mark)


def measured_points(axes: Axes, material: FigureData, sample: str) -> None:
    """Loads that were measured on a sample, if the study has any."""
    given = material.study.measured
    loads = [load for load in given.loads if load.sample == sample] if given else []
    a = material.study.joint(sample).a
    shear, torque = zip(*(load.components(a) for load in loads), strict=True) if loads else ((), ())
    mark = {"linestyle": "none", "marker": "*", "markersize": 9, "color": "k", "zorder": 5}
    vm_curve(axes, shear, torque, "measured", **mark)


def side_by_side(material: FigureData) -> Figure:
    """Peaks and weights as bars; the table of validation has all published values."""
    table = material.validation
    if table.empty:
        return style.words_only("The paper has no numbers for the samples of this study.")
    samples = list(dict.fromkeys(table["sample"]))
    height = 2.7 * len(samples) + 1.0
    figure = Figure(figsize=(9, height), layout="constrained")
    grid = figure.add_gridspec(len(samples), 2)
    for row, sample in enumerate(samples):
        selected = table[table["sample"] == sample]
        first = selected.iloc[0]
        words = f"{sample}: {first['locks']} locks, friction {first['friction']:.4g}"
        _peaks(figure.add_subplot(grid[row, 0]), selected, f"{words}, peak V at e = 0 (N)")
        _weights(figure.add_subplot(grid[row, 1]), selected, f"{words}, weights at e = 0")
    style.caption(
        figure,
        "Published: 3DEC and SiDMACIB, from the paper's text. Computed: this program. “Swapped”: "
        "the published values of the first two locks exchanged. Statics asks for it: but for "
        "friction the lower locks (2, 4, …) are the only way of V to the ground, and only in the "
        f"swapped order do they add up to it. All published "
        f"values: tables/validation.csv. {material.assumed_geometry} {style.ASSUMED_POINTS}",
        height=0.95 / height,
    )
    return figure


def _peaks(axes: Axes, selected: pd.DataFrame, title: str) -> None:
    rows = selected[selected["quantity"] == "dem_pure_shear_N"]
    meshes = list(rows["mesh_m"].unique())
    models = list(rows["model"].unique())
    bars = {PUBLISHED: rows.drop_duplicates("mesh_m")["published"].to_list()}
    found = rows.set_index(["model", "mesh_m"])["computed"]
    bars |= {label_of(m): [found.get((m, mesh), float("nan")) for mesh in meshes] for m in models}
    width = 0.9 / len(bars)
    for index, (look, values) in enumerate(bars.items()):
        places = [place + (index - (len(bars) - 1) / 2) * width for place in range(len(meshes))]
        bar = axes.bar(places, values, 0.95 * width, color=look.colour, label=look.name)
        axes.bar_label(bar, fmt="%.1f", fontsize=5.5)
    if len(rows):
        axes.set_ylim(0, 1.6 * max(rows["published"].max(), rows["computed"].max()))
        axes.legend(fontsize=7, ncols=2)
    axes.set_axisbelow(True)
    axes.set_xticks(range(len(meshes)), [f"mesh {mesh:g} m" for mesh in meshes])
    axes.set_title(title, loc="left", fontsize=9)
    axes.grid(axis="x", visible=False)


def _weights(axes: Axes, selected: pd.DataFrame, title: str) -> None:
    finest = selected[selected["mesh_m"] == selected["mesh_m"].min()]
    finest = finest[finest["model"] == finest["model"].iloc[0]]
    computed = label_of(finest["model"].iloc[0])
    printed = finest[finest["quantity"].str.fullmatch(r"weight_lock\d+")]
    swapped = finest.set_index("quantity")["published"]
    locks = [int(q.removeprefix("weight_lock")) for q in printed["quantity"]]
    groups = {
        "published, as printed": (printed["published"].to_list(), PUBLISHED.colour),
        "published, first two swapped": (
            [swapped.get(f"{q}_swapped", swapped[q]) for q in printed["quantity"]],
            GREY,
        ),
        f"{computed.name}, mesh {finest['mesh_m'].iloc[0]:g} m": (
            printed["computed"].to_list(),
            computed.colour,
        ),
    }
    for shift, (label, (values, colour)) in zip((-0.27, 0.0, 0.27), groups.items(), strict=True):
        bars = axes.bar([lock + shift for lock in locks], values, 0.26, color=colour, label=label)
        axes.bar_label(bars, fmt="%.2f", fontsize=6)
    axes.set_xticks(locks, [f"lock {lock}" for lock in locks])
    axes.set_title(title, loc="left", fontsize=9)
    axes.set_axisbelow(True)
    axes.set_ylim(0, 1.8)
    axes.legend(fontsize=7, loc="upper right")
    axes.grid(axis="x", visible=False)
