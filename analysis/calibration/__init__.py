"""Find geometry and friction that fit the published numbers: ``make calibrate``.

The static model solves a grid of joints, then engines confirm the best of them. Each step is a
separate study in the results folder, whose configuration is written here. Figures show misfits by
friction and geometry, and curves.
"""

from collections.abc import Mapping
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.calibration.candidates import (
    PEAK_AIM,
    PEAK_SCALE,
    WEIGHT_SCALE,
    best_trials,
    candidate_study,
    candidates,
    check,
    curve_study,
    curve_table,
    describe,
    engine_study,
    friction_table,
    length_along,
    misfit_table,
    read_as_degrees,
    study_candidates,
)
from analysis.figures import drawn_files, style
from analysis.published import Published, read_published
from workflow.command import snakemake
from workflow.configuration import CallError, read_study_file
from workflow.results.tables import CASES, WEIGHTS, read_table
from workflow.schema import Study

MISFIT = (
    "Misfit: root mean square of the differences of the static model in pure shear from the "
    "published peaks of both samples at both meshes, over "
    f"{100 * PEAK_SCALE:g} %, and from their weights, the first two swapped, over {WEIGHT_SCALE:g}."
)
AXES = {"height_share": "h / (h + H)", "height_over_b": "(h + H) / b", "a_m": "a (m)"}


def calibrate(config: Path, results: str | None) -> None:
    """Write map, curves, figures and best joints; `CallError` if a step is incomplete."""
    study = read_study_file(config, results)
    published = read_published()
    locks = check(study, published)
    place = Path(study.results, "calibration")
    of_study = {f"own{n}": each for n, each in enumerate(study_candidates(study, published))}

    every = {f"g{n:05}": each for n, each in enumerate(candidates(study, published))} | of_study
    solved = run_study(place / "map", candidate_study(study, locks, every))
    table = misfit_table(*solved, published)
    write(table, place / "map.csv")
    grid = table[~table["candidate"].isin(of_study)]
    by_friction = friction_table(grid)
    write(by_friction, place / "friction.csv")

    ranked = {f"rank{rank}": each for rank, each in enumerate(best_trials(grid), start=1)}
    solved = run_study(place / "curves", curve_study(study, locks, of_study | ranked))
    curves = curve_table(*solved[:2])
    write(curves, place / "curves.csv")
    own = table[table["candidate"].isin(of_study)]
    for name, figure in (
        ("friction", frictions(by_friction, float(grid["misfit_printed"].min()), published)),
        ("geometry", geometries(grid, own)),
        ("curves", shapes(curves, set(of_study))),
    ):
        files = drawn_files([f"calibration_{name}"])
        style.save(figure, [Path(study.results, file) for file in files])

    chosen = of_study | dict([*ranked.items()][: study.calibration.confirmed])
    solved = run_study(place / "best", engine_study(study, locks, chosen))
    confirmed = misfit_table(*solved, published)
    write(confirmed, Path(study.results, "tables/calibration.csv"))
    print(describe(confirmed, by_friction, published), end="")


def run_study(folder: Path, content: Mapping[str, Any]) -> tuple[Study, pd.DataFrame, pd.DataFrame]:
    """Write a configuration, run its cases, and return the study with its cases and weights.

    The results are in ``folder``, the configuration beside it.
    """
    path = folder.with_suffix(".yaml")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump({"results": str(folder), **content}, sort_keys=False))
    study = read_study_file(path)
    tables = [Path(study.results, f"tables/{name}.csv") for name in ("cases", "weights")]
    if not snakemake(path, study.results, [str(table) for table in tables]):
        raise CallError(f"{path.stem}: this step of the calibration is incomplete, see above")
    return study, read_table(CASES, tables[0]), read_table(WEIGHTS, tables[1])


