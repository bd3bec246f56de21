"""A joint in three dimensions as SVG, opened: the upper block is lifted off, so that locks show.

Drawn from the joint's boxes in parallel projection, the furthest first. ``python -m
analysis.drawing.sketch`` writes the picture of the README.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from analysis.drawing.boxes import Box, boxes
from sidmacib.drawing import BLUE, VERMILION
from sidmacib.joint.joint import Joint
from sidmacib.mechanics.assembly import Vector

PICTURE = Path(__file__).parents[2] / "docs" / "images" / "joint_3d.svg"
TURN, FALL = math.radians(28.0), math.radians(26.0)  # of the line of sight, about z and down
LIFT = 0.55  # of the upper block, over a
MARGIN = 0.3  # around the blocks, over a: for arrows
INK, GREY, BACK = "#1c1f24", "#9aa0aa", "#ffffff"
SHADES = (1.0, 0.78, 0.62)  # of a box's top, front and side

Point = tuple[float, float]


def sketch(joint: Joint, ratio: float = 0.3) -> str:
    """``joint`` under V at the eccentricity ``ratio`` a, as an SVG element 640 px wide."""
    lift = LIFT * 1e3 * joint.a
    drawn = [_lifted(box, lift) if box.upper else box for box in boxes(joint)]
    drawn.sort(key=lambda box: (box.upper, box.low[2], box.low[1]))
    parts = [part for box in drawn for part in _box(box)]
    top = max(box.high[2] for box in drawn)
    body = next(box.low[2] for box in drawn if box.upper and box.lock is None)
    width, length = 1e3 * joint.total_width, 1e3 * joint.a
    parts += _shear((ratio * length, 0.0, (body + top) / 2.0), 0.8 * length)
    parts += _torque((0.0, width / 2.0, top), 0.3 * length)
    corners = [seen(p) for box in drawn for p in (box.low, box.high, *_corners(box))]
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


def _lifted(box: Box, by: float) -> Box:
    (x, y, z), (u, v, w) = box.low, box.high
    return replace(box, low=(x, y, z + by), high=(u, v, w + by))


def _corners(box: Box) -> Iterator[Vector]:
    (x, y, z), (u, v, w) = box.low, box.high
    yield from ((a, b, c) for a in (x, u) for b in (y, v) for c in (z, w))


def _box(box: Box) -> Iterator[str]:
    """The faces of a box that are seen: its top, its front (least x) and its side (largest y)."""
    (x, y, z), (u, v, w) = box.low, box.high
    top = (x, y, w), (x, v, w), (u, v, w), (u, y, w)
    front = (x, y, z), (x, v, z), (x, v, w), (x, y, w)
    side = (x, v, z), (u, v, z), (u, v, w), (x, v, w)
    colour = BLUE if box.upper else GREY
    for face, shade in zip((top, front, side), SHADES, strict=True):
        strength = shade if box.lock is not None else 0.45 * shade
        yield (
            f'<polygon points="{_listed(face)}" fill="{_mixed(colour, strength, shade)}" '
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
    yield _line(((u0, v0), (u1, v1)))
    yield _head((u1, v1), seen(at))
    yield _text(u0, v0 + 0.14 * length, "V", VERMILION)


def _torque(middle: Vector, radius: float) -> Iterator[str]:
    """The torque M = V e about z."""
    x, y, z = middle
    angles = [math.pi * (-0.75 + 1.5 * step / 24) for step in range(25)]
    arc = [seen((x - radius * math.cos(t), y - radius * math.sin(t), z)) for t in angles]
    yield _line(arc[:-2])
    yield _head(arc[-3], arc[-1])
    yield _text(*seen((x + 2.3 * radius, y, z)), "M = V e", VERMILION)


def _line(points: Sequence[Point]) -> str:
    placed = " ".join(f"{u:.1f},{-v:.1f}" for u, v in points)
    return f'<polyline points="{placed}" fill="none" stroke="{VERMILION}" stroke-width="2"/>'


def _head(begin: Point, tip: Point) -> str:
    """An arrow's head."""
    along = tip[0] - begin[0], tip[1] - begin[1]
    half = 0.35
    base = [(begin[0] - s * half * along[1], begin[1] + s * half * along[0]) for s in (1, -1)]
    placed = " ".join(f"{u:.1f},{-v:.1f}" for u, v in (tip, *base))
    return f'<polygon points="{placed}" fill="{VERMILION}"/>'


def _text(u: float, v: float, words: str, colour: str) -> str:
    place = f'x="{u:.1f}" y="{-v:.1f}" text-anchor="middle" dominant-baseline="central"'
    return f'<text {place} fill="{colour}">{words}</text>'


def _listed(face: Sequence[Vector]) -> str:
    return " ".join(f"{u:.1f},{-v:.1f}" for u, v in map(seen, face))


if __name__ == "__main__":
    PICTURE.write_text(sketch(Joint(5)))
