"""One page that puts published and computed values side by side."""

from itertools import cycle

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures import style
from analysis.figures.material import Material


def side_by_side(material: Material) -> Figure:
    """Peaks and weights as bars, and the table of all published values."""
    table = material.validation
    if table.empty:
        figure = Figure(figsize=(8, 2), layout="constrained")
        figure.text(
            0.5, 0.5, "The paper has no numbers for the samples of this study.", ha="center"
        )
        return figure
    samples = list(dict.fromkeys(table["sample"]))
    figure = Figure(figsize=(9, 12.5), layout="constrained")
    grid = figure.add_gridspec(len(samples) + 1, 2, height_ratios=[1.0] * len(samples) + [3.6])
    for row, sample in enumerate(samples):
        own = table[table["sample"] == sample]
        locks = own["locks"].iloc[0]
        _peaks(figure.add_subplot(grid[row, 0]), own, f"{locks} locks: peak V at e = 0 (N)")
        _weights(figure.add_subplot(grid[row, 1]), own, f"{locks} locks: weights at e = 0")
    shown = table[table["model"].isin([material.leading, "sidmacib"])]
    _table(figure.add_subplot(grid[len(samples), :]), shown)
    style.caption(
        figure,
        "Published: 3DEC and SiDMACIB, from the paper's text. Computed: this program. “Swapped”: "
        "the published values of the first two locks exchanged. Statics asks for it: but for "
        "friction the lower locks (2, 4, …) are the only way of V to the ground, and only in the "
        f"swapped order do they add up to it. {material.assumed_geometry} {style.ASSUMED_POINTS}",
        height=0.07,
    )
    return figure


def _peaks(axes: Axes, own: pd.DataFrame, title: str) -> None:
    rows = own[own["quantity"] == "dem_pure_shear_N"]
    meshes = list(rows["mesh_m"].unique())
    models = list(rows["model"].unique())
    bars = {"published (3DEC)": rows.drop_duplicates("mesh_m")["published"].to_list()}
    found = rows.set_index(["model", "mesh_m"])["computed"]
    bars |= {m: [found.get((m, mesh), float("nan")) for mesh in meshes] for m in models}
    width = 0.9 / len(bars)
    colours = cycle([style.COLOURS[index] for index in (5, 0, 1, 4, 2, 3)])
    for index, ((label, values), colour) in enumerate(zip(bars.items(), colours, strict=False)):
        places = [place + (index - (len(bars) - 1) / 2) * width for place in range(len(meshes))]
        bar = axes.bar(places, values, 0.95 * width, color=colour, label=label)
        axes.bar_label(bar, fmt="%.1f", fontsize=5.5)
    if len(rows):
        axes.set_ylim(0, 1.6 * max(rows["published"].max(), rows["computed"].max()))
        axes.legend(fontsize=7, ncols=2)
    axes.set_axisbelow(True)
    axes.set_xticks(range(len(meshes)), [f"mesh {mesh:g} m" for mesh in meshes])
    axes.set_title(title, loc="left", fontsize=9)
    axes.grid(axis="x", visible=False)


def _weights(axes: Axes, own: pd.DataFrame, title: str) -> None:
    finest = own[own["mesh_m"] == own["mesh_m"].min()]
    finest = finest[finest["model"] == finest["model"].iloc[0]]
    printed = finest[finest["quantity"].str.fullmatch(r"weight_lock\d+")]
    swapped = finest.set_index("quantity")["published"]
    locks = [int(q.removeprefix("weight_lock")) for q in printed["quantity"]]
    groups = {
        "published, as printed": (printed["published"].to_list(), style.COLOURS[1]),
        "published, first two swapped": (
            [swapped.get(f"{q}_swapped", swapped[q]) for q in printed["quantity"]],
            style.COLOURS[5],
        ),
        f"computed, mesh {finest['mesh_m'].iloc[0]:g} m": (
            printed["computed"].to_list(),
            style.COLOURS[0],
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


def _table(axes: Axes, table: pd.DataFrame) -> None:
    axes.axis("off")
    shown = table[~table["quantity"].str.contains("_friction_N")]
    cells = [
        [
            str(row.quantity),
            str(row.locks),
            "" if pd.isna(row.mesh_m) else f"{row.mesh_m:g}",
            f"{row.published:g}",
            f"{row.computed:.4g}",
            "" if pd.isna(row.absolute_difference) else f"{row.absolute_difference:+.2g}",
            "" if pd.isna(row.relative_difference) else f"{100 * row.relative_difference:+.1f} %",
        ]
        for row in shown.itertuples()
    ]
    head = ["quantity", "locks", "mesh (m)", "published", "computed", "difference", "relative"]
    widths = [0.4, 0.07, 0.1, 0.12, 0.12, 0.11, 0.1]
    drawn = axes.table(cells, colLabels=head, colWidths=widths, loc="upper center", cellLoc="right")
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(6.5)
    for (row, column), cell in drawn.get_celld().items():
        cell.set_linewidth(0.2)
        if row == 0:
            cell.set_text_props(weight="bold")
        if column == 0:
            cell.set_text_props(ha="left")
