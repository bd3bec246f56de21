"""A still picture of what a model says of a structure."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from trimesh.remesh import subdivide_to_size

from sidmacib.drawing import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import four_digits
from sidmacib.scene.drawn import Drawn
from sidmacib.scene.forces import row_point
from sidmacib.structure.analysis.forces import NEXT_TO_NOTHING

FLAT = 0.4  # of the longer of the other sides: what is less deep is seen from its front
FROM = np.array([-1.0, -1.7, 0.8])  # the way to who looks at others, as in `structure.js`
ABOVE = 2.5  # times as high, for structures that lie flat
LYING = 0.5  # of the shorter horizontal side: as high as those at most
ARROW = 0.8  # of the mean diagonal of free blocks: the largest load, and the largest reaction
ASIDE = 0.3  # of a load: what is not along the view of a structure's front, at least
PART, LEAST_PART = 0.25, 0.01  # longest side of a triangle: of that diagonal, of the structure
MOST_ROUNDS = 12  # of dividing triangles
WIDTH, LEAST, MARGINS = 7.0, 0.4, 1.4  # inches; LEAST: height over width
LIGHT, DARK, HELD = "#e4e7ec", "#c9ced8", "#8d94a0"
MOST_LABELS = 12  # of reactions that are written beside their arrows


def picture(drawn: Drawn, shape: Mapping[str, Any], title: str, width: float = WIDTH) -> Figure:
    """The structure of a ``shape`` at the load that counts: loads, reactions, hinges, thrust line.

    From its front if it is as flat as an arch or a wall, otherwise from above and the left. Without
    forces if the model has no answer. ``width``: in inches.
    """
    points = _points(shape["blocks"])
    loaded = drawn.arrows["variable"]
    pushed = np.sum([each["force"] for each in loaded] or [np.zeros(3)], axis=0)
    axes3 = view_axes(np.ptp(points, axis=0), pushed)
    wide, high = np.ptp(points @ axes3[:2].T, axis=0)
    height = min(max(width * high / wide, LEAST * width), width)
    figure = Figure(figsize=(width, height + MARGINS), layout="constrained")
    axes = figure.subplots()
    _blocks(axes, shape, axes3)
    _interfaces(axes, shape, drawn, axes3)
    _forces(axes, shape, drawn, axes3)
    axes.set_aspect("equal")
    axes.margins(0.08)
    axes.set_title(title, loc="left", fontsize=10, wrap=True)
    if np.isclose(np.abs(axes3), 0.0).sum() == 6:  # along the axes of the blocks
        across, up = ("xyz"[int(np.abs(axis).argmax())] for axis in axes3[:2])
        axes.set_xlabel(f"{across} (m)")
        axes.set_ylabel(f"{up} (m)")
        axes.spines[["top", "right"]].set_visible(False)
    else:
        axes.set_axis_off()
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(
            handles, labels, loc="outside lower center", ncols=3, fontsize=8, frameon=False
        )
    return figure


def mean_diagonal(shape: Mapping[str, Any]) -> float:
    """Of the boxes around free blocks, m; large blocks count more than locks."""
    free = [_points([block]) for block in shape["blocks"] if not block["fixed"]]
    sizes = np.array([np.linalg.norm(np.ptp(each, axis=0)) for each in free])
    return float(sizes @ sizes / sizes.sum())


def _points(blocks: Sequence[Mapping[str, Any]]) -> Floats:
    return np.concatenate([np.array(block["points"]) for block in blocks])


def view_axes(sides: Floats, pushed: Floats) -> Floats:
    """Axes to the right, up, and towards who looks at a structure of such ``sides`` (m), (3, 3).

    ``pushed``: the whole load, (3,); it must not point at who looks, or away.
    """
    x, y, z = sides.tolist()
    beside = np.linalg.norm(pushed) - np.abs(pushed) >= ASIDE * np.linalg.norm(pushed)
    if y <= FLAT * max(x, z) and beside[1]:
        towards = np.array([0.0, -1.0, 0.0])
    elif x <= FLAT * max(y, z) and beside[0]:
        towards = np.array([1.0, 0.0, 0.0])
    else:
        towards = FROM * np.array([1.0, 1.0, ABOVE if z < LYING * min(x, y) else 1.0])
    towards = towards / np.linalg.norm(towards)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def _blocks(axes: Axes, shape: Mapping[str, Any], axes3: Floats) -> None:
    """The faces of blocks that look this way, those further away first.

    In small triangles, as otherwise a large one may hide what is in front of its middle.
    """
    size = float(np.linalg.norm(np.ptp(_points(shape["blocks"]), axis=0)))
    largest = max(PART * mean_diagonal(shape), LEAST_PART * size)
    found, edges = [], []
    for block in shape["blocks"]:
        seen = np.array(block["points"]) @ axes3.T
        places, triangles = subdivide_to_size(seen, block["triangles"], largest, MOST_ROUNDS)
        for corners in places[triangles]:
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            if normal[2] > 0.0:
                share = float(normal[2] / np.linalg.norm(normal))
                colour = HELD if block["fixed"] else LIGHT if share > 0.7 else DARK
                found.append((float(corners[:, 2].mean()), corners[:, :2], colour))
        edges += [seen[[*edge, edge[0]], :2] for edge in block["edges"]]
    found.sort(key=lambda each: each[0])
    colours = [colour for _, _, colour in found]
    outlines = [corners for _, corners, _ in found]
    faces = PolyCollection(outlines, facecolors=colours, lw=0.0, antialiaseds=False)
    faces.set_rasterized(True)  # there may be many
    axes.add_collection(faces)
    axes.add_collection(LineCollection(edges, colors="#5b6472", lw=0.5))
    axes.autoscale_view()


def _interfaces(axes: Axes, shape: Mapping[str, Any], drawn: Drawn, axes3: Floats) -> None:
    """Hinges, what slides, and the interface whose bond fails first."""
    first = drawn.failing[0][0] if drawn.failing else None
    for each in shape["interfaces"]:
        if each["name"] == first:
            for number, edge in enumerate(each["edges"]):
                x, y, _ = (np.array(each["points"])[[*edge, edge[0]]] @ axes3.T).T
                label = f"first bond failure: {first}" if number == 0 else None
                axes.plot(x, y, color=VERMILION, lw=2.5, label=label)
    of_lock = {  # which a joint does not turn about
        each["name"]
        for each in shape["interfaces"]
        if any(shape["blocks"][end]["with"] != end for end in each["between"])
    }
    sizes = [float(np.hypot(row.normal_N, row.shear_N)) for row in drawn.interfaces]
    least = NEXT_TO_NOTHING * max(sizes, default=0.0)
    for mode, marker, colour, found in (("hinge", "o", BLUE, 6), ("slides", "D", VERMILION, 5)):
        places = [
            row_point(row)
            for row, size in zip(drawn.interfaces, sizes, strict=True)
            if size > least and row.interface not in of_lock and mode in row.mode
        ]
        if places:
            x, y, _ = axes3 @ np.array(places).T
            axes.plot(x, y, marker, color=colour, ms=found, mec="white", label=mode, zorder=4)


def _forces(axes: Axes, shape: Mapping[str, Any], drawn: Drawn, axes3: Floats) -> None:
    """The thrust line, loads and reactions."""
    for number, line in enumerate(drawn.thrust):
        x, y, _ = axes3 @ np.array([each["point"] for each in line]).T
        axes.plot(x, y, color=BLACK, lw=1.6, label=None if number else "thrust line", zorder=3)
    longest = ARROW * mean_diagonal(shape)
    loads = drawn.arrows
    held: list[dict[str, Any]] = [
        {"at": each.near or each.middle, "force": each.force, "point": True}
        for each in drawn.reactions
    ]
    for arrows, colour, label in (
        (loads["variable"], GREEN, drawn.load_words),
        (loads["permanent"], PURPLE, "permanent load"),
        (held, ORANGE, "reaction"),
    ):
        most = max((float(np.linalg.norm(each["force"])) for each in arrows), default=0.0)
        style = {"arrowstyle": "-|>", "color": colour, "lw": 2.0, "shrinkA": 0, "shrinkB": 0}
        for number, each in enumerate(arrows):
            place, force = np.array(each["at"]), np.array(each["force"])
            along = longest / most * force
            tail, tip = (place - along, place) if each["point"] else (place, place + along)
            start, end = (axes3 @ tail)[:2], (axes3 @ tip)[:2]
            axes.annotate("", end, start, arrowprops=style, zorder=5)
            named = None if number else label
            axes.plot(*np.array([start, end]).T, color=colour, lw=2.0, label=named)
            if arrows is held and len(held) <= MOST_LABELS:
                words = _components(force)
                axes.annotate(words, start, fontsize=7, ha="center", va="top", zorder=6)


def _components(force: Floats) -> str:
    """Those that are more than next to nothing, a line each."""
    least = NEXT_TO_NOTHING * float(np.linalg.norm(force))
    told = zip("xyz", force.tolist(), strict=True)
    return "\n".join(
        f"R{axis} {four_digits(value)} N" for axis, value in told if abs(value) > least
    )
