"""One page that puts published and computed values side by side."""

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.drawing.labels import PUBLISHED, label_of
from analysis.figures import style
from analysis.figures.material import Material
from analysis.tables.validation import Comparison, comparisons, difference_text, quantity_label
from sidmacib.drawing import GREY


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
    leading = {sample: material.detailed_of(sample)[0] for sample in samples}
    parts = list(comparisons(table, leading))
    lines = sum(len(part.lines) + 3 for part in parts)
    height = 2.6 * len(samples) + 0.15 * lines + 1.25
    figure = Figure(figsize=(9, height), layout="constrained")
    grid = figure.add_gridspec(
        len(samples) + 1, 2, height_ratios=[2.4] * len(samples) + [0.15 * lines]
    )
    for row, sample in enumerate(samples):
        selected = table[table["sample"] == sample]
        first = selected.iloc[0]
        words = f"{sample}: {first['locks']} locks, friction {first['friction']:.4g}"
        _peaks(figure.add_subplot(grid[row, 0]), selected, f"{words}, peak V at e = 0 (N)")
        _weights(figure.add_subplot(grid[row, 1]), selected, f"{words}, weights at e = 0")
    _table(figure.add_subplot(grid[len(samples), :]), parts)
    style.caption(
        figure,
        "Published: 3DEC and SiDMACIB, from the paper's text. Computed: this program. “Swapped”: "
        "the published values of the first two locks exchanged. Statics asks for it: but for "
        "friction the lower locks (2, 4, …) are the only way of V to the ground, and only in the "
        f"swapped order do they add up to it. {material.assumed_geometry} {style.ASSUMED_POINTS}",
        height=1.15 / height,
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


def _table(axes: Axes, parts: Sequence[Comparison]) -> None:
    """The published numbers, and beside them those of every sample with as many locks."""
    axes.axis("off")
    most = max(len(part.samples) for part in parts)
    cells: list[list[str]] = []
    bold: list[int] = []
    for part in parts:
        bold.append(len(cells))
        heads = [cell for sample in part.samples for cell in (sample, "difference")]
        cells.append([f"{part.locks} locks", "mesh (m)", "published", *heads])
        for line in part.lines:
            values = [
                cell
                for sample in part.samples
                for cell in (
                    (f"{line.rows[sample].computed:.5g}", difference_text(line.rows[sample]))
                    if sample in line.rows
                    else ("", "")
                )
            ]
            cells.append([quantity_label(line.quantity), line.mesh, f"{line.published:g}", *values])
        cells.append([])
    width = 3 + 2 * most
    cells = [[*row, *[""] * (width - len(row))] for row in cells[:-1]]
    widths = [0.36, 0.07, 0.1, *[0.46 / (2 * most)] * (2 * most)]
    drawn = axes.table(cells, colWidths=widths, loc="upper center", cellLoc="right")
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(6.5)
    for (row, column), cell in drawn.get_celld().items():
        cell.set_linewidth(0.2)
        if row in bold:
            cell.set_text_props(weight="bold")
        if column == 0:
            cell.set_text_props(ha="left")
