"""Pieces that are bonded to one other, as locks to their block: one body with it, and its roots.

Bonds do not break in time. What they carry is the mean over a step: with J and F the impulses of
contacts and the other forces on a lock, m its mass and v the velocity of its centroid, its root
carries (m dv - J) / h - F, and a moment in the same way; blows are thus shared out over a step. As
long as all bonds of a root are whole, their springs share it out over its nodes.

Rigid blocks do not say how several contacts share a force. The largest part of the strength that
thirty joints of 3 to 9 locks used differed by up to 2.6 times when they were turned, mirrored or
renamed. So up to `SURE` of it a bond of a piece that touches others counts as holding; beyond, that
is open.
"""

# mypy: allow-untyped-defs

from collections import namedtuple

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Cuboid, Floats, Integers, Kind, Piece
from sidmacib.mechanics.compilation import compiled
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.equilibrium import face_frames

SURE = 0.25  # of the strength
# `of`: the root of each solid, or -1. Of the pieces that roots hold: their `body`, `mass` (kg),
# `inertia` (kg m2) and `arm` from the body's centroid (m), as built, and the `force` on them (N).
# `start`: first node of each root, then their number; `share` (N, 3, 6): forces of nodes by that
# and the moment about the piece's centroid, as built; `held` (N, 3): shear strength, tensile
# strength (N) and friction.
Roots = namedtuple("Roots", "of body mass inertia arm force start share held")


def bodies_of(assembly: Assembly, what: str) -> Integers:
    """The piece that each piece is one body with, (P,): itself, or what it is bonded to.

    `CapacityError`, which begins with ``what``, where more than that is bonded.
    """
    bonded: dict[int, set[int]] = {}
    for face in assembly.faces:
        if face.kind is Kind.INNER:
            bonded.setdefault(face.below, set()).add(face.above)
            bonded.setdefault(face.above, set()).add(face.below)
    body = np.arange(len(assembly.pieces))
    for piece, others in bonded.items():
        holder = min(others)
        alone = len(others) == 1 and not assembly.pieces[piece].fixed
        if alone and (len(bonded[holder]) > 1 or _held_by(assembly, piece, holder)):
            body[piece] = holder
    for face in assembly.faces:
        if face.kind is Kind.INNER and body[face.below] != body[face.above]:
            raise CapacityError(
                f"{what}: {face.name} is bonded, and so are others of its blocks; leave out "
                "cohesion and tensile strength, except those of locks"
            )
    return body


def _held_by(assembly: Assembly, piece: int, other: int) -> bool:
    """Of two that are bonded to each other alone: whether this one is the lock."""
    one, two = assembly.pieces[piece], assembly.pieces[other]
    return two.fixed or (two.mass, -other) > (one.mass, -piece)


def inertia_of(piece: Piece) -> Floats:
    """The tensor of inertia of a ``piece`` about its centroid, in kg m2, (3, 3)."""
    if isinstance(piece, Cuboid):
        return np.diag(piece.inertia)
    return np.asarray(piece.inertia_tensor)  # type: ignore[attr-defined]


def roots_of(
    assembly: Assembly, body: Integers, centre: Floats, of_solid: Integers, forces: Floats
) -> tuple[Roots, Integers]:
    """The roots of pieces that are in the ``body`` of another, and these pieces, (R,).

    ``centre``: of each piece's body, m, (P, 3); ``of_solid``: the piece of each solid; ``forces``
    on pieces, N, (P, 3).
    """
    pieces = np.flatnonzero(body != np.arange(len(body)))
    number = np.full(len(body), -1)
    number[pieces] = np.arange(len(pieces))
    law, frames, nodes = ContactLaw.of(assembly), face_frames(assembly), assembly.nodes
    inner = np.array([face.kind is Kind.INNER for face in assembly.faces], bool)
    ends = np.array([(face.below, face.above) for face in assembly.faces])
    springs = np.stack([law.normal_stiffness, law.shear_stiffness, law.shear_stiffness], axis=1)
    strengths = np.stack([law.shear_strength, law.tensile_strength, law.bond_friction], axis=1)
    share, held, start = [np.zeros((0, 3, 6))], [np.zeros((0, 3))], [0]
    for piece in pieces.tolist():
        here = np.flatnonzero(inner[nodes.face] & (ends[nodes.face] == piece).any(axis=1))
        sign = np.where(ends[nodes.face[here], 1] == piece, 1.0, -1.0)
        axes = sign[:, None, None] * frames[here]
        x, y, z = (nodes.position[here] - assembly.pieces[piece].centre).T
        none = np.zeros_like(x)
        cross = np.array([[none, z, -y], [-z, none, x], [y, -x, none]]).transpose(2, 0, 1)
        moved = axes @ np.concatenate([np.broadcast_to(np.eye(3), cross.shape), cross], axis=2)
        pulled = springs[here][:, :, None] * moved
        stiffness = np.einsum("nki,nkj->ij", moved, pulled)
        size = np.sqrt(stiffness.diagonal())
        inverse = np.linalg.inv(stiffness / np.outer(size, size)) / np.outer(size, size)
        share.append(pulled @ inverse)
        held.append(strengths[here])
        start.append(start[-1] + len(here))
    masses = np.array([assembly.pieces[piece].mass for piece in pieces.tolist()])
    tensors = [inertia_of(assembly.pieces[piece]) for piece in pieces.tolist()]
    centroids = np.array([piece.centre for piece in assembly.pieces])
    roots = Roots(
        of=number[of_solid],
        body=body[pieces],
        mass=masses.astype(float),
        inertia=np.array(tensors).reshape(-1, 3, 3),
        arm=centroids[pieces] - centre[pieces],
        force=np.ascontiguousarray(forces[pieces]),
        start=np.array(start),
        share=np.concatenate(share),
        held=np.concatenate(held),
    )
    return roots, pieces


