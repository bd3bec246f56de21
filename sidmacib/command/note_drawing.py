"""Drawing of a joint with its dimensions, for a calculation note: sizes in units of the drawing."""

from typing import Any

from sidmacib.joint import Direction, Joint

WIDE = 560.0  # of a view
LEFT, TOP = 90.0, 46.0  # corner of the elevation
GAP = 16.0  # between a view and a line of dimensions
LEAST = 14.0  # height of the lower block


def drawing(joint: Joint, direction: Direction, push: str) -> dict[str, Any]:
    """Where elevation, plan and load along ``direction`` are drawn by the template."""
    scale = min(WIDE / joint.total_width, 90.0 / (joint.h + joint.H), 130.0 / joint.a)
    right, deep = LEFT + scale * joint.total_width, scale * joint.a
    foot = TOP + scale * joint.H + scale * joint.h
    below = max(0.5 * scale * joint.H, LEAST)
    plan = foot + below + 40.0
    middle, off = plan + deep / 2, 0.0
    if direction.shear:
        off = min(max(direction.eccentricity * deep, -0.5 * deep - 30), 0.5 * deep + 30)
    from_left = push == "+y"
    return {
        "left": LEFT,
        "right": right,
        "top": TOP,
        "roots": TOP + scale * joint.H,
        "foot": foot,
        "below": below,
        "locks": [
            (LEFT + scale * joint.edge(lock - 1), LEFT + scale * joint.edge(lock))
            for lock in joint.numbers
        ],
        "plan": plan,
        "deep": deep,
        "middle": middle,
        "off": off,
        "sign": 1 if from_left else -1,
        "start": LEFT - 46 if from_left else right + 46 + GAP,
        "end": LEFT - 4 if from_left else right + 4,
        "dimensions": right + GAP,
        "wide": right + 110.0,
        "high": max(plan + deep, middle + off) + 20.0,
    }
