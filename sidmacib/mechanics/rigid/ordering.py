"""An order of an assembly's unknowns in which coupled unknowns are close together.

Pieces that touch few others give the stiffness a narrow band. A piece that touches very many, such
as a monolithic body above all locks, would make the band as wide as the matrix; it goes into a
border behind the band.

`scipy.sparse.csgraph.reverse_cuthill_mckee` breaks ties in another way, as for three locks below
one body, which changes the order of elimination and so the last digits of results.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sidmacib.mechanics.assembly import Integers
from sidmacib.mechanics.springs import RIGID, Springs

Graph = dict[int, set[int]]  # pieces and those that they touch


@dataclass(frozen=True)
class Ordering:
    """An order of the free pieces, see `sidmacib.mechanics.newton.faces.Structure`.

    ``begin``: first unknown of each piece, (P,). ``inner``, ``outer``: numbers of unknowns in the
    band and behind it. ``band``: largest distance between coupled inner unknowns.
    """

    begin: Integers
    inner: int
    outer: int
    band: int

    @property
    def work(self) -> int:
        """Approximate number of multiplications in one elimination."""
        return self.inner * (self.band + self.outer) ** 2 + self.outer**3


def ordering(springs: Springs) -> Ordering:
    """The order with the least work: pieces go into the border as long as that saves any."""
    pairs = tuple(map(tuple, springs.piece.tolist()))
    return _least_work(len(springs.unknowns) - 1, pairs)


@lru_cache(maxsize=32)  # joints with as many locks differ in sizes only
def _least_work(pieces: int, pairs: tuple[tuple[int, ...], ...]) -> Ordering:
    """`ordering` of that many free ``pieces``; ``pairs``: those that touch, -1 for fixed ones."""
    graph = _graph(pieces, pairs)
    by_contacts = sorted(graph, key=lambda piece: -len(graph[piece]))
    best = _bordered(graph, [])
    for count in range(1, len(by_contacts)):
        other = _bordered(graph, by_contacts[:count])
        if other.work >= best.work:
            break
        best = other
    return best


def _graph(pieces: int, pairs: tuple[tuple[int, ...], ...]) -> Graph:
    """The free pieces and the free pieces that they touch."""
    graph: Graph = {piece: set() for piece in range(pieces)}
    for below, above in pairs:
        if below >= 0 and above >= 0:
            graph[below].add(above)
            graph[above].add(below)
    return graph


def _bordered(graph: Graph, border: list[int]) -> Ordering:
    inside = {piece: graph[piece].difference(border) for piece in graph if piece not in border}
    order = [*_cuthill_mckee(inside), *border]
    begin = np.empty(len(order), dtype=np.int64)
    begin[order] = RIGID * np.arange(len(order))
    first = begin.tolist()
    apart = [first[one] - first[other] for one in inside for other in inside[one]]
    band = max(apart, default=0) + RIGID - 1
    return Ordering(begin, RIGID * len(inside), RIGID * len(border), band)


def _cuthill_mckee(graph: Graph) -> list[int]:
    """Pieces in the order of Cuthill and McKee (1969), from an end of each connected part."""
    order: list[int] = []
    seen: set[int] = set()
    for piece in sorted(graph, key=lambda piece: len(graph[piece])):
        if piece not in seen:
            part = _breadth_first(graph, _breadth_first(graph, piece)[-1])
            order += part
            seen.update(part)
    return order


def _breadth_first(graph: Graph, start: int) -> list[int]:
    """The pieces connected to ``start``, nearest first, among equals those with few neighbours."""
    order, seen = [start], {start}
    for piece in order:  # which grows meanwhile
        new = sorted(graph[piece] - seen, key=lambda other: (len(graph[other]), other))
        order += new
        seen.update(new)
    return order
