"""The joint from the side and from below, and maps of the shear stress on its inner faces."""

import math

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

from analysis.drawing import MM, boxes, label_of
from analysis.figures import style
from analysis.figures.style import FigureData
from sidmacib.drawing import BLACK, BLUE, GREY, VERMILION
from sidmacib.joint import Joint
from sidmacib.joint.loading import Push
from sidmacib.joint.pieces import assemble, lock_faces
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import four_digits
from workflow.case import JointSubject

X, Y, Z = range(3)
TEXT = 8.0  # points, of all that is written in a map
MOST_ARROWS = 5  # along each side of a face
MIDDLE = {"ha": "center", "va": "center"}
PLATE = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8}  # behind words


def joint(material: FigureData) -> Figure:
    """A sample's joint from the side and from below, as stress maps show it."""
    drawn, push = material.study.joint(material.sample), material.study.assembly.push
    figure = Figure(figsize=(8.6, 4.8), layout="constrained")
    side, below = figure.subplots(2, 1)
    _draw(side, drawn, (Y, Z))
    _draw(below, drawn, (Y, X))
    width, bottom, top = MM * drawn.total_width, -MM * drawn.H, MM * (drawn.h + drawn.H)
    sign, start = (1.0, 0.0) if push is Push.PLUS_Y else (-1.0, width)
    beside = sign * 0.3 * MM * drawn.a
    for axes, height, words in ((side, top / 2.0, "V"), (below, beside, "V")):
        arrow, tail = {"arrowstyle": "-|>", "color": BLACK, "lw": 1.5}, start - sign * 0.22 * width
        axes.annotate(
            words, (start, height), (tail, height), arrowprops=arrow, **MIDDLE, fontsize=9
        )
        axes.set_xlim(-0.4 * width, 1.4 * width)
        axes.set_aspect("equal")
        axes.set_axis_off()
    below.plot((-0.16 * width, 1.02 * width), (0.0, 0.0), color=BLACK, lw=0.6, ls="-.", zorder=1.5)
    below.text(1.03 * width, 0.0, "middle", va="center", fontsize=8)
    _torque(below, (width / 2.0, 0.0), 0.36 * MM * drawn.a)
    # Beside the views: above them, lines of names would cross the words.
    side.text(-0.4 * width, bottom / 2.0, "from\nthe side", va="center", fontsize=9)
    below.text(-0.4 * width, -0.3 * MM * drawn.a, "locks\nfrom below", va="center", fontsize=9)
    right, centre = 1.16 * width, MM * drawn.b
    _size(side, (right, MM * drawn.h, top), f"H = {MM * drawn.H:g}")
    _size(side, (right, 0.0, MM * drawn.h), f"h = {MM * drawn.h:g}")
    _size(below, (right, -MM * drawn.a / 2.0, MM * drawn.a / 2.0), f"a = {MM * drawn.a:g}")
    _size(below, (start - sign * 0.07 * width, min(0.0, beside), max(0.0, beside)), "e")
    first = 0.5 * centre
    _name(side, "inner face of lock 1: bonded", (first, MM * drawn.h), (first, 1.5 * top))
    _name(side, "inner face of lock 2: bonded", (1.5 * centre, 0.0), (1.5 * centre, 1.6 * bottom))
    _name(side, "dry face", (2.0 * centre, MM * drawn.h / 2.0), (2.6 * centre, 1.5 * top))
    style.caption(
        figure,
        f"{drawn.locks} numbered locks, b = {MM * drawn.b:g} mm each; sizes in mm. Blue: upper "
        "block, loaded by V at the eccentricity e, so by the torque M = V e. Grey: lower block, "
        "held. Each lock is bonded to its own block by its inner face; all its other faces are "
        f"dry. Strength of a lock: T0 = cohesion times a b = {four_digits(drawn.T0)} N. "
        f"{material.assumed_geometry}",
        height=0.2,
    )
    return figure