def write(rows: pd.DataFrame, path: Path) -> None:
    """Write a table of the calibration."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows.to_csv(path, index=False, float_format="%.10g")


def frictions(rows: pd.DataFrame, as_printed: float, published: Published) -> Figure:
    """The least misfit, and the closest peaks, of any geometry over the friction.

    ``rows``: see `friction_table`; ``as_printed``: the least misfit with the weights as printed.
    """
    figure = Figure(figsize=(8.6, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    printed, degrees = published.numbers["sample"]["friction"], read_as_degrees(published)
    for axes, column, factor, title in (
        (left, "misfit_swapped", 1.0, "least misfit of any geometry"),
        (right, "least_peak_difference", 100.0, "closest peaks of any geometry (%)"),
    ):
        values = factor * rows[column]
        axes.plot(rows["friction"], values, "o-", color=style.COLOURS[0], markersize=4)
        for friction, words, colour in (
            (printed, f"{printed:g}, as printed", style.COLOURS[5]),
            (degrees, f"tan {printed:g}° (hypothesis)", style.COLOURS[2]),
        ):
            axes.axvline(friction, color=colour, linewidth=1.2, linestyle="--", label=words)
        axes.set_xscale("symlog", linthresh=0.01, linscale=0.6)
        axes.set_xlim(-0.0005, 1.15 * rows["friction"].max())
        axes.set_xticks([0, 0.005, 0.01, 0.03, 0.1, 0.3], ["0", ".005", ".01", ".03", ".1", ".3"])
        axes.set_ylim(0.0, 1.08 * values.max())
        axes.set_xlabel("friction coefficient of the dry faces")
        axes.set_title(title, loc="left", fontsize=10)
    right.axhline(100 * PEAK_AIM, color="#999999", linewidth=0.8)
    left.legend(fontsize=9, loc="upper center")
    style.caption(
        figure,
        f"For each friction coefficient of the dry faces, the best of all geometries. {MISFIT} "
        "Right: the largest difference of a published peak, whatever the weights; grey: "
        f"{100 * PEAK_AIM:g} %. That 3DEC, whose friction is an angle, was given 0.3 degrees is a "
        "hypothesis, not known. With the weights as printed nothing comes below "
        f"{as_printed:.1f}.",
        height=0.24,
    )
    return figure


def geometries(grid: pd.DataFrame, of_study: pd.DataFrame) -> Figure:
    """The misfit over both ratios, and its least value over each size."""
    shown = grid
    for size in ("a_m", "friction"):  # those of the grid that are nearest to the study's last joint
        nearest = (shown[size] - of_study[size].iloc[-1]).abs().min()
        shown = shown[np.isclose((shown[size] - of_study[size].iloc[-1]).abs(), nearest)]
    figure = Figure(figsize=(8.6, 7.4), layout="constrained")
    layout = figure.add_gridspec(2, 3, height_ratios=[1.6, 1.0])
    _map(figure, figure.add_subplot(layout[0, :]), shown, of_study)
    for number, column in enumerate(AXES):
        _profile(figure.add_subplot(layout[1, number]), grid, of_study, column)
    style.caption(
        figure,
        f"{MISFIT} Above: at friction {shown['friction'].iloc[0]:.4g}. Below: the least misfit at "
        "each value of one size, whatever friction and the other sizes are. Crosses: the study's "
        "joints, as printed and fitted.",
        height=0.13,
    )
    return figure


def shapes(curves: pd.DataFrame, of_study: set[str]) -> Figure:
    """V-M curves of the best joint of each a and of the study's, scaled to their largest values."""
    figure = Figure(figsize=(8.6, 5.4), layout="constrained")
    panels = figure.subplots(1, curves["locks"].nunique(), squeeze=False, sharey=True)[0]
    for axes, (locks, rows) in zip(panels, curves.groupby("locks"), strict=True):
        for (name, curve), colour in zip(
            rows.groupby("candidate", sort=False), cycle(style.COLOURS), strict=False
        ):
            first, in_study = curve.iloc[0], str(name) in of_study
            scaled = curve[["shear_N", "torque_Nm"]] / curve[["shear_N", "torque_Nm"]].max()
            x, y = scaled.to_numpy().T
            length = length_along(scaled.to_numpy())
            turn = first["turn_from_shear"] * length[-1]
            label = f"a = {first['a_m']:g} m, friction {first['friction']:.3g}"
            label += ", the study's" if in_study else ""
            axes.plot(x, y, color=colour, linewidth=2.4 if in_study else 1.0, label=label)
            corner = np.interp(turn, length, x), np.interp(turn, length, y)
            axes.plot(*corner, "s", color=colour, markersize=5)
        axes.set_xlabel("V / largest V")
        axes.set_title(f"{locks} locks", loc="left", fontsize=10)
    panels[0].set_ylabel("M / largest M")
    figure.legend(
        *panels[0].get_legend_handles_labels(), fontsize=9, ncols=2, loc="outside upper center"
    )
    style.caption(
        figure,
        "V-M curves of the static model: the best joint of each a, and the study's (thick). "
        "Squares: where the closest two straight parts meet; the paper describes two straight "
        "parts that meet at about two thirds of the curve.",
        height=0.13,
    )
    return figure


def _map(figure: Figure, axes: Axes, shown: pd.DataFrame, of_study: pd.DataFrame) -> None:
    values = shown.pivot(index="height_over_b", columns="height_share", values="misfit_swapped")
    if min(values.shape) > 1:
        least = float(np.floor(10 * values.min(axis=None)) / 10)
        filled = axes.contourf(
            *(values.columns, values.index, values),
            levels=np.linspace(least, least + 3.0, 11),
            cmap="viridis_r",
            extend="both",
        )
        figure.colorbar(filled, ax=axes, label="misfit")
    places = of_study["height_share"], of_study["height_over_b"]
    axes.plot(*places, "X", color="white", markeredgecolor="k", clip_on=False)
    axes.set_xlabel(AXES["height_share"])
    axes.set_ylabel(AXES["height_over_b"])
    first = shown.iloc[0]
    title = f"misfit, a = {first['a_m']:g} m, friction {first['friction']:.4g}"
    axes.set_title(title, loc="left", fontsize=10)
    axes.grid(visible=False)


def _profile(axes: Axes, grid: pd.DataFrame, of_study: pd.DataFrame, column: str) -> None:
    least = grid.groupby(column)["misfit_swapped"].min()
    axes.plot(least.index, least, "o-", color=style.COLOURS[0], markersize=3)
    axes.plot(of_study[column], of_study["misfit_swapped"], "X", color=style.COLOURS[6])
    axes.set_ylim(0.0, 1.1 * max(least.max(), of_study["misfit_swapped"].max()))
    axes.set_xlabel(AXES[column])
    if column == "height_share":
        axes.set_title("least misfit", loc="left", fontsize=10)
    else:
        axes.set_yticklabels([])
