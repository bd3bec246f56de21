"""Groups of things that pairs of them connect."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sidmacib.mechanics.assembly import Integers


def grouped(count: int, pairs: Integers) -> Integers:
    """The group, from 0, of each of ``count`` things that ``pairs``, (K, 2), connect; (count,)."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