@compiled
def note_used(roots, pairs, contacts, state, frames, before, acting, ground, used):
    """Raise ``used``, what roots have carried so far, (2, R), to that of this step.

    Over their strength, and over what they surely carry. ``before``: velocities before it, of
    centroids and of rotation.
    """
    count = len(roots.body)
    impulses, places = np.zeros((count, 2, 3)), np.zeros((count, 3))
    for r in range(count):
        b = roots.body[r]
        for i in range(3):
            places[r, i] = state.centre[b, i]
            for j in range(3):
                places[r, i] += frames.turn[b, i, j] * roots.arm[r, j]
    for c in range(contacts.count[0]):
        for side in range(2):
            r = roots.of[pairs.solids[contacts.pair[c], side]]
            if r >= 0:
                _add_impulse(contacts, c, 2.0 * side - 1.0, places[r], impulses[r])
    carried = np.empty(6)
    for r in range(count):
        _put_carried(
            roots, r, state, frames, before, acting, ground, places[r], impulses[r], carried
        )
        part = _most(roots, r, carried)
        used[0, r] = max(used[0, r], part)
        used[1, r] = max(used[1, r], part / SURE if impulses[r].any() else part)


@compiled
def _add_impulse(contacts, c, sign, place, impulse):
    """Add ``sign`` times the impulse at a contact, and its moment about a ``place``."""
    f, d = np.zeros(3), np.zeros(3)
    for i in range(3):
        d[i] = contacts.place[c, i] - place[i]
        for k in range(3):
            f[i] += sign * contacts.frame[c, k, i] * contacts.impulse[c, k]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        impulse[0, i] += f[i]
        impulse[1, i] += d[j] * f[k] - d[k] * f[j]


@compiled
def _put_carried(roots, r, state, frames, before, acting, ground, place, impulse, carried):
    """Fill in the force (N) and moment (N m) of a root on its piece, in directions as built."""
    b = roots.body[r]
    R, spun, d, force = frames.turn[b], np.zeros(3), np.zeros(3), np.zeros(3)
    w, own, spins = state.spin[b], np.zeros(3), np.zeros(3)
    along = square = 0.0
    for i in range(3):
        spun[i] = w[i] - before[1][b, i]
        d[i] = place[i] - state.centre[b, i]
        along, square = along + w[i] * d[i], square + w[i] * w[i]
        for j in range(3):
            own[i] += R[j, i] * w[j]
    for i in range(3):
        for k in range(3):
            spins[i] += roots.inertia[r, i, k] * own[k]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        gained = state.speed[b, i] - before[0][b, i] + spun[j] * d[k] - spun[k] * d[j]
        gained += acting.h * (ground[i] + along * w[i] - square * d[i])
        force[i] = (roots.mass[r] * gained - impulse[0, i]) / acting.h - roots.force[r, i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        carried[i], turned = 0.0, acting.h * (own[j] * spins[k] - own[k] * spins[j])
        for j in range(3):
            carried[i] += R[j, i] * force[j]
            turned -= R[j, i] * impulse[1, j]
            for k in range(3):
                turned += roots.inertia[r, i, j] * R[k, j] * spun[k]
        carried[3 + i] = turned / acting.h


@compiled
def _most(roots, r, carried):
    """Of the strength of a root's nodes, the largest part that is used."""
    most, s = 0.0, np.empty(3)
    for n in range(roots.start[r], roots.start[r + 1]):
        for k in range(3):
            s[k] = 0.0
            for i in range(6):
                s[k] += roots.share[n, k, i] * carried[i]
        shear = np.sqrt(s[1] * s[1] + s[2] * s[2]) - roots.held[n, 2] * s[0]
        for part, strength in ((shear, roots.held[n, 0]), (-s[0], roots.held[n, 1])):
            if part > most * strength:
                most = part / strength if strength > 0.0 else np.inf
    return most
