"""Which geometry fits the published numbers: misfit map, what is determined, curves."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.calibration import length_along
from analysis.figures import style

AXES = {"height_share": "h / (h + H)", "height_over_b": "(h + H) / b", "a_m": "a (m)"}


def calibration(table: pd.DataFrame, curves: pd.DataFrame) -> Figure:
    """The misfit over the two ratios, its least value along each size, and curves for each a."""
    own, grid = table.iloc[-1], table.iloc[:-1]  # the study's own geometry is the last row
    figure = Figure(figsize=(9.5, 8.6), layout="constrained")
    spans = [(0, 0, 3), (0, 3, 4), (0, 4, 5), (0, 5, 6), (1, 0, 3), (1, 3, 6)]
    layout = figure.add_gridspec(2, 6, height_ratios=[1.0, 1.1])
    cells = [figure.add_subplot(layout[row, start:end]) for row, start, end in spans]
    nearest = grid.loc[(grid["a_m"] - own["a_m"]).abs().idxmin(), "a_m"]
    _map(figure, cells[0], grid[grid["a_m"] == nearest], own)
    for axes, column in zip(cells[1:4], AXES, strict=True):
        _profile(axes, grid, own, column)
    for axes, (locks, rows) in zip(cells[4:], curves.groupby("locks"), strict=False):
        _curves(axes, rows, own, int(str(locks)))
    style.caption(
        figure,
        "Static model in pure shear against the published peaks and weights of both samples, the "
        "first two weights swapped. Misfit: root mean square of the differences over 1 % (peaks) "
        "and 0.02 (weights). Cross: the study's geometry. Top right: the least misfit at each "
        "value of one size, whatever the others are. Below: V-M curves of the best geometry of "
        "each a and the study's (thick); squares: where the closest two straight parts meet. With "
        f"the weights as printed no geometry comes below {grid['misfit_printed'].min():.1f}.",
        height=0.13,
    )
    return figure


def _map(figure: Figure, axes: Axes, grid: pd.DataFrame, own: pd.Series) -> None:
    values = grid.pivot(index="height_over_b", columns="height_share", values="misfit_swapped")
    if min(values.shape) > 1:
        least = float(np.floor(10 * values.min(axis=None)) / 10)
        shown = axes.contourf(
            *(values.columns, values.index, values),
            levels=np.linspace(least, least + 1.8, 10),
            cmap="viridis_r",
            extend="both",
        )
        figure.colorbar(shown, ax=axes, label="misfit")
    axes.plot(own["height_share"], own["height_over_b"], "X", color="white", markeredgecolor="k")
    axes.set_xlabel(AXES["height_share"])
    axes.set_ylabel(AXES["height_over_b"])
    axes.set_title(f"misfit, a = {grid['a_m'].iloc[0]:g} m", loc="left", fontsize=10)
    axes.grid(visible=False)


def _profile(axes: Axes, grid: pd.DataFrame, own: pd.Series, column: str) -> None:
    least = grid.groupby(column)["misfit_swapped"].min()
    axes.plot(least.index, least, "o-", color=style.COLOURS[0], markersize=3)
    axes.plot(own[column], own["misfit_swapped"], "X", color=style.COLOURS[6])
    lowest = grid["misfit_swapped"].min()
    axes.set_ylim(max(0.0, lowest - 0.25), lowest + 1.75)
    axes.set_xlabel(AXES[column])
    if column == "height_share":
        axes.set_title("least misfit", loc="left", fontsize=10)
    else:
        axes.set_yticklabels([])


def _curves(axes: Axes, rows: pd.DataFrame, own: pd.Series, locks: int) -> None:
    sizes = ["a_m", "height_share", "height_over_b"]
    lengths = sorted(rows["a_m"].unique())
    for _, curve in rows.groupby(sizes, sort=True):
        first = curve.iloc[0]
        is_own = bool(np.allclose(first[sizes].astype(float), own[sizes].astype(float)))
        scaled = curve[["shear_N", "torque_Nm"]] / curve[["shear_N", "torque_Nm"]].max()
        x, y = scaled.to_numpy().T
        length = length_along(scaled.to_numpy())
        turn = first["turn_from_shear"] * length[-1]
        colour = style.COLOURS[lengths.index(first["a_m"]) % len(style.COLOURS)]
        label = f"a = {first['a_m']:g} m{', the study' if is_own else ''}"
        axes.plot(x, y, color=colour, linewidth=2.4 if is_own else 1.0, label=label)
        corner = np.interp(turn, length, x), np.interp(turn, length, y)
        axes.plot(*corner, "s", color=colour, markersize=5)
    axes.set_xlabel("V / largest V")
    axes.set_ylabel("M / largest M")
    axes.set_title(f"{locks} locks", loc="left", fontsize=10)
    axes.legend(fontsize=7)
