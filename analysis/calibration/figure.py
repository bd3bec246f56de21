"""Figure of the calibration: misfits by friction and geometry, and curves."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.calibration.candidates import (
    PEAK_AIM,
    PEAK_SCALE,
    WEIGHT_SCALE,
    friction_table,
    read_as_degrees,
)
from analysis.calibration.curve_shape import length_along
from analysis.figures import style
from analysis.published import Published

AXES = {"height_share": "h / (h + H)", "height_over_b": "(h + H) / b", "a_m": "a (m)"}


def calibration(
    grid: pd.DataFrame, of_study: pd.DataFrame, curves: pd.DataFrame, published: Published
) -> Figure:
    """The misfit over friction, the two ratios and each size, and curves for each a.

    ``grid``, ``of_study``: rows of `misfit_table`, of the grid and of the study's joints.
    """
    figure = Figure(figsize=(9.5, 12.0), layout="constrained")
    spans = [(0, 0, 3), (0, 3, 6), (1, 0, 3), (1, 3, 4), (1, 4, 5), (1, 5, 6), (2, 0, 3), (2, 3, 6)]
    layout = figure.add_gridspec(3, 6, height_ratios=[1.0, 1.0, 1.1])
    cells = [figure.add_subplot(layout[row, start:end]) for row, start, end in spans]
    frictions = friction_table(grid)
    _friction(cells[0], frictions, "misfit_swapped", 1.0, published)
    cells[0].set_title("least misfit of any geometry", loc="left", fontsize=10)
    _friction(cells[1], frictions, "least_peak_difference", 100.0, published)
    cells[1].axhline(100 * PEAK_AIM, color="#999999", linewidth=0.8)
    cells[1].set_title("closest of all published peaks, any weights (%)", loc="left", fontsize=10)
    shown = grid
    for size in ("a_m", "friction"):  # those of the grid that are nearest to the study's last joint
        nearest = (shown[size] - of_study[size].iloc[-1]).abs().min()
        shown = shown[np.isclose((shown[size] - of_study[size].iloc[-1]).abs(), nearest)]
    _map(figure, cells[2], shown, of_study)
    for axes, column in zip(cells[3:6], AXES, strict=True):
        _profile(axes, grid, of_study, column)
    for axes, (locks, rows) in zip(cells[6:], curves.groupby("locks"), strict=False):
        _curves(axes, rows, int(str(locks)), set(of_study["candidate"]))
    style.caption(
        figure,
        "Static model in pure shear against the published peaks of both samples at both meshes and "
        "their weights, the first two weights swapped. Misfit: root mean square of the differences "
        f"over {100 * PEAK_SCALE:g} % (peaks) and {WEIGHT_SCALE:g} (weights). Above: for each "
        "friction coefficient of the dry faces, the best of all geometries. That 3DEC, whose "
        "friction is an angle, was given 0.3 degrees is a hypothesis, not known. Middle: the map "
        f"at friction {shown['friction'].iloc[0]:.4g}, and the least misfit at each value of one "
        "size, whatever the others are. Crosses: the study's joints. Below: V-M curves of the "
        "best joint of each a and the study's (thick); squares: where the closest two straight "
        "parts meet. "
        f"With the weights as printed nothing comes below {grid['misfit_printed'].min():.1f}.",
        height=0.115,
    )
    return figure


def _friction(
    axes: Axes, rows: pd.DataFrame, column: str, factor: float, published: Published
) -> None:
    """A value over the friction coefficient, with the printed one and the hypothetical marked."""
    axes.plot(rows["friction"], factor * rows[column], "o-", color=style.COLOURS[0], markersize=4)
    printed, degrees = published.numbers["sample"]["friction"], read_as_degrees(published)
    for friction, words, colour in (
        (printed, f"{printed:g}, as printed", style.COLOURS[5]),
        (degrees, f"tan {printed:g}° (hypothesis)", style.COLOURS[2]),
    ):
        axes.axvline(friction, color=colour, linewidth=1.2, linestyle="--", label=words)
    axes.set_xscale("symlog", linthresh=0.01, linscale=0.6)
    axes.set_xlim(-0.0005, 1.15 * rows["friction"].max())
    axes.set_xticks([0, 0.005, 0.01, 0.03, 0.1, 0.3], ["0", ".005", ".01", ".03", ".1", ".3"])
    axes.set_ylim(0.0, 1.08 * factor * rows[column].max())
    axes.set_xlabel("friction coefficient of the dry faces")
    axes.legend(fontsize=8, loc="upper center")


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


def _curves(axes: Axes, rows: pd.DataFrame, locks: int, of_study: set[str]) -> None:
    for number, (name, curve) in enumerate(rows.groupby("candidate", sort=False)):
        first, in_study = curve.iloc[0], str(name) in of_study
        scaled = curve[["shear_N", "torque_Nm"]] / curve[["shear_N", "torque_Nm"]].max()
        x, y = scaled.to_numpy().T
        length = length_along(scaled.to_numpy())
        turn = first["turn_from_shear"] * length[-1]
        colour = style.COLOURS[number % len(style.COLOURS)]
        label = f"a = {first['a_m']:g} m, friction {first['friction']:.3g}"
        marked = ", the study" if in_study else ""
        axes.plot(x, y, color=colour, linewidth=2.4 if in_study else 1.0, label=f"{label}{marked}")
        corner = np.interp(turn, length, x), np.interp(turn, length, y)
        axes.plot(*corner, "s", color=colour, markersize=5)
    axes.set_xlabel("V / largest V")
    axes.set_ylabel("M / largest M")
    axes.set_title(f"{locks} locks", loc="left", fontsize=10)
    axes.legend(fontsize=7)
