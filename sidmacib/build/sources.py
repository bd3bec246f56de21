"""What is to be built: the two blocks of a joint, or the blocks of a structure's file."""

from sidmacib.joint.joint import Joint
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.locks import Locks, Row
from sidmacib.structure.structure import Pair, rows_of
from sidmacib.validation import refused

LOWER, UPPER = "lower", "upper"


def joint_blocks(joint: Joint) -> tuple[list[Block], dict[Pair, Row]]:
    """The lower and the upper block of ``joint``, and where its locks are.

    The lower body, whose thickness no model needs, is as high as the upper one; columns are parts
    of the upper block. ValueError for locks of a density of their own.
    """
    for lock in joint.numbers:
        if (density := joint.lock_density(lock)) != joint.density:
            raise refused(f"different: lock {lock}: density", density, "that of its block")
    x, width, middle = joint.a / 2, joint.total_width, joint.h / 2
    blocks = [
        box(LOWER, (-x, 0.0, -joint.H), (x, width, middle), joint.density),
        box(UPPER, (-x, 0.0, middle), (x, width, joint.h + joint.H), joint.density),
    ]
    locks = Locks(
        joint.locks,
        joint.h,
        row=(0.0, 1.0, 0.0),
        first=str(joint.first),
        widths=tuple(map(joint.width, joint.numbers)),
    )
    return blocks, rows_of(blocks, {frozenset((LOWER, UPPER)): locks}, interfaces(blocks))
