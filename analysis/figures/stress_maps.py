"""Maps of the shear stress on the inner faces of all locks, with the locks' weights."""

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from analysis.drawing.boxes import MM
from analysis.drawing.labels import label_of
from analysis.figures import style
from analysis.figures.material import FigureData, Stresses
from sidmacib.joint.loading import Push
from sidmacib.joint.pieces import assemble, lock_faces
from sidmacib.mechanics.assembly import Rectangle

TEXT = 8.0  # points, of all that is written in a map


def stress_map(material: FigureData) -> Figure:
    """The inner faces of all locks in the case whose stresses the figure shows."""
    shown = material.stresses
    if shown is None:
        return _without_result(material)
    case, subject, found = shown.case, shown.case.subject, shown.record.part
    joint, mesh = subject.joint, MM * subject.mesh
    eccentricity = subject.direction.eccentricity
    words = {0.0: "in pure shear", math.inf: "in pure torsion"}.get(
        eccentricity, f"under torsion and shear, e = {eccentricity:g} a,"
    )
    width = 2.6 + 1.8 * joint.total_width / joint.a
    figure = Figure(figsize=(min(max(width, 6.0), 14.0), 4.4), layout="constrained")
    axes = figure.subplots()
    cells = _draw_faces(axes, shown)
    bar = figure.colorbar(cells, ax=axes, label="shear stress (kPa)", shrink=0.8)
    bar.ax.tick_params(labelsize=TEXT)
    for row in found.weights:
        y = MM * joint.lock_centre_y(row.lock)
        label = (
            f"lock {row.lock} ({row.block})\nW = {row.weight:.2f}\nmean {row.mean_shear_ratio:.2f}"
        )
        axes.text(y, 0.53 * MM * joint.a, label, ha="center", va="bottom", fontsize=TEXT)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    axes.set_xlabel(
        "y (mm), push from the left"
        if subject.loading.push is Push.PLUS_Y
        else "y (mm), push from the right"
    )
    axes.set_ylabel("x (mm)")
    axes.set_ylim(-0.55 * MM * joint.a, 1.0 * MM * joint.a)
    axes.set_yticks(np.array([-0.5, 0.0, 0.5]) * MM * joint.a)
    axes.tick_params(axis="y", pad=12)  # beyond the arrows at the edge
    style.caption(
        figure,
        f"{material.place_in_paper}Shear stress on the inner faces {words} at the peak, V = "
        f"{found.shear_N:.1f} N, M = {found.torque_Nm:.2f} N m; {label_of(case.model).name}, "
        f"mesh {mesh:g} mm. Seen from below. Faces of upper locks lie at z = h, of lower "
        "locks at z = 0; arrows: direction of the stress on the piece above; grey: broken. W: "
        f"resultant over T0; mean: mean magnitude over the cohesion. {material.assumed_geometry}",
        height=0.27,
    )
    return figure


def _without_result(material: FigureData) -> Figure:
    case = material.spec.case
    name = f"{case.name} ({case.model})" if case else material.spec.name
    return style.words_only(f"{name} has no result; see the summary.")


def _draw_faces(axes: Axes, shown: Stresses) -> PolyCollection:
    joint = shown.case.subject.joint
    strongest = max(joint.inner_of(lock).cohesion for lock in joint.numbers)
    numbers = lock_faces(joint)
    faces = {
        f.name: f for f in assemble(joint, shown.case.subject.mesh).rectangles if f.name in numbers
    }
    inner = shown.nodes[shown.nodes["face"].isin(numbers)]
    magnitude = np.hypot(inner["shear_x_Pa"], inner["shear_y_Pa"])
    cells = PolyCollection(
        [
            corners
            for name, nodes in inner.groupby("face", sort=False)
            for corners in _cells(nodes, faces[str(name)], nodes)
        ],
        array=magnitude.to_numpy() / 1e3,
        cmap="viridis",
        clim=(0.0, strongest / 1e3),
    )
    axes.add_collection(cells)
    broken = inner[inner["bonded"] == 0]
    axes.add_collection(
        PolyCollection(
            [
                corners
                for name, nodes in broken.groupby("face", sort=False)
                for corners in _cells(inner[inner["face"] == name], faces[str(name)], nodes)
            ],
            facecolor="#bbbbbb",
        )
    )
    for face in faces.values():
        axes.axvline(MM * face.low[1], color="white", linewidth=2)
    thinned = inner.groupby("face", sort=False)[inner.columns].apply(_thinned)
    arrows = axes.quiver(
        MM * thinned["y_m"],
        MM * thinned["x_m"],
        thinned["shear_y_Pa"],
        thinned["shear_x_Pa"],
        color="white",
        scale=strongest * 5 * joint.locks,
        width=0.0035,
        pivot="mid",
        clip_on=False,
        path_effects=[withStroke(linewidth=1.0, foreground="black")],  # to be seen on yellow
    )
    arrows.set_in_layout(False)
    axes.set_xlim(0, MM * joint.total_width)
    return cells


def _thinned(nodes: pd.DataFrame, most: int = 5) -> pd.DataFrame:
    """At most ``most`` by ``most`` of a face's nodes, evenly spread."""
    chosen = np.ones(len(nodes), dtype=bool)
    for axis in ("x_m", "y_m"):
        _, rank = np.unique(nodes[axis].round(12), return_inverse=True)
        count = int(rank.max()) + 1
        step = -(-count // most)
        chosen &= (rank - (count - 1) % step // 2) % step == 0
    return nodes[chosen]


def _cells(
    nodes: pd.DataFrame, face: Rectangle, shown: pd.DataFrame
) -> list[list[tuple[float, float]]]:
    """Corners (y, x), in mm, of cells around the nodes ``shown`` of a face's regular ``nodes``.

    Cells meet half-way between nodes, and end with the face.
    """
    spans = []
    for axis, name in ((1, "y_m"), (0, "x_m")):
        places = np.unique(nodes[name].round(12))
        edges = np.concatenate(
            [[face.low[axis]], (places[1:] + places[:-1]) / 2, [face.high[axis]]]
        )
        number = np.searchsorted(places, shown[name].round(12) - 1e-12)
        spans.append(np.column_stack([edges[number], edges[number + 1]]))
    return [
        [(MM * y[i], MM * x[j]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for y, x in zip(*spans, strict=True)
    ]
