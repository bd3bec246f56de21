"""A sheet for the workshop: plan, elevation, section and dimensions of one kind of block.

All is drawn to a scale in one pair of axes, whose unit is a mm of paper.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline
from matplotlib.transforms import Bbox

from sidmacib.build import Kind
from sidmacib.build.files import UNITS, label
from sidmacib.build.views import (
    Detail,
    View,
    cut_place,
    detail,
    distinct,
    section,
    smooth,
    straight,
    view,
)
from sidmacib.drawing import BLACK, GREY, VERMILION, write_figure
from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.locks import Row
from sidmacib.structure.structure import Pair

WIDTH, HEIGHT, BORDER, STRIP = 297.0, 210.0, 8.0, 20.0  # A4; the strip has the words
ROOM = 26.0  # mm of paper between views, for dimensions and titles
SCALES: tuple[float, ...] = (0.1, 0.2, 0.5, 1, 2, 2.5, 5, 10, 15, 20, 25)
SCALES += (50, 75, 100, 150, 200, 250, 500, 1000, 2000, 5000, 10000)
MOST = 12  # dimensions in a chain: more have no room
LEAST = 2.2  # mm of paper: shorter ones have none
KEPT = 0.6  # of all stops: a chain without more of them would tell too little
LABELLED = 12.0  # mm of paper: edges that are shorter have no room for their length
LEVEL = 0.05  # degrees: what is inclined by less counts as level or upright
MOST_DETAILS = 3
FRONT = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # to the right, up, towards the viewer
ABOVE = np.eye(3)
BELOW = np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]])
TILTED = np.array([[0.8, 0.6, 0], [-0.3, 0.4, 0.8660254], [0.519615, -0.69282, 0.5]])


@dataclass(frozen=True, eq=False)
class Placed:
    """A view, its title, and where the lower left corner of what it shows is on paper, in mm."""

    title: str
    view: View
    corner: tuple[float, float]
    scale: float  # mm of paper for each m

    def on_paper(self, points: Floats) -> Floats:
        """``points`` (m), (..., 2), in mm of paper."""
        low = self.view.visible.reshape(-1, 2).min(axis=0)
        return np.asarray((points - low) * self.scale + self.corner)


def region(left: float, low: float, right: float, top: float) -> Bbox:
    """A part of the paper, in mm, of at least 1 mm."""
    return Bbox.from_extents(left, low, max(right, left + 1.0), max(top, low + 1.0))


def draw_sheet(kind: Kind, rows: Mapping[Pair, Row], count: int, unit: str, note: str) -> Figure:
    """The sheet of ``kind``, one of whose blocks is one of ``count``; dimensions in ``unit``.

    ``rows``: all locks; ``note``: what else is to be known, such as the clearance.
    """
    solid = smooth(kind.drawn)
    place = cut_place(solid)
    size = solid.places.max(axis=0)
    ratio, columns, levels = _arranged(size)
    scale = 1e3 / ratio
    front = Placed("elevation", view(solid, FRONT), (columns[0], levels[1]), scale)
    views = [
        front,
        Placed("section A\N{EN DASH}A", section(solid, place), (columns[1], levels[1]), scale),
        Placed("plan", view(solid, ABOVE), (columns[0], levels[0]), scale),
        Placed("from below", view(solid, BELOW), (columns[1], levels[0]), scale),
    ]
    figure = Figure(figsize=(WIDTH / 25.4, HEIGHT / 25.4))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0, WIDTH), ylim=(0, HEIGHT))
    axes.set_axis_off()
    for each in views:
        _draw(axes, each)
        chained = _dimensions(axes, each, unit)
        if each in (front, views[2]):
            _edges(axes, each, unit, chained)
    for each in (front, views[2]):
        x = each.corner[0] + place * scale
        top = each.on_paper(each.view.visible.reshape(-1, 2)).max(axis=0)[1]
        ends = (each.corner[1] - 1.5, top + 3)
        axes.plot((x, x), ends, color=VERMILION, lw=0.8, ls=(0, (12, 3, 2, 3)))
        axes.text(x + 1, ends[1], "A", color=VERMILION, fontsize=8, va="bottom")
    above = region(columns[2], levels[1], WIDTH - BORDER - 4, HEIGHT - BORDER - 8)
    beside = columns[1] + size[0] * scale + ROOM
    below = region(beside, levels[0] - 12, WIDTH - BORDER - 4, levels[1] - ROOM + 6)
    least, most = sorted((above, below), key=lambda each: each.width * each.height)
    first = kind.solids[0]
    found = [detail(first, pair, row) for pair, row in rows.items() if first.name in pair]
    if found and least.height < 45.0:
        least = region(most.x0, most.y0, most.x1, most.y0 + 0.4 * most.height)
        most = region(most.x0, least.y1 + 4.0, most.x1, most.y1)
    seen = view(solid, TILTED)
    extent = np.ptp(seen.visible.reshape(-1, 2), axis=0)
    tilted = min(most.width / extent[0], (most.height - 6) / extent[1])
    shown = View(seen.visible, seen.hidden[:0])
    _draw(axes, Placed("from a corner, not to scale", shown, (most.x0, most.y0), tilted))
    _details(axes, found, least, unit)
    _words(axes, kind, count, unit, ratio, note)
    return figure


def write_sheet(figure: Figure, path: Path) -> None:
    """Write the sheet as SVG or PDF, always the same bytes."""
    with mpl.rc_context({"hatch.linewidth": 0.4}):
        write_figure(figure, path)


def _arranged(size: Floats) -> tuple[float, list[float], list[float]]:
    """The scale, 1 : the first number, and the left and lower edges of columns and rows, in mm."""
    x, y, z = 1e3 * size
    second = max(x, y)
    wide, high = WIDTH - 2 * BORDER - 3 * ROOM - 55.0, HEIGHT - 2 * BORDER - STRIP - 2 * ROOM
    ratio = next(
        (s for s in SCALES if (x + second) / s <= wide and (y + z) / s <= high), SCALES[-1]
    )
    columns = [BORDER + ROOM / 2, BORDER + 1.5 * ROOM + x / ratio]
    columns.append(columns[1] + second / ratio + ROOM)
    low = BORDER + STRIP + ROOM - 8
    return ratio, columns, [low, low + y / ratio + ROOM]


def _draw(axes: Axes, each: Placed) -> None:
    """Lines, the section's hatch, and the title."""
    if each.view.cut:
        corners, codes = [], []
        for outline in each.view.cut:
            closed = each.on_paper(np.vstack([outline, outline[:1]]))
            corners.append(closed)
            codes += [Outline.MOVETO, *[Outline.LINETO] * (len(outline) - 1), Outline.CLOSEPOLY]
        shape = Outline(np.concatenate(corners), codes)
        axes.add_patch(PathPatch(shape, fc="#e8e8e8", ec=BLACK, lw=1.1, hatch="////"))
    hidden, visible = (each.on_paper(lines) for lines in (each.view.hidden, each.view.visible))
    axes.add_collection(LineCollection(hidden, colors=GREY, lw=0.4, ls=(0, (4, 2.5))))
    axes.add_collection(LineCollection(visible, colors=BLACK, lw=0.8, capstyle="round"))
    top = visible.reshape(-1, 2).max(axis=0)[1]
    axes.text(each.corner[0], top + 7.5, each.title, fontsize=8, style="italic")


