"""Where all contact nodes are, and how a face moves its own."""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.compilation import compiled


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
    """A point of ``size`` unknowns, to be filled in; ``start``: see `ContactFaces`."""
    most, count = int(np.diff(start).max()), int(start[-1])
    place, shape = np.empty(size + 3 * count), (3, count)
    moved = place[size:].reshape(shape)
    return Point(place, place[:size], moved, np.empty(size), np.empty(shape), np.empty((6, most)))


@compiled
def put_displacements(contacts, face, w, moved):
    """Fill in the displacements (m) of the nodes of ``face``, which moves by ``w``, (6,)."""
    here = slice(contacts.start[face], contacts.start[face + 1])
    p, q = contacts.places[0, here], contacts.places[1, here]
    d0, d1, d2 = moved[0, here], moved[1, here], moved[2, here]
    x, y, z, turn_x, turn_y, turn_z = w[0], w[1], w[2], w[3], w[4], w[5]
    for n in range(len(p)):
        d0[n] = x + q[n] * turn_y - p[n] * turn_z
        d1[n] = y - q[n] * turn_x
        d2[n] = z + p[n] * turn_x
