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

    ``place`` in m: the ``unknowns``, (U,), and behind them the displacements of the nodes,
    ``moved``, (3, N); both share its memory. ``residual`` in N, what the nodes leave of the forces
    on the pieces, (U,). ``force`` of the nodes in N, (3, N). ``tangent``: derivatives of
    `node_tangent` in N/m for the nodes of one face at a time, (6, most nodes of a face).
    """

    place: Floats
    unknowns: Floats
    moved: Floats
    residual: Floats
    force: Floats
    tangent: Floats


def new_point(size: int, start: Integers) -> Point:
    """A point of ``size`` unknowns, to be filled in; ``start``: see `Structure`."""
    most, count = int(np.diff(start).max()), int(start[-1])
    place, shape = np.empty(size + 3 * count), (3, count)
    moved = place[size:].reshape(shape)
    return Point(place, place[:size], moved, np.empty(size), np.empty(shape), np.empty((6, most)))


@compiled
def put_displacements(structure, face, w, moved):
    """Fill in the displacements (m) of the nodes of ``face``, which moves by ``w``, (6,)."""
    here = slice(structure.start[face], structure.start[face + 1])
    p, q = structure.nodes[P, here], structure.nodes[Q, here]
    d0, d1, d2 = moved[0, here], moved[1, here], moved[2, here]
    x, y, z, turn_x, turn_y, turn_z = w[0], w[1], w[2], w[3], w[4], w[5]
    for n in range(len(p)):
        d0[n] = x + q[n] * turn_y - p[n] * turn_z
        d1[n] = y - q[n] * turn_x
        d2[n] = z + p[n] * turn_x


@compiled
def put_forces(structure, slip, whole, moved, force):
    """Fill in the forces (N) of all nodes where they have ``moved`` (m); both (3, N)."""
    nodes = structure.nodes
    normal, shear, friction, given = nodes[NORMAL], nodes[SHEAR], nodes[FRICTION], nodes[GIVEN]
    slip_1, slip_2 = slip[0], slip[1]
    d0, d1, d2 = moved[0], moved[1], moved[2]
    f0, f1, f2 = force[0], force[1], force[2]
    for n in range(len(whole)):
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        f0[n], f1[n], f2[n] = node_force(*node, d0[n], d1[n] - slip_1[n], d2[n] - slip_2[n])


@compiled
def put_tangents(structure, face, slip, whole, moved, tangent):
    """Fill in the derivatives of a face's forces (N/m) from the first column of ``tangent`` on."""
    nodes, here = structure.nodes, slice(structure.start[face], structure.start[face + 1])
    normal, shear, friction = nodes[NORMAL, here], nodes[SHEAR, here], nodes[FRICTION, here]
    given, whole = nodes[GIVEN, here], whole[here]
    slip_1, slip_2 = slip[0, here], slip[1, here]
    d0, d1, d2 = moved[0, here], moved[1, here], moved[2, here]
    t00, t10, t20 = tangent[0], tangent[1], tangent[2]
    t11, t12, t22 = tangent[3], tangent[4], tangent[5]
    for n in range(len(whole)):
        node = normal[n], shear[n], friction[n], given[n], whole[n]
        t00[n], t10[n], t20[n], t11[n], t12[n], t22[n] = node_tangent(
            *node, d0[n], d1[n] - slip_1[n], d2[n] - slip_2[n]
        )


@compiled
def put_slip(structure, slip, whole, here, after):
    """Fill in the slip (m) of all nodes at the point ``here``, from that before; both (2, N)."""
    shear, old_1, old_2 = structure.nodes[SHEAR], slip[0], slip[1]
    d1, d2, f1, f2 = here.moved[1], here.moved[2], here.force[1], here.force[2]
    new_1, new_2 = after[0], after[1]
    for n in range(len(whole)):
        slid_1, slid_2 = d1[n] - f1[n] / shear[n], d2[n] - f2[n] / shear[n]
        new_1[n] = old_1[n] if whole[n] > 0.0 else slid_1
        new_2[n] = old_2[n] if whole[n] > 0.0 else slid_2