def _dimensions(axes: Axes, each: Placed, unit: str) -> list[bool]:
    """A chain below and one on the right, of all corners, and one of the whole.

    Returns whether there is room for all corners below and on the right.
    """
    chained = []
    points = each.view.visible.reshape(-1, 2)
    low, high = each.on_paper(points.min(axis=0)), each.on_paper(points.max(axis=0))
    for axis in (0, 1):
        stops = distinct(np.concatenate([points[:, axis], each.view.hidden[..., axis].ravel()]))
        apart = _apart(stops, LEAST / each.scale)
        room = 2 < len(apart) <= MOST + 1 and len(apart) >= KEPT * len(stops)
        chained.append(room)
        chains = [apart] if room else []
        for number, chain in enumerate([*chains, [stops[0], stops[-1]]]):
            off = 4.5 + 5.5 * number
            across = low[1] - off if axis == 0 else high[0] + off
            _chain(axes, each, axis, chain, across, unit)
    return chained


def _edges(axes: Axes, each: Placed, unit: str, chained: Sequence[bool]) -> None:
    """Lengths of edges that are not those of the whole, and angles of inclined ones to the level.

    Of edges too short for their length, the longest of a direction above and below the middle has
    its angle. ``chained``: whether level and upright edges are told by a chain.
    """
    size = np.ptp(each.view.visible.reshape(-1, 2), axis=0)
    middle = each.view.visible.reshape(-1, 2).min(axis=0) + size / 2
    told: set[tuple[float, bool]] = set()
    for start, end in straight(each.view.visible):
        along = end - start if end[0] > start[0] else start - end
        length, angle = float(np.hypot(*along)), float(np.degrees(np.arctan2(along[1], along[0])))
        inclined = LEVEL < abs(angle) < 90.0 - LEVEL
        angle = angle if inclined else round(abs(angle), -1)
        long = length * each.scale >= LABELLED
        same = (round(angle, 1), bool(((start + end) / 2 - middle)[1] > 0.0))
        axis = int(abs(angle) > 45.0)
        if not inclined and (not long or chained[axis] or np.isclose(length, size[axis])):
            continue
        if inclined and not long and (same in told or length * each.scale < LABELLED / 3):
            continue
        told.add(same)
        words = spelled(UNITS[unit] * length) if long else ""
        words += f"  {abs(angle):.3g}\N{DEGREE SIGN}" if inclined else ""
        normal = np.array([-along[1], along[0]]) / length
        inwards = normal * np.sign((middle - (start + end) / 2) @ normal)
        place = each.on_paper((start + end) / 2) + 1.6 * inwards
        aligned = {"ha": "center", "va": "center", "rotation_mode": "anchor"}
        axes.text(*place, words.strip(), fontsize=5.5, rotation=angle, **aligned)


