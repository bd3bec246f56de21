"""Joints under load, as tests of models pose them."""

from typing import Any

from sidmacib import Direction, Joint, NodeLayout, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.problem import Problem

# Locks, published peak (N) in pure shear and lock weights, the first two swapped; and how near a
# peak must be.
PUBLISHED = [
    (3, 240.76, [0.77, 0.99, 0.0], 0.035),
    (5, 408.26, [0.57, 0.99, 0.68, 0.68, 0.0], 0.02),
]


def sawn(locks: int, *sizes: float, **given: Any) -> Joint:
    """A joint whose upper block is cut into columns, as in the paper, unless it is ``given``."""
    return Joint(locks, *sizes, **{"upper_body": UpperBody.COLUMNS, **given})


def loaded(
    joint: Joint,
    e_over_a: float = 0.0,
    mesh: float = 0.03,
    nodes: NodeLayout = NodeLayout.CENTRES,
    push: Push = Push.PLUS_Y,
) -> Problem:
    return posed(joint, Loading(Direction(e_over_a), push=push), mesh, nodes)
