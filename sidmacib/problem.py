"""The input of a model: pieces under loads. Light to import."""

from typing import NamedTuple

from sidmacib.joint import Joint
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.assembly import Assembly, Loads, NodeLayout
from sidmacib.pieces import assemble


class Problem(NamedTuple):
    """Pieces with their faces and nodes, and the loads on them."""

    assembly: Assembly
    loads: Loads


def posed(
    joint: Joint, loading: Loading, mesh: float, nodes: NodeLayout = NodeLayout.LOBATTO
) -> Problem:
    """The pieces of ``joint`` on cells of at most ``mesh`` (m), under ``loading``.

    Errors of `sidmacib.assemble` and `sidmacib.lateral_load`.
    """
    assembly = assemble(joint, mesh, nodes)
    return Problem(assembly, lateral_load(joint, assembly, loading))
