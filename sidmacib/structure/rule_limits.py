"""Limits of shear and torque by the law or the safe rule for the locks of an interface.

A row of locks is a joint on its interface. Its upper body is the smaller of the two blocks, whole
and held down as the user says; the rule's loads in several directions are corners of a polygon in
the (V, M) plane, inside which the resultant of the locks' forces has to stay. A force or a pressure
that holds the joint down is asked of the interface in return: it must be compressed as much. That a
plate holds it down is an assumption.
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, HoldDown, Joint, Side, UpperBody
from sidmacib.joint.loading import Push
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.polygons import ResultantLimits
from sidmacib.rule import RULES, LawCapacity
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.locks import Row
from sidmacib.validation import refused

ANGLES = np.linspace(0.0, math.pi / 2, 13)  # in the (V, M / a) plane, from shear to torque
STRAIGHT = 1e-6  # over the area of an interface: what it may lack of a rectangle


def rule_limits(
    row: Row, rule: str, hold_down: HoldDown, solids: Sequence[Block | Compound], name: str
) -> ResultantLimits:
    """The limits that ``rule``, one of `RULES`, sets to the locks of ``row``.

    ``solids``: the two blocks; ``name``: of the interface, for errors. ValueError where the rule
    refuses the joint, in any direction, and for locks of several widths or an interface that is no
    rectangle along them, which no rule was tested on.
    """
    joint = _joint(row, rule, hold_down, solids, name)
    try:
        points = _loads(joint, RULES[rule])
    except (CapacityError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise ValueError(
            f"locks of {name}: condensed.rule: {rule} has no answer: {reason}"
        ) from None
    normals = _half_planes(points / (1.0, joint.a)) / (1.0, joint.a)
    pressing = hold_down.force_on(joint.a * joint.total_width) or 0.0
    return ResultantLimits(normals[:, 0], normals[:, 1], pressing)


def _joint(
    row: Row, rule: str, hold_down: HoldDown, solids: Sequence[Block | Compound], name: str
) -> Joint:
    locks, area = row.locks, row.interface.outline.area
    widths = np.diff(row.edges)
    if np.ptp(widths) > STRAIGHT * widths.max():
        raise refused(f"locks of {name}: widths", widths.tolist(), "equal with condensed.rule")
    flat = shapely.get_coordinates(row.interface.outline.exterior) @ row.interface.axes[1:]
    length = float(np.ptp(flat @ row.run))
    if abs(length * widths.sum() - area) > STRAIGHT * area:
        needs = "needs an interface that is a rectangle along the locks"
        raise ValueError(f"locks of {name}: condensed.rule: {rule} {needs}")
    first = solids[1].name == locks.first
    return Joint(
        locks.count,
        a=length,
        b=float(widths.mean()),
        h=locks.height,
        H=min(each.volume for each in solids) / area,
        density=max(each.mass / each.volume for each in solids),
        inner=locks.inner,
        dry=locks.dry,
        upper_body=UpperBody.MONOLITHIC,
        first=Side.UPPER if first else Side.LOWER,
        hold_down=hold_down,
    )


@lru_cache(maxsize=256)  # the interfaces of a wall are often alike
def _loads(joint: Joint, rule: Callable[[Joint, Direction, Push], LawCapacity]) -> Floats:
    """V (N) and M (N m) along `ANGLES` and their mirror images, for both pushes, (K, 2)."""
    points = []
    for push, sign in ((Push.PLUS_Y, 1.0), (Push.MINUS_Y, -1.0)):
        for angle in ANGLES.tolist():
            torsion = angle == ANGLES[-1]
            direction = Direction(math.inf if torsion else math.tan(angle))
            found = rule(joint, direction, push)
            points += [(sign * found.shear, found.torque), (sign * found.shear, -found.torque)]
    return np.array(points)


def _half_planes(points: Floats) -> Floats:
    """Normals n, (K, 2), of a convex polygon n p <= 1 in which every line to a point ends.

    Were the points not the corners of a convex polygon, their hull would promise more than some of
    them: it is shrunk until it does not.
    """
    equations = ConvexHull(points).equations  # n p + c <= 0
    normals = equations[:, :2] / -equations[:, 2:]
    return np.asarray(normals / float((points @ normals.T).max(axis=1).min()))
