"""An order of an assembly's unknowns that keeps those that share a stiffness close together.

Pieces that touch few others make a band. One that touches very many, such as a body in one piece
above all locks, would make it as wide as the matrix and goes into a border behind it.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Integers
from sidmacib.mechanics.springs import Springs

Graph = dict[int, set[int]]  # pieces and those that they touch


@dataclass(frozen=True)
class Ordering:
    """An order of the free pieces, see `sidmacib.mechanics.newton.Structure`.

    ``begin``: where the unknowns of each piece begin, (P,). ``inner``: number of unknowns in the
    band, ``outer``: behind it. ``band``: how far inner unknowns that share a stiffness are apart.
    """

    begin: Integers
    inner: int
    outer: int
    band: int

    @property
    def work(self) -> int:
        """Multiplications in one elimination, about."""
        return self.inner * (self.band + self.outer) ** 2 + self.outer**3


def ordering(springs: Springs) -> Ordering:
    """The order with least work: pieces go into the border as long as that saves any."""
    graph = _graph(springs)
    most = sorted(graph, key=lambda piece: -len(graph[piece]))
    best = _bordered(springs, graph, [])
    for count in range(1, len(most)):
        other = _bordered(springs, graph, most[:count])
        if other.work >= best.work:
            break
        best = other
    return best


def _graph(springs: Springs) -> Graph:
    """The free pieces."""
    graph: Graph = {piece: set() for piece in range(len(springs.unknowns) - 1)}
    for below, above in springs.piece.tolist():
        if below >= 0 and above >= 0:
            graph[below].add(above)
            graph[above].add(below)
    return graph


def _bordered(springs: Springs, graph: Graph, border: list[int]) -> Ordering:
    inside = {piece: graph[piece].difference(border) for piece in graph if piece not in border}
    order = [*_cuthill_mckee(inside), *border]
    size = np.diff(springs.unknowns)[order]
    end = np.cumsum(size)
    begin = np.empty(len(order), dtype=np.int64)
    begin[order] = end - size
    first, last = dict(enumerate(begin.tolist())), dict(zip(order, end.tolist(), strict=True))
    apart = [last[one] - first[other] - 1 for one in inside for other in (one, *inside[one])]
    inner = int(size[: len(inside)].sum())
    return Ordering(begin, inner, int(size.sum()) - inner, max(apart, default=0))


def _cuthill_mckee(graph: Graph) -> list[int]:
    """Pieces in the order of Cuthill and McKee (1969), from an end of every connected part."""
    order: list[int] = []
    seen: set[int] = set()
    for piece in sorted(graph, key=lambda piece: len(graph[piece])):
        if piece not in seen:
            part = _breadth_first(graph, _breadth_first(graph, piece)[-1])
            order += part
            seen.update(part)
    return order


def _breadth_first(graph: Graph, start: int) -> list[int]:
    """The pieces connected to ``start``, neighbours first, those with few neighbours before."""
    found, seen = [start], {start}
    for piece in found:  # grows on the way
        new = sorted(graph[piece] - seen, key=lambda other: (len(graph[other]), other))
        found += new
        seen.update(new)
    return found
