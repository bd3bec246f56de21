"""Find geometry and friction that fit the published numbers: ``make calibrate``.

The static model solves a grid of joints, then engines confirm the best of them. Each step is a
separate study in the results folder, whose configuration is written here. A figure shows misfits by
geometry; those by friction, and curves, are tables.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.calibration.candidates import (
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
    misfit_table,
    study_candidates,
)
from analysis.figures import drawn_files, style
from analysis.published import read_published
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
    """Write map, curves, a figure and best joints; `CallError` if a step is incomplete."""
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
    write(curve_table(*solved[:2]), place / "curves.csv")
    own = table[table["candidate"].isin(of_study)]
    files = [Path(study.results, file) for file in drawn_files(["calibration_geometry"])]
    style.save(geometries(grid, own), files)

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


def geometries(grid: pd.DataFrame, of_study: pd.DataFrame) -> Figure:
    """The misfit over both ratios, and its least value over each size."""
    shown = grid
    for size in ("a_m", "friction"):  # those of the grid that are nearest to the study's last joint
        apart = (shown[size] - of_study[size].iloc[-1]).abs()
        shown = shown[np.isclose(apart, apart.min())]
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
