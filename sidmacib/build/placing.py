"""In which order and direction solids can be put where they are: from the faces that touch."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from sidmacib.structure.blocks import Block, solids_of
from sidmacib.structure.interfaces import close, mean_size
from sidmacib.structure.locks import Row
from sidmacib.structure.placing import Order, placing_order
from sidmacib.structure.structure import Pair, parts_of


def order_of(blocks: Sequence[Block], rows: Mapping[Pair, Row], near: float) -> Order:
    """An order of placing ``blocks`` with the locks of ``rows``, condensed or not.

    Arguments and errors of `sidmacib.build.solids`. Fixed blocks are there before.
    """
    number = {block.name: k for k, block in enumerate(blocks)}
    cut = {
        pair: replace(row, locks=replace(row.locks, condensed=None)) for pair, row in rows.items()
    }
    parts = [
        (number[part.owner], solid)
        for part in parts_of(blocks, cut)
        for solid in solids_of(part.piece)
    ]
    owners, every = zip(*parts, strict=True)
    contacts = [
        (owners[each.below], owners[each.above], each.axes[:1])
        for _, each in close(every, near * mean_size(blocks))
        if owners[each.below] != owners[each.above]
    ]
    free = {k: float(block.centre[2]) for k, block in enumerate(blocks) if not block.fixed}
    return placing_order(free, contacts)
