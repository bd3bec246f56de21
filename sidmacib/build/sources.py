"""What is to be built: the two blocks of a joint, or the blocks of a structure's file."""

from pathlib import Path

from sidmacib.joint import Joint
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.structure_file import blocks_and_rows, description_in
from sidmacib.structure.interfaces import NEAR, interfaces
from sidmacib.structure.locks import Locks, Row
from sidmacib.structure.structure import Pair, rows_of
from sidmacib.validation import refused

Found = tuple[list[Block], dict[Pair, Row], float]  # with the tolerance of interfaces
LOWER, UPPER = "lower", "upper"


def blocks_of_file(path: Path) -> Found | None:
    """The blocks of a structure's file and where its locks are; None if it describes a joint.

    ValueError, or `sidmacib.yaml_text.TextError`, if it is neither.
    """
    description = description_in(path)
    if isinstance(description, dict) and "blocks" not in description:
        return None
    return blocks_and_rows(description, path.parent)


def joint_blocks(joint: Joint) -> Found:
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
    rows = rows_of(blocks, {frozenset((LOWER, UPPER)): locks}, interfaces(blocks))
    return blocks, rows, NEAR
