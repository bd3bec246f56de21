"""Faces with contact nodes: the forces on the pieces, and their derivatives.

The unknowns (m) are the displacements of the free pieces, so their number does not depend on the
mesh, in the order that `sidmacib.mechanics.rigid.ordering` finds. A piece has three displacements
of its centroid and three rotations, from ``ContactFaces.begin`` on. Rotations are multiplied by the
assembly's length and moments divided by it: forces are in N and stiffnesses in N/m.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import all_bonded, put_forces, put_tangents


class ContactFaces(NamedTuple):
    """Pieces and faces with their nodes, the same along a path.

    The motion of a face, w, is the displacement of the piece below relative to the piece above, at
    the face's middle: three translations along the face's normal and tangents and three rotations
    about them. A node at place (p, q) of its face moves by delta = (w0 + q w4 - p w5,
    w1 - q w3, w2 + p w3).

    ``law``: of the nodes, see `sidmacib.mechanics.contact_law.kernels`, (4, N). ``places``: p and q
    of each along the tangents, from the face's middle, over the assembly's length, (2, N).
    ``start``: first node of each face, then the number of nodes, (F + 1,). ``axes``: normal and
    tangents of each face, (F, 3, 3). ``levers``: from the centroid of either piece to the face's
    middle, over the length, (F, 2, 3). ``begin``: first unknown of the pieces below and above each
    face, -1 for a fixed one, (F, 2).
    ``bonded``: forces on the two pieces by the unknowns of either while all bonds of a face are
    whole (N/m), see `whole_faces`, (F, 2, 2, 6, 6).
    ``stiff``: whether nodes add up their own steps to equilibrium. If they follow from the pieces'
    displacements, a stiff face between pieces that move far carries the rounding of a difference.
    The ``inner`` unknowns come first; those coupled by the stiffness are at most ``band`` apart.
    The ``outer`` unknowns follow and may be coupled to all others.
    """

    law: Floats
    places: Floats
    start: Integers
    axes: Floats
    levers: Floats
    begin: Integers
    bonded: Floats
    stiff: bool
    inner: int
    outer: int
    band: int


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
def norm(vector):
    """Euclidean norm."""
    square = 0.0
    for value in vector:
        square += value**2
    return np.sqrt(square)


@compiled
def cross(one, other):
    """Cross product of two triples."""
    return (
        one[1] * other[2] - one[2] * other[1],
        one[2] * other[0] - one[0] * other[2],
        one[0] * other[1] - one[1] * other[0],
    )


@compiled
def face_motion(contacts, face, unknowns, w):
    """Motion ``w`` (6,) of the middle of ``face``: of the piece below relative to that above."""
    x = y = z = turn_x = turn_y = turn_z = 0.0
    for side in range(2):
        i = contacts.begin[face, side]
        if i >= 0:
            sign, lever = 1.0 - 2.0 * side, contacts.levers[face, side]
            a, b, c = cross((unknowns[i + 3], unknowns[i + 4], unknowns[i + 5]), lever)
            x += sign * (unknowns[i] + a)
            y += sign * (unknowns[i + 1] + b)
            z += sign * (unknowns[i + 2] + c)
            turn_x += sign * unknowns[i + 3]
            turn_y += sign * unknowns[i + 4]
            turn_z += sign * unknowns[i + 5]
    for k in range(3):
        axis = contacts.axes[face, k]
        w[k] = axis[0] * x + axis[1] * y + axis[2] * z
        w[3 + k] = axis[0] * turn_x + axis[1] * turn_y + axis[2] * turn_z


@compiled
def subtract_force(contacts, face, force, residual):
    """Subtract force and moment (6,) of ``face`` from those on its two pieces in ``residual``."""
    axes = contacts.axes[face]
    x, y, z = together(axes, force[0], force[1], force[2])
    turn_x, turn_y, turn_z = together(axes, force[3], force[4], force[5])
    for side in range(2):
        i = contacts.begin[face, side]
        if i >= 0:
            sign = 1.0 - 2.0 * side
            a, b, c = cross(contacts.levers[face, side], (x, y, z))
            residual[i] -= sign * x
            residual[i + 1] -= sign * y
            residual[i + 2] -= sign * z
            residual[i + 3] -= sign * (turn_x + a)
            residual[i + 4] -= sign * (turn_y + b)
            residual[i + 5] -= sign * (turn_z + c)


@compiled
def together(axes, a, b, c):
    """The sum of ``a``, ``b`` and ``c`` times the rows of ``axes``."""
    return (
        a * axes[0, 0] + b * axes[1, 0] + c * axes[2, 0],
        a * axes[0, 1] + b * axes[1, 1] + c * axes[2, 1],
        a * axes[0, 2] + b * axes[1, 2] + c * axes[2, 2],
    )


@compiled
def move_nodes(contacts, place):
    """Fill in the displacements of the nodes, which follow the unknowns in ``place`` (m)."""
    w, size = np.empty(6), contacts.inner + contacts.outer
    moved = place[size:].reshape((3, contacts.places.shape[1]))
    for face in range(len(contacts.begin)):
        face_motion(contacts, face, place, w)
        put_displacements(contacts, face, w, moved)


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


@compiled
def unbalanced(contacts, slip, whole, target, here):
    """Fill in forces and residual of ``here`` at its place, for ``target`` (N) on the pieces.

    Returns the norm of the residual (N).
    """
    on_face = np.empty(6)
    for i, value in enumerate(target):
        here.residual[i] = value
    put_forces(contacts.law, slip, whole, here.moved, here.force)
    for face in range(len(contacts.begin)):
        resultant(contacts, face, here.force, on_face)
        subtract_force(contacts, face, on_face, here.residual)
    return norm(here.residual)


@compiled
def resultant(contacts, face, force, on_face):
    """Put force and moment about the middle of ``face`` into ``on_face``, (6,)."""
    p_of, q_of = contacts.places[0], contacts.places[1]
    x = y = z = about_x = about_y = about_z = 0.0
    for node in range(contacts.start[face], contacts.start[face + 1]):
        p, q = p_of[node], q_of[node]
        f0, f1, f2 = force[0, node], force[1, node], force[2, node]
        x += f0
        y += f1
        z += f2
        about_x += p * f2 - q * f1
        about_y += q * f0
        about_z -= p * f0
    put(on_face, x, y, z, about_x, about_y, about_z)


@compiled
def face_stiffness(contacts, face, tangent, k):
    """Put the derivative of the face's forces by its motion into ``k``, (6, 6).

    ``tangent``: of its nodes, see `put_tangents`. Returns whether any of them resists.
    """
    # Sums over nodes, also times p and q: normal forces by normal displacements, shear forces by
    # normal displacements where nodes slide, shear forces by shear. Turns are about the normal.
    n = n_p = n_q = n_pp = n_pq = n_qq = 0.0
    y = y_p = y_q = z = z_p = z_q = turn = turn_p = turn_q = 0.0
    yy = yz = zz = y_turn = z_turn = turns = 0.0
    first = contacts.start[face]
    for node in range(first, contacts.start[face + 1]):
        p, q, i = contacts.places[0, node], contacts.places[1, node], node - first
        t00, t10, t20 = tangent[0, i], tangent[1, i], tangent[2, i]
        t11, t12, t22 = tangent[3, i], tangent[4, i], tangent[5, i]
        if t00 == 0.0 and t11 == 0.0 and t22 == 0.0:  # open
            continue
        n += t00
        n_p += p * t00
        n_q += q * t00
        n_pp += p * p * t00
        n_pq += p * q * t00
        n_qq += q * q * t00
        if t10 != 0.0 or t20 != 0.0:
            t30 = p * t20 - q * t10
            y += t10
            y_p += p * t10
            y_q += q * t10
            z += t20
            z_p += p * t20
            z_q += q * t20
            turn += t30
            turn_p += p * t30
            turn_q += q * t30
        t13, t23 = p * t12 - q * t11, p * t22 - q * t12
        yy += t11
        yz += t12
        zz += t22
        y_turn += t13
        z_turn += t23
        turns += p * t23 - q * t13
    put(k[0], n, 0.0, 0.0, 0.0, n_q, -n_p)
    put(k[1], y, yy, yz, y_turn, y_q, -y_p)
    put(k[2], z, yz, zz, z_turn, z_q, -z_p)
    put(k[3], turn, y_turn, z_turn, turns, turn_q, -turn_p)
    put(k[4], n_q, 0.0, 0.0, 0.0, n_qq, -n_pq)
    put(k[5], -n_p, 0.0, 0.0, 0.0, -n_pq, n_pp)
    return n > 0.0 or yy > 0.0 or zz > 0.0


@compiled
def put(row, a, b, c, d, e, f):
    """Fill a ``row`` of six numbers."""
    row[0], row[1], row[2], row[3], row[4], row[5] = a, b, c, d, e, f


@compiled
def tangent_stiffness(contacts, slip, whole, here, floor, matrix):
    """Put the derivative of the nodes' forces on the pieces into ``matrix``.

    ``here``: where, by its place. ``floor`` (N/m) is added to the diagonal: it keeps pieces that
    nothing holds during an iteration from flying off, and changes no equilibrium.
    """
    k, blocks = np.empty((6, 6)), np.empty((2, 2, 6, 6))
    matrix.band[:], matrix.right[:], matrix.below[:] = 0.0, 0.0, 0.0
    matrix.band[:, contacts.band] = floor
    for i in range(contacts.outer):
        matrix.below[i, contacts.inner + i] = floor
    for face in range(len(contacts.begin)):
        if is_whole(contacts, face, whole):
            add_face(contacts, matrix, face, contacts.bonded[face])
            continue
        first, last = contacts.start[face], contacts.start[face + 1]
        put_tangents(contacts.law, first, last, slip, whole, here.moved, here.tangent)
        if face_stiffness(contacts, face, here.tangent, k):
            by_pieces(contacts, face, k, blocks)
            add_face(contacts, matrix, face, blocks)


@compiled
def is_whole(contacts, face, whole):
    """Whether all bonds of ``face`` are whole: its stiffness then does not depend on its motion."""
    for node in range(contacts.start[face], contacts.start[face + 1]):  # noqa: SIM110 (compiled)
        if whole[node] != 1.0:
            return False
    return True


@compiled
def whole_faces(contacts, here):
    """Put the stiffness of each face with all bonds whole into ``contacts.bonded``.

    ``here``: a point, which is overwritten.
    """
    k = np.empty((6, 6))
    slip, whole = all_bonded(contacts.places.shape[1])
    here.place[:] = 0.0
    for face in range(len(contacts.begin)):
        first, last = contacts.start[face], contacts.start[face + 1]
        put_tangents(contacts.law, first, last, slip, whole, here.moved, here.tangent)
        face_stiffness(contacts, face, here.tangent, k)
        by_pieces(contacts, face, k, contacts.bonded[face])


@compiled
def by_pieces(contacts, face, k, blocks):
    """Turn the stiffness ``k`` by the face's motion into ``blocks`` by the two pieces' unknowns."""
    axes, rows, columns = contacts.axes[face], np.empty((6, 6)), np.empty((6, 6))
    for i in range(6):
        rows[i, 0], rows[i, 1], rows[i, 2] = together(axes, k[i, 0], k[i, 1], k[i, 2])
        rows[i, 3], rows[i, 4], rows[i, 5] = together(axes, k[i, 3], k[i, 4], k[i, 5])
    for j in range(6):
        columns[0, j], columns[1, j], columns[2, j] = together(
            axes, rows[0, j], rows[1, j], rows[2, j]
        )
        columns[3, j], columns[4, j], columns[5, j] = together(
            axes, rows[3, j], rows[4, j], rows[5, j]
        )
    for right in range(2):
        if contacts.begin[face, right] >= 0:
            moved, lever = rows, contacts.levers[face, right]
            for i in range(6):
                a, b, c = cross(lever, (columns[i, 0], columns[i, 1], columns[i, 2]))
                moved[i, 0], moved[i, 1], moved[i, 2] = columns[i, 0], columns[i, 1], columns[i, 2]
                moved[i, 3], moved[i, 4] = columns[i, 3] + a, columns[i, 4] + b
                moved[i, 5] = columns[i, 5] + c
            for left in range(2):
                if contacts.begin[face, left] >= 0:
                    sign, block = 1.0 if left == right else -1.0, blocks[left, right]
                    lever = contacts.levers[face, left]
                    for j in range(6):
                        a, b, c = cross(lever, (moved[0, j], moved[1, j], moved[2, j]))
                        block[0, j], block[1, j] = sign * moved[0, j], sign * moved[1, j]
                        block[2, j], block[3, j] = sign * moved[2, j], sign * (moved[3, j] + a)
                        block[4, j] = sign * (moved[4, j] + b)
                        block[5, j] = sign * (moved[5, j] + c)


@compiled
def add_face(contacts, matrix, face, blocks):
    """Add ``blocks`` of the pieces below and above ``face``, (2, 2, 6, 6), to ``matrix``."""
    inner, band, border, below = contacts.inner, matrix.band, matrix.right, matrix.below
    for left in range(2):
        row = contacts.begin[face, left]
        for right in range(2):
            column = contacts.begin[face, right]
            if row < 0 or column < 0:
                continue
            # A loop each, not one with a choice inside: several times faster.
            if row >= inner:
                for i in range(6):
                    for j in range(6):
                        below[row - inner + i, column + j] += blocks[left, right, i, j]
            elif column >= inner:
                for i in range(6):
                    for j in range(6):
                        border[row + i, column - inner + j] += blocks[left, right, i, j]
            else:
                first = contacts.band + column - row
                for i in range(6):
                    for j in range(6):
                        band[row + i, first - i + j] += blocks[left, right, i, j]
