"""Capacity in pure shear against the stiffness of the block, from soft to rigid."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures import style
from analysis.figures.catalogue import shown_samples
from analysis.figures.material import Material
from sidmacib.joint import Joint, UpperBody
from workflow.case import case_name

LOOKS = {  # of the bodies that are drawn: words and line
    UpperBody.COLUMNS: ("columns", "o-"),
    UpperBody.MONOLITHIC: ("one piece", "s--"),
}


def capacities_by_stiffness(material: Material, model: str) -> pd.DataFrame:
    """Loads in the first direction, at the finest mesh, of all samples and variants of ``model``.

    Columns: sample, locks, body, ratio (E over Kn b, inf: rigid), load_N, T0_N.
    """
    study = material.study
    mesh, direction = min(study.meshes), min(study.eccentricities)
    rows = material.capacity[material.capacity["model"] == model]
    loads = rows.set_index(["variant", "case"])["load_N"]

    def found() -> Iterator[dict[str, object]]:
        for sample in shown_samples(study):
            for name, change in study.every_variant.items():
                joint = study.joint(sample, change.assembly(study.assembly), change.young)
                key = name, case_name(sample, mesh, direction)
                if key in loads.index and pd.notna(loads[key]):
                    yield {
                        "sample": sample,
                        "locks": joint.locks,
                        "body": joint.upper_body,
                        "ratio": stiffness_ratio(joint),
                        "load_N": float(loads[key]),
                        "T0_N": joint.T0,
                    }

    return pd.DataFrame(found())


def stiffness_ratio(joint: Joint) -> float:
    """Young's modulus over the stiffness of inner faces times the width of a lock; inf if rigid."""
    if joint.elastic is None:
        return float("inf")
    return joint.elastic.young / (joint.inner.normal_stiffness * joint.b)


def stiffness(material: Material) -> Figure:
    """Load against stiffness, sample by sample, and against the number of locks."""
    model = material.detailed[0]
    table = capacities_by_stiffness(material, model)
    figure = Figure(figsize=(9.6, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    _by_stiffness(left, table)
    _by_locks(right, table)
    style.caption(
        figure,
        f"Pure shear, {model}, mesh {min(material.study.meshes):g} m. E: Young's modulus of the "
        "block, Kn b: stiffness of an inner face times the width of a lock. Dotted: rigid. "
        "(n - 1) / 2: the paper's rule for how many locks count.",
        height=0.09,
    )
    return figure


def _by_stiffness(axes: Axes, table: pd.DataFrame) -> None:
    samples = dict.fromkeys(table["sample"])
    for sample, colour in zip(samples, style.COLOURS * 3, strict=False):
        for body, (words, line) in LOOKS.items():
            own = table[(table["sample"] == sample) & (table["body"] == body)]
            bends = own[np.isfinite(own["ratio"])].sort_values("ratio")
            label = f"{sample}, {words}"
            axes.plot(bends["ratio"], bends["load_N"], line, color=colour, ms=3.5, label=label)
            for load in own.loc[np.isinf(own["ratio"]), "load_N"]:
                axes.axhline(load, color=colour, lw=0.7, ls=":")
    axes.set_xscale("log")
    axes.set_xlabel("E / (Kn b)")
    axes.set_ylabel("largest V (N)")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=6, ncols=2)


def _by_locks(axes: Axes, table: pd.DataFrame) -> None:
    groups = table[table["body"].isin(LOOKS)].groupby(["ratio", "body"], sort=True)
    ratios = dict(zip(sorted(set(table["ratio"])), style.COLOURS * 3, strict=False))
    for (ratio, body), rows in groups:
        own = rows.sort_values("locks")
        words, line = LOOKS[UpperBody(body)]
        told = "rigid" if np.isinf(ratio) else f"E / (Kn b) = {ratio:g}"
        label = f"{told}, {words}"
        counted = own["load_N"] / own["T0_N"]
        axes.plot(own["locks"], counted, line, color=ratios[ratio], ms=3.5, label=label)
    locks = np.array(sorted(set(table["locks"])))
    axes.plot(locks, (locks - 1) / 2, color="0.3", lw=1.2, label="(n - 1) / 2")
    axes.set_xlabel("locks n")
    axes.set_ylabel("largest V / T0")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=6)
