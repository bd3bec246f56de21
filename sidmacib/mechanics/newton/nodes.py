"""All contact nodes of a face at once: forces, their derivatives, and slip.

No node's result is used for another's, and a row of an array has one component of all nodes. So a
processor computes several nodes at a time, with the same digits as one by one.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.newton.compilation import compiled
from sidmacib.mechanics.newton.node_law import node_force, node_tangent

NORMAL, SHEAR, FRICTION, GIVEN, P, Q = range(6)  # rows of `Structure.nodes`


class Point(NamedTuple):
    """Displacements of the pieces, and what they make of the nodes.

    ``unknowns`` in m and ``residual`` in N, what the nodes leave of the forces on the pieces, (U,).
    ``force`` of the nodes in N, (3, N). ``tangent``: derivatives of `node_tangent` in N/m for the
    nodes of one face at a time, (6, most nodes of a face).
    """

    unknowns: Floats
    residual: Floats
    force: Floats
    tangent: Floats


def new_point(size: int, start: Integers) -> Point:
    """A point of ``size`` unknowns, to be filled in; ``start``: see `Structure`."""
    most = int(np.diff(start).max())
    return Point(np.empty(size), np.empty(size), np.empty((3, start[-1])), np.empty((6, most)))


@compiled
def displacement(p, q, w):
    """Displacement (m) of a node at (p, q) when its face moves by ``w``, (6,)."""
    return w[0] + q * w[4] - p * w[5], w[1] - q * w[3], w[2] + p * w[3]


@compiled
def put_forces(structure, face, w, slip, whole, force):
    """Fill in the forces (N) of the nodes of ``face``, which moves by ``w``; ``force``: (3, N)."""
    nodes, here = structure.nodes, slice(structure.start[face], structure.start[face + 1])
    normal, shear, friction = nodes[NORMAL, here], nodes[SHEAR, here], nodes[FRICTION, here]
    given, p, q = nodes[GIVEN, here], nodes[P, here], nodes[Q, here]
    whole, slip_1, slip_2 = whole[here], slip[0, here], slip[1, here]
    f0, f1, f2 = force[0, here], force[1, here], force[2, here]
    motion = w[0], w[1], w[2], w[3], w[4], w[5]
    for n in range(len(p)):
        d0, d1, d2 = displacement(p[n], q[n], motion)
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        f0[n], f1[n], f2[n] = node_force(*node, d0, d1 - slip_1[n], d2 - slip_2[n])


@compiled
def put_tangents(structure, face, w, slip, whole, tangent):
    """Fill in the derivatives of these forces (N/m) from the first column of ``tangent`` on."""
    nodes, here = structure.nodes, slice(structure.start[face], structure.start[face + 1])
    normal, shear, friction = nodes[NORMAL, here], nodes[SHEAR, here], nodes[FRICTION, here]
    given, p, q = nodes[GIVEN, here], nodes[P, here], nodes[Q, here]
    whole, slip_1, slip_2 = whole[here], slip[0, here], slip[1, here]
    t00, t10, t20 = tangent[0], tangent[1], tangent[2]
    t11, t12, t22 = tangent[3], tangent[4], tangent[5]
    motion = w[0], w[1], w[2], w[3], w[4], w[5]
    for n in range(len(p)):
        d0, d1, d2 = displacement(p[n], q[n], motion)
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        t00[n], t10[n], t20[n], t11[n], t12[n], t22[n] = node_tangent(
            *node, d0, d1 - slip_1[n], d2 - slip_2[n]
        )


@compiled
def put_slip(structure, face, w, slip, whole, force, after):
    """Fill in the slip (m) of nodes that carry ``force``, from that before, ``slip``, (2, N)."""
    nodes, here = structure.nodes, slice(structure.start[face], structure.start[face + 1])
    p, q, shear, whole = nodes[P, here], nodes[Q, here], nodes[SHEAR, here], whole[here]
    old_1, old_2, f1, f2 = slip[0, here], slip[1, here], force[1, here], force[2, here]
    new_1, new_2 = after[0, here], after[1, here]
    motion = w[0], w[1], w[2], w[3], w[4], w[5]
    for n in range(len(p)):
        _, d1, d2 = displacement(p[n], q[n], motion)
        slid_1, slid_2 = d1 - f1[n] / shear[n], d2 - f2[n] / shear[n]
        new_1[n] = old_1[n] if whole[n] > 0.0 else slid_1
        new_2[n] = old_2[n] if whole[n] > 0.0 else slid_2
