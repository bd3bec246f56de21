"""Published and computed peaks and weights side by side."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.drawing.labels import PUBLISHED, label_of
from analysis.figures import style
from analysis.figures.material import FigureData
from sidmacib.drawing import GREY


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
