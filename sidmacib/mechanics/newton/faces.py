"""Faces with contact nodes, where the pieces are: the forces on these, and their derivatives.

The unknowns (m) are the displacements of the free pieces, so their number does not depend on the
mesh, in the order that `sidmacib.mechanics.rigid.ordering` finds. A piece has three displacements
of its centroid and the Gibbs vector of its rotation, 2 tan(theta / 2) along the axis, times the
assembly's length, from ``ContactFaces.begin`` on. Moments are divided by the length: forces are in
N and stiffnesses in N/m.

Nodes, frames and arms are where the pieces have moved to. With R the rotation and c the centroid of
a piece, and F the frame of a face,

    x = c + R (X - C),   delta = F' (x_below - x_above),   force on the piece above: F s(delta)

The frame turns with the piece below, and forces act at nodes of the piece above, which rests on it;
or both are halfway between the pieces, of which none is preferred. The rate of delta is then the
relative velocity of the two pieces at the node, so that forces do the work of the springs: also
where the frame turns by any ``share`` of the piece below, and the rest of that above, if nodes are
as far from that above.
"""

# mypy: allow-untyped-defs

from typing import NamedTuple

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law.kernels import put_forces, put_slip
from sidmacib.mechanics.newton.pressed import put_pressed, put_pressed_forces, resists
from sidmacib.mechanics.newton.vectors import cross, dot, norm, times, together


class ContactFaces(NamedTuple):
    """Pieces and faces with their nodes, the same along a path.

    ``law``: of the nodes, see `sidmacib.mechanics.contact_law.kernels`, (4, N). ``places``: p and q
    of each along the tangents, from the face's middle, in m, (2, N). ``start``: first node of each
    face, then the number of nodes, (F + 1,). ``axes``: normal and tangents of each face as built,
    (F, 3, 3). ``levers``: from the centroid of either piece to the face's middle, m, (F, 2, 3).
    ``begin``: first unknown of the pieces below and above each face, -1 for a fixed one, (F, 2).
    ``triangles``: nodes at their corners, (T, 3), their ``stiffness`` under pressure (N/m), (T,),
    and the first of each face, then their number, (F + 1,): on a face that has some, pressure is
    integrated over their pressed parts, see `put_pressed`. A face without has springs at its nodes.
    ``whole``: stiffness (N/m) by a face's motion while all its bonds are whole, (F, 6, 6).
    ``length``: of the assembly, m. ``share``: of the piece below in how frames turn, 1 or 1/2.
    ``guided``: the unknown that a ``guide`` (N/m) holds, -1 for none. The ``inner`` unknowns come
    first; those coupled by the stiffness are at most ``band`` apart.
    The ``outer`` unknowns follow and may be coupled to all others.
    """

    law: Floats
    places: Floats
    start: Integers
    axes: Floats
    levers: Floats
    begin: Integers
    triangles: Integers
    stiffness: Floats
    first_triangle: Integers
    whole: Floats
    length: float
    share: float
    guided: int
    guide: float
    inner: int
    outer: int
    band: int


class Applied(NamedTuple):
    """Loads on the free pieces, in the order of their unknowns.

    ``wrench``: force and moment (N) as built, (U,). ``levers``: sums of arm times force (N) as
    built, (U / 6, 3, 3), whose arms turn with the pieces.
    """

    wrench: Floats
    levers: Floats


class Point(NamedTuple):
    """Where the pieces are, and what that makes of the nodes.

    ``unknowns`` in m, (U,). ``turn``: rotation less identity of each free piece, (U / 6, 3, 3).
    ``mean``: that of the frame of one face at a time, (3, 3). ``apart``: displacement of the middle
    of each face (m), of the piece below relative to that above, and its gradients
    along p and q, (F, 3, 3). ``frame``: normal and tangents of each face, (F, 3, 3). ``arms``: from
    the centroids of both pieces to the middle of the face (m), (F, 2, 3). ``along``: how places of
    nodes grow by p and q, in the frame, (F, 2, 3). ``moved``: displacements of the nodes in the
    frame (m), (3, N). ``force`` of the nodes in N, (3, N). ``sums`` of these and of them times
    place, (F, 4, 3): the force, and three rows of place by force. ``residual`` in N, what the nodes
    leave of the forces on the pieces, (U,). ``pressed``: integrals over the pressed parts of
    triangles by nodes, and what these grow by, see `put_pressed`, (6, N). ``tangent``: derivatives
    of `node_tangent` in N/m for the nodes of one face at a time, (6, most nodes).
    """

    unknowns: Floats
    turn: Floats
    mean: Floats
    apart: Floats
    frame: Floats
    arms: Floats
    along: Floats
    moved: Floats
    force: Floats
    sums: Floats
    residual: Floats
    pressed: Floats
    tangent: Floats


