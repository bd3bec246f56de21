"""The static model of a joint in one call: its pieces, and its path to the peak."""

from sidmacib.joint import Joint
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static.model import static_peak
from sidmacib.pieces import assemble


def load_path(
    joint: Joint, loading: Loading, mesh: float, nodes: NodeLayout = NodeLayout.LOBATTO
) -> tuple[Assembly, StaticSolution]:
    """The pieces of ``joint`` on cells of at most ``mesh`` (m), and their path under ``loading``.

    Errors of `sidmacib.assemble`, `sidmacib.lateral_load` and `sidmacib.static_peak`.
    """
    assembly = assemble(joint, mesh, nodes)
    return assembly, static_peak(assembly, lateral_load(joint, assembly, loading))
