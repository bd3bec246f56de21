"""The static model of a joint in one call: its pieces, and its path to the lowest peak."""

from sidmacib.joint.joint import Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.solution import StaticSolution
from sidmacib.mechanics.static.lowest_peak import lowest_peak


def load_path(
    joint: Joint, loading: Loading, mesh: float, nodes: NodeLayout = NodeLayout.LOBATTO
) -> tuple[Assembly, StaticSolution]:
    """The pieces of ``joint`` on cells of at most ``mesh`` (m), and their path under ``loading``.

    That to the lowest of its peaks. Errors of `sidmacib.joint.loading.posed` and
    `sidmacib.static_peak`.
    """
    problem = posed(joint, loading, mesh, nodes)
    return problem.assembly, lowest_peak(*problem)
