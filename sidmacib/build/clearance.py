"""What locks lose so that they go into the hollows of the other block."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import Block
from sidmacib.structure.cutting import Plane, cut
from sidmacib.structure.locks import LockPart, Row
from sidmacib.validation import refused

CHORDS = 8  # of a quarter of a circle
ON = 1e-6  # over a lock's size: how far a corner may be from a wall that it lies on


@dataclass(frozen=True)
class Clearance:
    """Gaps between a lock and the other block, in m.

    ``sides``: at its flanks and ends; two neighbouring locks give way by half of it each.
    ``heads``: between its head and the bottom of the hollow; 0, as the joint bears there.
    ``radius``: of a lock's upright edges in corners of a hollow, which a mill leaves round.
    """

    sides: float = 0.0
    heads: float = 0.0
    radius: float = 0.0


NO_GAPS = Clearance()


def relieved(
    row: Row,
    part: LockPart,
    facing: Sequence[LockPart],
    gaps: Clearance,
    side: float,
    *,
    own: bool,
) -> tuple[Block | None, bool]:
    """The solid of a ``part`` of a lock, less ``gaps``, None if nothing is left; whether rounded.

    ``facing``: the parts of the same lock in the other block, beyond the interface. ``side``: -1 of
    the block below the interface, 1 of that above. ``own``: whether this block is the lock's own.
    ValueError for a radius that is more than half of a side of the lock.
    """
    walls = list(_walls(row, part, facing, gaps, own=own))
    ends = list(walls) if gaps.sides else []
    normal = side * row.interface.axes[0]
    if gaps.heads and not own:
        ends.append((row.middle + (row.locks.height / 2 - gaps.heads) * normal, normal))
    lock = _within(part.solid, ends)
    if lock is None or own or not gaps.radius:
        return lock, False
    chords = [*_chords(row, lock, walls, gaps.radius)]
    return _within(lock, chords), bool(chords)


def _within(block: Block, planes: Sequence[Plane]) -> Block | None:
    """What is left of a ``block`` inside all ``planes``; None if nothing is."""
    left: Block | None = block
    for point, outward in planes:
        left = left and cut(left, point, outward)[0]
    return left


def _walls(
    row: Row, part: LockPart, facing: Sequence[LockPart], gaps: Clearance, *, own: bool
) -> Iterator[Plane]:
    """The planes, with outward normals, at which a part of a lock ends beside the other block.

    At the flanks to other locks, and where the other block is beside it.
    """
    low, high = row.edges[part.number : part.number + 2]
    if part.number > 0:
        yield row.middle + (low + gaps.sides / 2) * row.across, -row.across
    if part.number < row.locks.count - 1:
        yield row.middle + (high - gaps.sides / 2) * row.across, row.across
    # In its own block a lock keeps what it grows from, and elsewhere runs straight up.
    own_sides = [point for point, _ in part.beside] if own else []
    for point, outward in (plane for each in ([part], facing)[own] for plane in each.beside):
        if not any(np.array_equal(point, each) for each in own_sides):
            yield point - gaps.sides * outward, outward


def _chords(row: Row, lock: Block, walls: Sequence[Plane], radius: float) -> Iterator[Plane]:
    """Planes that cut the edges of a ``lock`` between two ``walls`` along chords of an arc."""
    plan = np.array([row.run, row.across])
    flat = (lock.places - row.middle) @ plan.T
    outline = flat[ConvexHull(flat).vertices]
    for corner, before, after in zip(
        outline, np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0), strict=True
    ):
        sides = [
            plan @ outward
            for other in (before, after)
            for point, outward in walls
            if _on(plan, row, (corner, other), point, outward, ON * lock.size)
        ]
        if len(sides) != 2:
            continue
        shortest = min(float(np.linalg.norm(corner - other)) for other in (before, after))
        angle = math.acos(float(np.clip(sides[0] @ sides[1], -1.0, 1.0)))
        if not 2.0 * radius * math.tan(angle / 2.0) < shortest:
            most = 0.5 * shortest / math.tan(angle / 2.0)
            raise refused("radius", radius, f"less than {most:.4g} m, half of a lock's side")
        middle = corner + np.linalg.solve(np.array(sides), [-radius, -radius])
        step = angle / CHORDS
        for k in range(CHORDS):
            share = (k + 0.5) * step
            both = math.sin(angle - share) * sides[0] + math.sin(share) * sides[1]
            outward = both @ plan / math.sin(angle)
            yield row.middle + middle @ plan + radius * math.cos(step / 2) * outward, outward


def _on(
    plan: Floats, row: Row, ends: tuple[Floats, Floats], point: Floats, outward: Floats, near: float
) -> bool:
    """Whether an edge of an outline, given by its ``ends``, lies on a wall."""
    normal, place = plan @ outward, plan @ (point - row.middle)
    return all(abs(float((end - place) @ normal)) <= near for end in ends)
