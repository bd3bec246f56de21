"""Joints under load, as tests of models pose them."""

from sidmacib import Direction, Joint, NodeLayout
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.problem import Problem


def loaded(
    joint: Joint,
    e_over_a: float = 0.0,
    mesh: float = 0.03,
    nodes: NodeLayout = NodeLayout.CENTRES,
    push: Push = Push.PLUS_Y,
) -> Problem:
    return posed(joint, Loading(Direction(e_over_a), push=push), mesh, nodes)
