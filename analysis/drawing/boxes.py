"""The joint's pieces as drawings show them: boxes, with their block and their lock."""

from collections.abc import Iterator
from dataclasses import dataclass

from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import Vector
from sidmacib.pieces import PLATE, cut_pieces, lock_name, upper_block

MM = 1e3  # of a m


@dataclass(frozen=True)
class Outline:
    """A piece from corner ``low`` to ``high`` (mm); ``lock``: its number, None if it is none."""

    lock: int | None
    upper: bool
    low: Vector
    high: Vector


def outlines(joint: Joint) -> Iterator[Outline]:
    """All pieces but the plate: the lower body, locks, upper body."""
    above, locks = set(upper_block(joint)), {lock_name(n): n for n in joint.numbers}
    for piece in cut_pieces(joint):
        if piece.name != PLATE:
            low, high = (_in_mm(corner) for corner in (piece.low, piece.high))
            yield Outline(locks.get(piece.name), piece.name in above, low, high)


def _in_mm(corner: Vector) -> Vector:
    x, y, z = (MM * value for value in corner)
    return x, y, z
