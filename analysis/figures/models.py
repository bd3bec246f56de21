"""The models of the joint's pieces beside each other."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures import style
from analysis.figures.curves import model_curve, published_point
from analysis.figures.material import Material
from workflow.cases import REFERENCE


def models(material: Material) -> Figure:
    """Curves and weights of all models of a sample, at the finest mesh."""
    mesh = min(material.study.meshes)
    figure = Figure(figsize=(8.6, 4.6), layout="constrained")
    curves, bars = figure.subplots(1, 2, width_ratios=[1.0, 1.1])
    for model, colour in zip(material.models, style.COLOURS, strict=False):
        model_curve(curves, material, model, material.sample, mesh, colour)
    published_point(curves, material.capacity, material.sample)
    style.curve_axes(curves, "largest loads")
    curves.legend(fontsize=8)
    _weights(bars, material, mesh)
    style.caption(
        figure,
        f"The same pieces and nodes, {material.study.samples[material.sample].locks} locks, mesh "
        f"{mesh:g} m. Distinct elements and the static model follow brittle failure and Coulomb "
        "friction; limit analysis redistributes freely and has no friction here: its weights are "
        f"one state of many. Weight: shear on a lock over T0. {material.assumed_geometry}",
    )
    return figure


def _weights(axes: Axes, material: Material, mesh: float) -> None:
    rows = material.weights[
        (material.weights["sample"] == material.sample)
        & (material.weights["variant"] == REFERENCE)
        & (material.weights["mesh_m"] == mesh)
    ]
    rows = rows[rows["eccentricity_m"] == rows["eccentricity_m"].min()]
    width = 0.8 / len(material.models)
    for index, (model, colour) in enumerate(zip(material.models, style.COLOURS, strict=False)):
        own: pd.DataFrame = rows[rows["model"] == model].sort_values("lock")
        shift = (index - (len(material.models) - 1) / 2) * width
        bar = axes.bar(own["lock"] + shift, own["weight"], width, color=colour, label=model)
        axes.bar_label(bar, fmt="%.2f", fontsize=6, rotation=90, padding=2)
    axes.set_xticks(rows["lock"].unique())
    axes.set_xlabel("lock")
    axes.set_ylim(0, 1.3)
    axes.set_axisbelow(True)
    axes.grid(axis="x", visible=False)
    ratio = min(material.study.eccentricities)
    axes.set_title(f"weights at e = {ratio:g} a", loc="left", fontsize=10)
    axes.legend(fontsize=8, ncols=3)
