"""Joints under load, as tests of models pose them."""

from sidmacib import Direction, Joint, NodeLayout
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.problem import Problem

# Locks, published peak (N) in pure shear and lock weights, the first two swapped; and how near a
# peak must be.
PUBLISHED = [
    (3, 240.76, [0.77, 0.99, 0.0], 0.035),
    (5, 408.26, [0.57, 0.99, 0.68, 0.68, 0.0], 0.02),
]


def loaded(
    joint: Joint,
    e_over_a: float = 0.0,
    mesh: float = 0.03,
    nodes: NodeLayout = NodeLayout.CENTRES,
    push: Push = Push.PLUS_Y,
) -> Problem:
    return posed(joint, Loading(Direction(e_over_a), push=push), mesh, nodes)
