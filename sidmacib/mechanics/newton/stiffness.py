"""Derivatives of the forces on the pieces by their motions.

Of the nodes' forces as they move, and of forces that stay as frames and arms turn with the pieces.
"""

# mypy: allow-untyped-defs

import numpy as np

from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import all_bonded, put_tangents
from sidmacib.mechanics.newton.pressed import place, pressed_stiffness
from sidmacib.mechanics.newton.vectors import cross, put, together


@compiled
def face_stiffness(contacts, face, along, tangent, k):
    """Put the derivative of the face's forces by its motion into ``k``, (6, 6).

    ``along``: see `sidmacib.mechanics.newton.faces.Point`; ``tangent``: of its nodes, see
    `put_tangents`. Nodes with a stiffness are next to the plane of the face.
    """
    # Sums over nodes, also times p and q: normal forces by normal displacements, shear forces by
    # normal displacements where nodes slide, shear forces by shear. Turns are about the normal.
    n = n_p = n_q = n_pp = n_pq = n_qq = 0.0
    y = y_p = y_q = z = z_p = z_q = turn = turn_p = turn_q = 0.0
    yy = yz = zz = y_turn = z_turn = turns = 0.0
    first = contacts.start[face]
    for node in range(first, contacts.start[face + 1]):
        p, q, i = contacts.places[0, node], contacts.places[1, node], node - first
        _, p, q = place(along, p, q)
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


@compiled
def tangent_stiffness(contacts, slip, whole, target, here, floor, matrix, rise):
    """Put the derivative of the forces on the pieces, with opposite sign, into ``matrix``.

    Of the forces of the nodes and of the loads ``target``, `Applied`, where ``here`` is. ``floor``
    (N/m) is added to the diagonal: it keeps pieces that nothing holds during an iteration from
    flying off, and changes no equilibrium. ``rise``: 0 leaves out how friction rises with pressure;
    the matrix is then symmetric at equilibrium.
    """
    k, blocks, rows = np.empty((6, 6)), np.empty((2, 2, 6, 6)), np.empty((2, 6, 6))
    begin, share, over = contacts.begin, contacts.share, 1.0 / contacts.length
    matrix.band[:], matrix.right[:], matrix.below[:] = 0.0, 0.0, 0.0
    matrix.band[:, contacts.band] = floor
    for i in range(contacts.outer):
        matrix.below[i, contacts.inner + i] = floor
    if contacts.guided >= contacts.inner:
        matrix.below[contacts.guided - contacts.inner, contacts.guided] += contacts.guide
    elif contacts.guided >= 0:
        matrix.band[contacts.guided, contacts.band] += contacts.guide
    for piece in range(len(here.turn)):
        if target.levers[piece].any():
            subtract_lever(contacts, piece, target.levers[piece], here.turn[piece], matrix)
    for face in range(len(begin)):
        now = k
        if is_whole(contacts, face, whole):
            now = contacts.whole[face]
        elif contacts.first_triangle[face + 1] > contacts.first_triangle[face]:
            pressed_stiffness(contacts, face, slip, here, rise, k)
        else:
            first, last = contacts.start[face], contacts.start[face + 1]
            put_tangents(contacts.law, first, last, slip, whole, here.moved, here.tangent)
            for i in range(last - first):
                here.tangent[1, i] *= rise
                here.tangent[2, i] *= rise
            face_stiffness(contacts, face, here.along[face], here.tangent, k)
        # Arrays for one face at a time: to find them among all takes longer than to use them.
        ends, frame, arms = begin[face], here.frame[face], here.arms[face]
        by_pieces(ends, frame, arms, over, now, rows, blocks)
        add_turns(ends, frame, arms, here.sums[face], share, over, rows, blocks)
        add_face(ends, contacts.inner, contacts.band, matrix, blocks)


@compiled
def is_whole(contacts, face, whole):
    """Whether all bonds of ``face`` are whole: its stiffness then does not depend on its motion."""
    for node in range(contacts.start[face], contacts.start[face + 1]):  # noqa: SIM110 (compiled)
        if whole[node] != 1.0:
            return False
    return True


@compiled
def whole_faces(contacts, here):
    """Put the stiffness of each face with all bonds whole into ``contacts.whole``.

    ``here``: a point, which is overwritten.
    """
    slip, whole = all_bonded(contacts.places.shape[1])
    here.moved[:], plane = 0.0, np.eye(3)[1:]
    for face in range(len(contacts.begin)):
        first, last = contacts.start[face], contacts.start[face + 1]
        put_tangents(contacts.law, first, last, slip, whole, here.moved, here.tangent)
        face_stiffness(contacts, face, plane, here.tangent, contacts.whole[face])


