"""The pieces of a joint as boxes, for drawings."""

from collections.abc import Iterator
from dataclasses import dataclass

from sidmacib.joint.joint import Joint
from sidmacib.joint.pieces import PLATE, cut_pieces, lock_name, upper_block
from sidmacib.mechanics.assembly import Vector

MM = 1e3  # of a m


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
            low, high = (_in_mm(corner) for corner in (piece.low, piece.high))
            yield Box(locks.get(piece.name), piece.name in above, low, high)


def _in_mm(corner: Vector) -> Vector:
    x, y, z = (MM * value for value in corner)
    return x, y, z
