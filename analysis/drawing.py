"""Names and colours of models, options and rules in figures and pages; joints as boxes and as SVG.

``python -m analysis.drawing`` writes the picture of the README.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from sidmacib.contact_points import OPTIONS
from sidmacib.drawing import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from sidmacib.joint import Joint
from sidmacib.joint.pieces import PLATE, cut_pieces, lock_name, upper_block
from sidmacib.mechanics.assembly import Vector
from sidmacib.models import MODELS

SERIES = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, BLACK)  # of what is no model, in turn
MM = 1e3  # of a m
PICTURE = Path(__file__).parents[1] / "docs" / "images" / "joint_3d.svg"
TURN, FALL = math.radians(28.0), math.radians(26.0)  # of the line of sight, about z and down
LIFT = 0.55  # of the upper block, over a
RATIO = 0.3  # e / a of V
MARGIN = 0.3  # around the blocks, over a: for arrows
INK, FIXED, BACK = "#1c1f24", "#9aa0aa", "#ffffff"
SHADES = (1.0, 0.78, 0.62)  # of a box's top, front and side

Point = tuple[float, float]


@dataclass(frozen=True)
class Label:
    """The name of a model in figures and pages, and its colour."""

    name: str
    colour: str


PUBLISHED = Label("published (3DEC)", BLACK)
_RULES = {
    "none": "every lock counts",
    "half": "(n - 1) / 2 locks count",
    "floor_of_sum": "sum of weights, rounded down",
    "lower_sum": "lower locks count by their weights",
    "per_lock": "each lock counts by its weight",
}
_OPTIONS = dict(zip(OPTIONS, (ORANGE, SKY, PURPLE, "#2f4b7c"), strict=True))


def label_of(model: str) -> Label:
    """The label of a model; an unknown model keeps its name and is grey."""
    known = MODELS.get(model)
    return Label(known.label, known.colour) if known else Label(model, GREY)


def rule_name(reduction: str) -> str:
    """A reduction of SiDMACIB in words; unknown reductions keep their name."""
    return _RULES.get(reduction, reduction)


def option_name(option: str) -> str:
    """A contact-point option of SiDMACIB in words; the options of a study keep their name."""
    return option.replace("option", "Option ") if option in _OPTIONS else option


def option_colour(option: str) -> str:
    """The colour of a contact-point option of SiDMACIB; grey for the options of a study."""
    return _OPTIONS.get(option, GREY)


@dataclass(frozen=True)
class Box:
    """A piece from corner ``low`` to ``high`` (mm); ``lock``: its number, None if it is no lock."""

    lock: int | None
    upper: bool
    low: Vector
    high: Vector


def boxes(joint: Joint) -> Iterator[Box]:
    """All pieces of a joint but the plate: lower body, locks, upper body."""
    above, locks = set(upper_block(joint)), {lock_name(n): n for n in joint.numbers}
    for piece in cut_pieces(joint):
        if piece.name != PLATE:
            (x, y, z), (u, v, w) = piece.low, piece.high
            low, high = (MM * x, MM * y, MM * z), (MM * u, MM * v, MM * w)
            yield Box(locks.get(piece.name), piece.name in above, low, high)


def sketch(joint: Joint) -> str:
    """``joint`` under V at the eccentricity `RATIO` a, as an SVG element 640 px wide.

    In parallel projection, the furthest box first. The upper block is lifted off, so that locks
    show.
    """
    drawn = []
    for box in boxes(joint):
        (x, y, z), (u, v, w) = box.low, box.high
        up = LIFT * MM * joint.a if box.upper else 0.0
        drawn.append(replace(box, low=(x, y, z + up), high=(u, v, w + up)))
    drawn.sort(key=lambda box: (box.upper, box.low[2], box.low[1]))
    parts = [part for box in drawn for part in _box(box)]
    top = max(box.high[2] for box in drawn)
    body = next(box.low[2] for box in drawn if box.upper and box.lock is None)
    width, length = MM * joint.total_width, MM * joint.a
    parts += _shear((RATIO * length, 0.0, (body + top) / 2.0), 0.8 * length)
    parts += _torque((0.0, width / 2.0, top), 0.3 * length)
    ends = [tuple(zip(box.low, box.high, strict=True)) for box in drawn]
    corners = [seen(corner) for x, y, z in ends for corner in product(x, y, z)]
    left, right = min(u for u, _ in corners) - 0.95 * length, max(u for u, _ in corners)
    high, low = max(v for _, v in corners) + MARGIN * length, min(v for _, v in corners)
    frame = f"{left:.1f} {-high:.1f} {right - left + 4:.1f} {high - low + 4:.1f}"
    title = f"Joint with {joint.locks} locks, the upper block lifted off"
    back = f'<rect x="{left:.1f}" y="{-high:.1f}" width="100%" height="100%" fill="{BACK}"/>'
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{frame}" width="640" role="img"',
            f' aria-label="{title}" font-family="sans-serif" font-size="{0.16 * length:.1f}">',
            *(back, *parts, "</svg>\n"),
        )
    )


def seen(point: Vector) -> Point:
    """Where a point (mm) is in the picture: to the right and up (mm)."""
    x, y, z = point
    away = x * math.cos(TURN) - y * math.sin(TURN)
    return x * math.sin(TURN) + y * math.cos(TURN), z * math.cos(FALL) + away * math.sin(FALL)


def _box(box: Box) -> Iterator[str]:
    """The faces of a box that are seen: its top, its front (least x) and its side (largest y)."""
    (x, y, z), (u, v, w) = box.low, box.high
    top = (x, y, w), (x, v, w), (u, v, w), (u, y, w)
    front = (x, y, z), (x, v, z), (x, v, w), (x, y, w)
    side = (x, v, z), (u, v, z), (u, v, w), (x, v, w)
    colour = BLUE if box.upper else FIXED
    for face, shade in zip((top, front, side), SHADES, strict=True):
        fill = _mixed(colour, shade if box.lock is not None else 0.45 * shade, shade)
        yield (
            f'<polygon points="{_points(map(seen, face))}" fill="{fill}" '
            f'stroke="{INK}" stroke-width="0.6" stroke-linejoin="round"/>'
        )
    if box.lock is not None:
        across, up = seen((x, (y + v) / 2.0, (z + w) / 2.0))
        yield _text(across, up, str(box.lock), "#ffffff" if box.upper else INK)


def _mixed(colour: str, strength: float, shade: float) -> str:
    """``colour`` by ``strength`` on white, which is darkened to ``shade``."""
    parts = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    mixed = (shade * 255.0 + strength * (part - 255.0) * shade for part in parts)
    return "#" + "".join(f"{round(min(max(part, 0.0), 255.0)):02x}" for part in mixed)


def _shear(at: Vector, length: float) -> Iterator[str]:
    """The force V, from ``length`` before the point ``at`` which it acts."""
    x, y, z = at
    (u0, v0), (u1, v1) = seen((x, y - length, z)), seen((x, y - 0.12 * length, z))
    yield from _arrow([(u0, v0), (u1, v1), seen(at)])
    yield _text(u0, v0 + 0.14 * length, "V", VERMILION)


def _torque(middle: Vector, radius: float) -> Iterator[str]:
    """The torque M = V e about z."""
    x, y, z = middle
    angles = [math.pi * (-0.75 + 1.5 * step / 24) for step in range(25)]
    arc = [seen((x - radius * math.cos(t), y - radius * math.sin(t), z)) for t in angles]
    yield from _arrow([*arc[:-2], arc[-1]])
    yield _text(*seen((x + 2.3 * radius, y, z)), "M = V e", VERMILION)


def _arrow(points: Sequence[Point]) -> Iterator[str]:
    """A line with a head, which is its last part."""
    *line, tip = points
    u, v = line[-1]
    along, half = (tip[0] - u, tip[1] - v), 0.35
    base = [(u - s * half * along[1], v + s * half * along[0]) for s in (1, -1)]
    yield f'<polyline points="{_points(line)}" fill="none" stroke="{VERMILION}" stroke-width="2"/>'
    yield f'<polygon points="{_points([tip, *base])}" fill="{VERMILION}"/>'


def _text(u: float, v: float, words: str, colour: str) -> str:
    place = f'x="{u:.1f}" y="{-v:.1f}" text-anchor="middle" dominant-baseline="central"'
    return f'<text {place} fill="{colour}">{words}</text>'


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{u:.1f},{-v:.1f}" for u, v in points)


if __name__ == "__main__":
    PICTURE.write_text(sketch(Joint(5)))
