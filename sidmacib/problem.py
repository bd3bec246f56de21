"""The input of a model: pieces under loads. Light to import."""

from typing import NamedTuple

from sidmacib.mechanics.assembly import Assembly, Loads


class Problem(NamedTuple):
    """Pieces with their faces and nodes, and the loads on them."""

    assembly: Assembly
    loads: Loads