def _apart(stops: Sequence[float], least: float) -> list[float]:
    """``stops`` without those nearer than ``least`` to the one before, or to the last one."""
    kept = [stops[0]]
    for stop in stops[1:-1]:
        if stop - kept[-1] >= least and stops[-1] - stop >= least:
            kept.append(stop)
    return [*kept, stops[-1]]


def _chain(
    axes: Axes, each: Placed, axis: int, stops: Sequence[float], across: float, unit: str
) -> None:
    """A line with a stroke at each stop and the distances between them."""
    pairs = np.zeros((len(stops), 2))
    pairs[:, axis] = stops
    along = each.on_paper(pairs)[:, axis]
    turn = 1 if axis == 0 else -1  # of a pair: along, across to x, y
    axes.plot(*((along[0], along[-1]), (across, across))[::turn], color=BLACK, lw=0.4)
    for place in along:
        stroke = ((place - 0.8, place + 0.8), (across - 0.8, across + 0.8))
        axes.plot(*stroke[::turn], color=BLACK, lw=0.7)
    for number, (start, end) in enumerate(pairwise(along)):
        words = spelled(UNITS[unit] * (stops[number + 1] - stops[number]))
        close = end - start < 0.9 * len(words) + 1.5 and number % 2 == 1
        off = turn * (-0.5 if close else 0.5)
        place = ((start + end) / 2, across + off)[::turn]
        aligned = {"ha": "center", "va": "top" if close else "bottom"}
        if axis == 1:
            aligned = {"ha": "left" if close else "right", "va": "center"}
        axes.text(*place, words, fontsize=5.5, rotation=90.0 * axis, **aligned)


def spelled(number: float) -> str:
    """A dimension with at most two digits behind the point, or four significant ones."""
    return f"{number:.2f}".rstrip("0").rstrip(".") if number >= 10 else f"{number:.4g}"


def _details(axes: Axes, found: Sequence[Detail], room: Bbox, unit: str) -> None:
    """Profiles of locks, as large as there is room for."""
    if not found:
        return
    shown = found[:MOST_DETAILS]
    parts = len(shown)
    beside = room.width > 1.5 * room.height
    wide, high = room.width / (parts if beside else 1), room.height / (1 if beside else parts)
    for number, each in enumerate(shown):
        size = np.ptp(np.concatenate(each.outlines), axis=0)
        scale = min((wide - 20) / size[0], (high - 22) / size[1])
        left = room.x0 + (number * wide if beside else 0.0)
        low = room.y1 - high * (1 if beside else number + 1) + 10
        lines = [np.stack([o, np.roll(o, -1, axis=0)], axis=1) for o in each.outlines]
        seen = View(np.concatenate(lines), np.zeros((0, 2, 2)), each.outlines)
        placed = Placed(each.title, seen, (left, low), scale)
        _draw(axes, placed)
        stops = np.array([[x, each.low] for x in each.stops])
        _chain(axes, placed, 0, each.stops, placed.on_paper(stops)[0, 1] - 4.5, unit)
        ends = placed.on_paper(np.array([[each.stops[-1], each.low]]))
        _chain(axes, placed, 1, each.heights, float(ends[0, 0]) + 7, unit)
    if more := len(found) - len(shown):
        words = f"and {more} more joints with locks: see the files of the solid"
        axes.text(room.x0, room.y0, words, fontsize=6.5, style="italic")


def _words(axes: Axes, kind: Kind, count: int, unit: str, ratio: float, note: str) -> None:
    """The frame, and what the sheet is of."""
    axes.add_patch(
        Rectangle((BORDER, BORDER), WIDTH - 2 * BORDER, HEIGHT - 2 * BORDER, fill=False, lw=0.8)
    )
    axes.plot((BORDER, WIDTH - BORDER), (BORDER + STRIP,) * 2, color=BLACK, lw=0.8)
    first = kind.solids[0]
    names = ", ".join(label(each, count) for each in kind.solids)
    if len(names) > 90:
        names = f"{names[:90].rsplit(',', 1)[0]} and others, see blocks.csv"
    many = len(kind.solids)
    left, top = BORDER + 3, BORDER + STRIP - 6
    axes.text(left, top, f"Kind {kind.name}", fontsize=13, weight="bold", va="center")
    axes.text(left + 32, top + 0.5, f"{many} block{'s' if many > 1 else ''}: {names}", fontsize=7.5)
    mass = f"{first.volume:.6g} m\N{SUPERSCRIPT THREE}, {first.mass:.5g} kg each"
    axes.text(
        left + 32, top - 5, f"{mass} ({first.density:g} kg/m\N{SUPERSCRIPT THREE})", fontsize=7.5
    )
    axes.text(left + 32, top - 10, note, fontsize=7.5)
    scale = f"1 : {ratio:g}" if ratio >= 1 else f"{1 / ratio:g} : 1"
    right = WIDTH - BORDER - 3
    for number, words in enumerate(
        (f"scale {scale} on A4", f"dimensions in {unit}", "first-angle projection")
    ):
        axes.text(right, top + 0.5 - 5 * number, words, fontsize=7.5, ha="right")