@compiled
def by_pieces(ends, axes, arms, over, k, scratch, blocks):
    """Turn the stiffness ``k`` by the face's motion into ``blocks`` by the two pieces' unknowns.

    ``ends``, ``axes``, ``arms``: of the face, see `sidmacib.mechanics.newton.faces`. ``over``: 1
    over the length (1/m). ``scratch``: (2, 6, 6), overwritten.
    """
    rows, columns = scratch[0], scratch[1]
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
        if ends[right] >= 0:
            moved, lever = rows, arms[right]
            for i in range(6):
                a, b, c = cross(lever, (columns[i, 0], columns[i, 1], columns[i, 2]))
                moved[i, 0], moved[i, 1], moved[i, 2] = columns[i, 0], columns[i, 1], columns[i, 2]
                moved[i, 3] = over * (columns[i, 3] + a)
                moved[i, 4] = over * (columns[i, 4] + b)
                moved[i, 5] = over * (columns[i, 5] + c)
            for left in range(2):
                if ends[left] >= 0:
                    sign, block = 1.0 if left == right else -1.0, blocks[left, right]
                    lever, turn = arms[left], sign * over
                    for j in range(6):
                        a, b, c = cross(lever, (moved[0, j], moved[1, j], moved[2, j]))
                        block[0, j], block[1, j] = sign * moved[0, j], sign * moved[1, j]
                        block[2, j], block[3, j] = sign * moved[2, j], turn * (moved[3, j] + a)
                        block[4, j] = turn * (moved[4, j] + b)
                        block[5, j] = turn * (moved[5, j] + c)


@compiled
def add_turns(ends, frame, arms, sums, share, over, scratch, blocks):
    """Add to ``blocks`` what forces of a face that stay change as frame and arms turn and move.

    With f the force on the piece above, at the arms r from its centroid and s from that of the
    piece below, and w the ``share`` of this in how frames turn, f changes by psi x f, and the
    moments about both centroids by

        ((1 - w) (v_below - v_above) + u) x f + r x (psi x f)
        (w (v_above - v_below) + u) x f + s x (psi x f)

        psi = w phi_below + (1 - w) phi_above,   u = (1 - w) phi_below x s + w phi_above x r

    the second with opposite sign. Arguments of `by_pieces`, and the ``sums`` of the face's forces.
    """
    force = together(frame, sums[0, 0], sums[0, 1], sums[0, 2])
    lower, upper, rows = scratch[0, :3], scratch[0, 3:], scratch[1]  # arm times force; below, above
    for j in range(3):
        rows[j, 0], rows[j, 1], rows[j, 2] = together(
            frame, sums[1 + j, 0], sums[1 + j, 1], sums[1 + j, 2]
        )
    for k in range(3):
        column = together(frame, rows[0, k], rows[1, k], rows[2, k])
        for j in range(3):
            lower[j, k] = column[j] + arms[0, j] * force[k]
            upper[j, k] = column[j] + arms[1, j] * force[k]
    for left in range(2):
        sign, moves = 2.0 * left - 1.0, abs(left - share)
        for right in range(2):
            if ends[left] >= 0 and ends[right] >= 0:
                block, square = blocks[left, right], sign * over * over
                turns = abs(right - share)
                add_cross(block, 0, 3, force, sign * turns * over)
                add_cross(block, 3, 0, force, (1.0 - 2.0 * right) * moves * over)
                add_square(block, upper if right else lower, (turns - 1.0) * square, False)
                add_square(block, upper if left else lower, turns * square, True)


@compiled
def add_cross(block, row, column, force, share):
    """Add ``share`` times the matrix of the cross product with ``force`` from there on."""
    x, y, z = share * force[0], share * force[1], share * force[2]
    block[row, column + 1] -= z
    block[row, column + 2] += y
    block[row + 1, column] += z
    block[row + 1, column + 2] -= x
    block[row + 2, column] -= y
    block[row + 2, column + 1] += x


@compiled
def add_square(block, part, share, transposed):
    """Add ``share`` (``part`` - its trace I) to the moments by rotations of a ``block``."""
    trace = part[0, 0] + part[1, 1] + part[2, 2]
    for j in range(3):
        for k in range(3):
            block[3 + j, 3 + k] += share * (part[k, j] if transposed else part[j, k])
        block[3 + j, 3 + j] -= share * trace


@compiled
def subtract_lever(contacts, piece, levers, turn, matrix):
    """Subtract the derivative of the moments of forces whose arms turn with their piece."""
    now, share = np.empty((3, 3)), -1.0 / contacts.length**2
    for j in range(3):
        for k in range(3):
            now[j, k] = levers[j, k]
            for m in range(3):
                now[j, k] += turn[j, m] * levers[m, k]
    trace, first = now[0, 0] + now[1, 1] + now[2, 2], 6 * piece + 3
    for j in range(3):
        for k in range(3):
            value = share * (now[j, k] - (trace if j == k else 0.0))
            row, column = first + j, first + k
            if row >= contacts.inner:
                matrix.below[row - contacts.inner, column] += value
            else:
                matrix.band[row, contacts.band + column - row] += value


@compiled
def add_face(ends, inner, width, matrix, blocks):
    """Add ``blocks`` of the pieces at the ``ends`` of a face, (2, 2, 6, 6), to ``matrix``."""
    band, border, below = matrix.band, matrix.right, matrix.below
    for left in range(2):
        row = ends[left]
        for right in range(2):
            column = ends[right]
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
                first = width + column - row
                for i in range(6):
                    for j in range(6):
                        band[row + i, first - i + j] += blocks[left, right, i, j]