def _torque(axes: Axes, middle: tuple[float, float], radius: float) -> None:
    """M as an arrow that turns about the ``middle``."""
    ends = [(middle[0] + radius * sign, middle[1] - 0.6 * radius) for sign in (-1.0, 1.0)]
    look = {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=-0.5", "color": VERMILION, "lw": 1.5}
    axes.annotate("", ends[0], ends[1], arrowprops={**look, "shrinkA": 0, "shrinkB": 0})
    place = ends[1][0] + 0.15 * radius, ends[1][1]
    axes.text(*place, "M = V e", color=VERMILION, fontsize=9, va="center", bbox=PLATE)


def _name(axes: Axes, words: str, face: tuple[float, float], place: tuple[float, float]) -> None:
    """A name at ``place`` with a line to the ``face`` that it is of."""
    line = {"arrowstyle": "-", "lw": 0.8, "shrinkB": 0}
    axes.annotate(words, face, place, arrowprops=line, **MIDDLE, fontsize=8)


def _draw(axes: Axes, joint: Joint, plane: tuple[int, int]) -> None:
    """The pieces, projected on two axes; from below only the locks."""
    across, along = plane
    for piece in boxes(joint):
        if along == X and piece.lock is None:
            continue
        corner = piece.low[across], piece.low[along]
        size = piece.high[across] - corner[0], piece.high[along] - corner[1]
        look = {"facecolor": BLUE if piece.upper else GREY, "edgecolor": BLACK, "lw": 0.6}
        axes.add_patch(Rectangle(corner, *size, **look, alpha=0.3 if piece.lock is None else 0.8))
        if piece.lock is not None:
            middle = corner[0] + size[0] / 2, corner[1] + size[1] / 2
            axes.text(*middle, f"{piece.lock}", **MIDDLE, fontsize=8, bbox=PLATE)
    axes.autoscale_view()


def _size(axes: Axes, place: tuple[float, float, float], words: str) -> None:
    """An arrow with a size beside it, upright."""
    x, low, high = place
    look = {"arrowstyle": "|-|,widthA=0.2,widthB=0.2", "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (x, low), (x, high), arrowprops=look)
    axes.text(x, (low + high) / 2, f"  {words}", va="center", fontsize=8)


def stress_map(material: FigureData) -> Figure:
    """The inner faces of all locks in the case whose stresses the figure shows."""
    case = material.spec.case
    assert case is not None, f"{material.spec.name} shows no case"
    if material.stresses is None:
        return style.words_only(f"{case.name} ({case.model}) has no result; see the summary.")
    (record, nodes), subject = material.stresses, case.subject
    found, joint, mesh = record.part, subject.joint, MM * subject.mesh
    eccentricity = subject.direction.eccentricity
    words = {0.0: "in pure shear", math.inf: "in pure torsion"}.get(
        eccentricity, f"under torsion and shear, e = {eccentricity:g} a,"
    )
    width = 2.6 + 1.8 * joint.total_width / joint.a
    figure = Figure(figsize=(min(max(width, 6.0), 14.0), 4.4), layout="constrained")
    axes = figure.subplots()
    cells = _draw_faces(axes, subject, nodes)
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
    side = "left" if subject.loading.push is Push.PLUS_Y else "right"
    axes.set_xlabel(f"y (mm), push from the {side}")
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


def _draw_faces(axes: Axes, subject: JointSubject, nodes: pd.DataFrame) -> QuadMesh:
    joint = subject.joint
    strongest = max(joint.inner_of(lock).cohesion for lock in joint.numbers)
    inner = nodes[nodes["face"].isin(lock_faces(joint))].round({"x_m": 12, "y_m": 12})
    magnitude = np.hypot(inner["shear_x_Pa"], inner["shear_y_Pa"]) / 1e3
    inner = inner.assign(shear_kPa=magnitude.where(inner["bonded"] != 0))
    faces = {face.name: face for face in assemble(joint, subject.mesh).rectangles}
    look = {"cmap": mpl.colormaps["viridis"].with_extremes(bad="#bbbbbb"), "vmin": 0.0}
    for name, own in inner.groupby("face", sort=False):
        cells, face = own.pivot(index="x_m", columns="y_m", values="shear_kPa"), faces[str(name)]
        along, across = (
            MM * cell_edges(places.to_numpy(), face.low[axis], face.high[axis])
            for axis, places in ((X, cells.index), (Y, cells.columns))
        )
        drawn = axes.pcolormesh(across, along, cells, vmax=strongest / 1e3, **look)
        axes.axvline(across[0], color="white", linewidth=2)
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
    return drawn


def _thinned(nodes: pd.DataFrame) -> pd.DataFrame:
    """At most `MOST_ARROWS` by as many of a face's nodes, evenly spread."""
    chosen = np.ones(len(nodes), dtype=bool)
    for axis in ("x_m", "y_m"):
        _, rank = np.unique(nodes[axis], return_inverse=True)
        count = int(rank.max()) + 1
        step = -(-count // MOST_ARROWS)
        chosen &= (rank - (count - 1) % step // 2) % step == 0
    return nodes[chosen]


def cell_edges(places: Floats, low: float, high: float) -> Floats:
    """Edges of the cells around regular nodes: half-way between ``places``, and a face's ends."""
    return np.concatenate([[low], (places[1:] + places[:-1]) / 2, [high]])
