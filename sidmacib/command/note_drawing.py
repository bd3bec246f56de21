"""Drawing of a joint with its dimensions, for a calculation note: SVG in mm."""

from sidmacib.joint import Direction, Joint

MM = 1e3
UPPER, LOWER = "#c9dcec", "#f4dcc2"  # blocks
WIDE = 560.0  # of a view, units of the drawing
TEXT = 11.0
GAP = 16.0  # between a view and a line of dimensions


def _rectangle(x: float, y: float, width: float, height: float, fill: str) -> str:
    sizes = f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"'
    return f'<rect {sizes} fill="{fill}" stroke="#333"/>'


def _text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'


def _line(x: float, y: float, to_x: float, to_y: float, style: str = "dimension") -> str:
    return f'<line class="{style}" x1="{x:.1f}" y1="{y:.1f}" x2="{to_x:.1f}" y2="{to_y:.1f}"/>'


def _across(x: float, to_x: float, y: float, words: str) -> str:
    """A horizontal dimension."""
    ends = "".join(_line(end, y - 4, end, y + 4) for end in (x, to_x))
    return _line(x, y, to_x, y) + ends + _text((x + to_x) / 2, y - 4, words)


def _up(x: float, y: float, to_y: float, words: str) -> str:
    """A vertical dimension, its words to the right."""
    ends = "".join(_line(x - 4, end, x + 4, end) for end in (y, to_y))
    return _line(x, y, x, to_y) + ends + _text(x + 7, (y + to_y) / 2 + 4, words, "start")


def drawing(joint: Joint, direction: Direction, push: str) -> str:
    """Elevation and plan of ``joint`` under the load along ``direction``, in SVG."""
    total = joint.total_width
    scale = min(WIDE / total, 90.0 / (joint.h + joint.H), 130.0 / joint.a)
    left, top = 90.0, 46.0
    right = left + scale * total
    body, lock = scale * joint.H, scale * joint.h
    parts = [_text(left, 14, "Elevation (y, z), mm", "start")]
    edge = [left + scale * joint.edge(number) for number in (0, *joint.numbers)]
    foot = top + body + lock
    parts.append(_rectangle(left, top, right - left, body, UPPER))
    parts.append(_rectangle(left, foot, right - left, max(0.5 * body, 14.0), LOWER))
    for number in joint.numbers:
        x, width = edge[number - 1], edge[number] - edge[number - 1]
        parts.append(
            _rectangle(x, top + body, width, lock, UPPER if joint.is_upper(number) else LOWER)
        )
        if joint.upper_body == "columns" and number > 1:
            parts.append(_line(x, top, x, top + body, "cut"))
        if width >= 12.0:
            parts.append(_text(x + width / 2, top + body - 5, str(number)))
    parts.append(_across(edge[0], edge[1], top - 6, f"b = {MM * joint.width(1):g}"))
    parts.append(_up(right + GAP, top, top + body, f"H = {MM * joint.H:g}"))
    parts.append(_up(right + GAP, top + body, foot, f"h = {MM * joint.h:g}"))
    plan = foot + max(0.5 * body, 14.0) + 40.0
    deep = scale * joint.a
    parts.append(_text(left, plan - 24, "Plan (y, x), mm", "start"))
    for number in joint.numbers:
        x, width = edge[number - 1], edge[number] - edge[number - 1]
        parts.append(_rectangle(x, plan, width, deep, UPPER if joint.is_upper(number) else LOWER))
    parts.append(_across(left, right, plan - 6, f"{MM * total:g}"))
    parts.append(_up(right + GAP, plan, plan + deep, f"a = {MM * joint.a:g}"))
    middle, lowest = plan + deep / 2, plan + deep
    from_left = push == "+y"
    start, end = (left - 46, left - 4) if from_left else (right + 46 + GAP, right + 4)
    if direction.shear:
        off = min(max(direction.eccentricity * deep, -0.5 * deep - 30), 0.5 * deep + 30)
        lowest = max(lowest, middle + off)
        parts.append(_line(start, middle + off, end, middle + off, "load"))
        sign = 1 if from_left else -1
        head = f"{end:.1f},{middle + off:.1f} {end - sign * 9:.1f},{middle + off - 4:.1f}"
        parts.append(f'<polygon points="{head} {end - sign * 9:.1f},{middle + off + 4:.1f}"/>')
        parts.append(_text(start, middle + off - 7, "V", "start" if from_left else "end"))
        if off:
            place = left - 56
            parts.append(_line(left - 60, middle, right, middle, "axis"))
            parts.append(_line(place, middle, place, middle + off))
            parts.append(_text(place - 5, middle + off / 2 + 4, "e", "end"))
    else:
        parts.append(_text((left + right) / 2, middle + 4, "M only (torsion)"))
    wide, high = right + 110.0, lowest + 20.0
    return (
        f'<svg viewBox="0 0 {wide:.0f} {high:.0f}" role="img" '
        f'aria-label="Elevation and plan of the joint, with dimensions">{"".join(parts)}</svg>'
    )
