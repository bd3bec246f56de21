"""The order of the free pieces in the stiffness of an assembly.

Unknowns are ordered so that coupled ones are close together. Pieces that touch few others give the
stiffness a narrow band. A piece that touches very many, such as a monolithic body above all locks,
would make the band as wide as the matrix; it goes into a border behind the band.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Integers
from sidmacib.mechanics.equilibrium import RIGID

Graph = dict[int, set[int]]  # pieces and those that they touch


@dataclass(frozen=True)
class Ordering:
    """An order of the free pieces, see `sidmacib.mechanics.newton.faces.ContactFaces`.

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


def ordering(assembly: Assembly) -> Ordering:
    """The order with the least work: pieces go into the border as long as that saves any."""
    free = sum(not piece.fixed for piece in assembly.pieces)
    return _least_work(free, tuple(map(tuple, ends_of(assembly)[1].tolist())))


def ends_of(assembly: Assembly) -> tuple[Integers, Integers]:
    """Pieces below and above each face, (F, 2), and these counted among free ones, -1 for fixed."""
    fixed = np.array([piece.fixed for piece in assembly.pieces])
    ends = np.array([(face.below, face.above) for face in assembly.faces])
    return ends, np.where(fixed, -1, np.cumsum(~fixed) - 1)[ends]


@lru_cache(maxsize=32)  # joints with as many locks differ in sizes only
def _least_work(pieces: int, pairs: tuple[tuple[int, ...], ...]) -> Ordering:
    """`ordering` of that many free ``pieces``; ``pairs``: those that touch, -1 for fixed ones."""
    graph: Graph = {piece: set() for piece in range(pieces)}  # and the free ones that they touch
    for below, above in pairs:
        if below >= 0 and above >= 0:
            graph[below].add(above)
            graph[above].add(below)
    by_contacts = sorted(graph, key=lambda piece: -len(graph[piece]))
    best = _bordered(graph, [])
    for count in range(1, len(by_contacts)):
        other = _bordered(graph, by_contacts[:count])
        if other.work >= best.work:
            break
        best = other
    return best


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
    """Pieces in the order of Cuthill and McKee (1969), from an end of each connected part.

    `scipy.sparse.csgraph.reverse_cuthill_mckee` breaks ties in another way, as for three locks
    below one body, which changes the order of elimination and so the last digits of results.
    """
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