def new_point(contacts: ContactFaces) -> Point:
    """A point of ``contacts``, to be filled in; frames and arms are those as built."""
    size, faces = contacts.inner + contacts.outer, len(contacts.axes)
    nodes, most = (3, int(contacts.start[-1])), int(np.diff(contacts.start).max())
    return Point(
        unknowns=np.empty(size),
        turn=np.empty((size // 6, 3, 3)),
        mean=np.empty((3, 3)),
        apart=np.empty((faces, 3, 3)),
        frame=contacts.axes.copy(),
        arms=contacts.levers.copy(),
        along=np.empty((faces, 2, 3)),
        moved=np.empty(nodes),
        force=np.empty(nodes),
        sums=np.empty((faces, 4, 3)),
        residual=np.empty(size),
        pressed=np.zeros((6, nodes[1])),
        tangent=np.empty((6, most)),
    )


@compiled
def put_turn(x, y, z, turn):
    """Put the rotation of the Gibbs vector (x, y, z), less identity, into ``turn``, (3, 3).

    In rational numbers, so that it has the same digits on every processor.
    """
    share = 1.0 / (1.0 + (x * x + y * y + z * z) / 4.0)
    half = share / 2.0
    turn[0, 0], turn[1, 1] = -half * (y * y + z * z), -half * (x * x + z * z)
    turn[2, 2] = -half * (x * x + y * y)
    turn[0, 1], turn[1, 0] = half * x * y - share * z, half * x * y + share * z
    turn[0, 2], turn[2, 0] = half * x * z + share * y, half * x * z - share * y
    turn[1, 2], turn[2, 1] = half * y * z - share * x, half * y * z + share * x


@compiled
def gibbs(unknowns, piece, share):
    """The Gibbs vector of a ``piece``, times ``share``."""
    i = 6 * piece + 3
    return share * unknowns[i], share * unknowns[i + 1], share * unknowns[i + 2]


@compiled
def put_pieces(contacts, here):
    """Fill in rotations and the displacements of faces by the unknowns of ``here``."""
    for piece in range(len(here.turn)):
        x, y, z = gibbs(here.unknowns, piece, 1.0 / contacts.length)
        put_turn(x, y, z, here.turn[piece])
    here.apart[:] = 0.0
    for face in range(len(contacts.begin)):
        for side in range(2):
            i = contacts.begin[face, side]
            if i >= 0:
                add_side(contacts, here, face, side, here.turn[i // 6], here.unknowns[i : i + 3])
    put_nodes(contacts, here)


@compiled
def add_side(contacts, here, face, side, turn, shift):
    """Add a piece's ``turn`` and ``shift`` (m) to the displacements of a ``face``."""
    sign, axes, apart = 1.0 - 2.0 * side, contacts.axes[face], here.apart[face]
    for row, arm in enumerate((contacts.levers[face, side], axes[1], axes[2])):
        moved = times(turn, arm)
        for k in range(3):
            apart[row, k] += sign * moved[k]
    for k in range(3):
        apart[0, k] += sign * shift[k]


@compiled
def advance(contacts, here, start, step, share):
    """Put ``here`` a ``share`` of ``step`` (m) after ``start``, rotations after rotations.

    Faces add up what is between the pieces from step to step: it would drown in the rounding of a
    difference where pieces that move far have a stiff face between them.
    """
    move = np.empty((len(here.turn), 3, 3))
    for piece in range(len(here.turn)):
        i = 6 * piece
        a, b, c = gibbs(step, piece, share / contacts.length)
        x, y, z = gibbs(start.unknowns, piece, 1.0 / contacts.length)
        put_turn(a, b, c, move[piece])
        over = 1.0 / (1.0 - (a * x + b * y + c * z) / 4.0)
        u, v, w = cross((a, b, c), (x, y, z))
        here.unknowns[i + 3] = contacts.length * (over * (a + x + u / 2.0))
        here.unknowns[i + 4] = contacts.length * (over * (b + y + v / 2.0))
        here.unknowns[i + 5] = contacts.length * (over * (c + z + w / 2.0))
        for k in range(3):
            here.unknowns[i + k] = start.unknowns[i + k] + share * step[i + k]
        # The rotation of this step times those before it, all less identity.
        for k in range(3):
            column = start.turn[piece, 0, k], start.turn[piece, 1, k], start.turn[piece, 2, k]
            moved = times(move[piece], column)
            for j in range(3):
                here.turn[piece, j, k] = column[j] + move[piece, j, k] + moved[j]
    for face in range(len(contacts.begin)):
        for row in range(3):
            for k in range(3):
                here.apart[face, row, k] = start.apart[face, row, k]
        for side in range(2):
            i = contacts.begin[face, side]
            if i >= 0:
                add_step(contacts, here, start, face, side, move[i // 6])
                for k in range(3):
                    here.apart[face, 0, k] += (1.0 - 2.0 * side) * share * step[i + k]
    put_nodes(contacts, here)


@compiled
def add_step(contacts, here, start, face, side, move):
    """Add a rotation ``move`` of a piece, less identity, after ``start``, to those of a face."""
    sign, axes, apart = 1.0 - 2.0 * side, contacts.axes[face], here.apart[face]
    before = start.turn[contacts.begin[face, side] // 6]
    for row, arm in enumerate((contacts.levers[face, side], axes[1], axes[2])):
        turned = times(before, arm)
        moved = times(move, (arm[0] + turned[0], arm[1] + turned[1], arm[2] + turned[2]))
        for k in range(3):
            apart[row, k] += sign * moved[k]


@compiled
def put_nodes(contacts, here):
    """Fill in the displacements of the nodes, and frames and arms that follow the pieces."""
    for face in range(len(contacts.begin)):
        put_frame(contacts, face, here)
        put_displacements(contacts, face, here)


@compiled
def put_frame(contacts, face, here):
    """Fill in frame and arms of ``face``."""
    frame, arms, apart = here.frame[face], here.arms[face], here.apart[face]
    for side in range(2):
        i, lever = contacts.begin[face, side], contacts.levers[face, side]
        moved = times(here.turn[i // 6], lever) if i >= 0 else (0.0, 0.0, 0.0)
        for j in range(3):  # of the piece above: to the middle on the piece below
            arms[side, j] = lever[j] + moved[j] + (side - contacts.share) * apart[0, j]
    put_mean_turn(contacts, face, here)
    below = contacts.begin[face, 0]
    for k in range(3):
        axis = contacts.axes[face, k]
        turned = times(here.mean, axis)
        for j in range(3):
            frame[k, j] = axis[j] + turned[j]
    for k in range(2):
        axis = contacts.axes[face, 1 + k]
        turned = times(here.turn[below // 6], axis) if below >= 0 else (0.0, 0.0, 0.0)
        for j in range(3):
            here.along[face, k, j] = dot(axis, frame[j]) + dot(turned, frame[j])
            here.along[face, k, j] -= contacts.share * dot(apart[1 + k], frame[j])


@compiled
def put_mean_turn(contacts, face, here):
    """Put the rotation of the frame of a ``face``, less identity, into ``here.mean``.

    Halfway between the pieces it is the mean of their unit quaternions.
    """
    x = y = z = whole = 0.0
    for side in range(2):
        u = v = w = 0.0
        i = contacts.begin[face, side]
        if i >= 0:
            u, v, w = gibbs(here.unknowns, i // 6, 1.0 / contacts.length)
        part = abs(side - contacts.share) / np.sqrt(1.0 + (u * u + v * v + w * w) / 4.0)
        x, y, z, whole = x + part * u, y + part * v, z + part * w, whole + part
    put_turn(x / whole, y / whole, z / whole, here.mean)


@compiled
def put_displacements(contacts, face, here):
    """Fill in the displacements (m) of the nodes of ``face``."""
    inside = slice(contacts.start[face], contacts.start[face + 1])
    p, q, frame, apart = (
        contacts.places[0, inside],
        contacts.places[1, inside],
        here.frame[face],
        here.apart[face],
    )
    for k in range(3):
        axis, moved = frame[k], here.moved[k, inside]
        base = dot(apart[0], axis)
        by_p, by_q = dot(apart[1], axis), dot(apart[2], axis)
        for n in range(len(p)):
            moved[n] = base + p[n] * by_p + q[n] * by_q


@compiled
def unbalanced(contacts, slip, whole, target, here):
    """Fill in forces and residual of ``here`` at its place, for the loads ``target``, `Applied`.

    Returns the norm of the residual (N).
    """
    for i, value in enumerate(target.wrench):
        here.residual[i] = value
    for piece in range(len(here.turn)):
        add_turned(
            target.levers[piece], here.turn[piece], 6 * piece + 3, contacts.length, here.residual
        )
    if contacts.guided >= 0:
        here.residual[contacts.guided] -= contacts.guide * here.unknowns[contacts.guided]
    put_forces(contacts.law, slip, whole, here.moved, here.force)
    for face in range(len(contacts.begin)):
        if contacts.first_triangle[face + 1] > contacts.first_triangle[face]:
            put_pressed(contacts, face, here)
            put_pressed_forces(contacts, face, slip, here)
        resultant(contacts, face, here)
        subtract_force(contacts, face, here)
    return norm(here.residual)


@compiled
def add_turned(levers, turn, row, length, forces):
    """Add what a ``turn``, less identity, changes of the moments of forces with ``levers`` (N)."""
    if not levers.any():
        return
    for k in range(3):  # of the moment: places with the others in cyclic order
        i, j = (k + 1) % 3, (k + 2) % 3
        moment = 0.0
        for m in range(3):
            moment += turn[i, m] * levers[m, j] - turn[j, m] * levers[m, i]
        forces[row + k] += moment / length


@compiled
def resultant(contacts, face, here):
    """Fill in ``here.sums`` of a face: the force, and the sums of place (rows) times force (N m).

    Places are those of the nodes from the middle, in the frame.
    """
    sums, force = here.sums[face], here.force
    for k in range(3):
        whole = by_p = by_q = 0.0
        for node in range(contacts.start[face], contacts.start[face + 1]):
            whole += force[k, node]
            by_p += contacts.places[0, node] * force[k, node]
            by_q += contacts.places[1, node] * force[k, node]
        sums[0, k] = whole
        for j in range(3):
            sums[1 + j, k] = here.along[face, 0, j] * by_p + here.along[face, 1, j] * by_q


@compiled
def subtract_force(contacts, face, here):
    """Add the force of ``face`` on the piece above to ``here.residual``, subtract it from below."""
    frame, sums, residual = here.frame[face], here.sums[face], here.residual
    force = together(frame, sums[0, 0], sums[0, 1], sums[0, 2])
    turn = together(
        frame, sums[2, 2] - sums[3, 1], sums[3, 0] - sums[1, 2], sums[1, 1] - sums[2, 0]
    )
    for side in range(2):
        i = contacts.begin[face, side]
        if i >= 0:
            sign = 1.0 - 2.0 * side
            moment = cross(here.arms[face, side], force)
            for k in range(3):
                residual[i + k] -= sign * force[k]
                residual[i + 3 + k] -= sign * (turn[k] + moment[k]) / contacts.length


@compiled
def put_slips(contacts, slip, whole, here, after):
    """`put_slip` of all nodes, also on faces with triangles."""
    put_slip(contacts.law, slip, whole, here.moved, here.force, after)
    for face in range(len(contacts.begin)):
        if contacts.first_triangle[face + 1] == contacts.first_triangle[face]:
            continue
        for node in range(contacts.start[face], contacts.start[face + 1]):
            shear = resists(contacts.law, here.pressed, node)
            for k in range(2):
                held = here.force[1 + k, node] / shear if shear > 0.0 else 0.0
                after[k, node] = here.moved[1 + k, node] - held
