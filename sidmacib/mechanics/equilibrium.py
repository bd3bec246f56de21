"""Equilibrium of rigid pieces, and their stiffness with every contact node closed.

Wrenches of unit node forces, and what given node forces leave over. With unbroken nodes as springs
between the pieces, frequencies and compliance set the scales of an explicit computation: its time
step, its loading rate, and the displacement beyond which the assembly can only have failed.

The unknowns are the displacements of the free pieces. Where rotations are multiplied by the
assembly's ``length`` and moments divided by it, see `row_units`, all unknowns are in m, all forces
in N and all stiffnesses in N/m.
"""

import importlib
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Piece
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.loads import Loads

if TYPE_CHECKING:
    from scipy.sparse import csr_array

RIGID = 6  # displacements and rotations of a rigid piece


def has_bonds(assembly: Assembly) -> bool:
    """Whether any face is bonded."""
    return any(face.kind is Kind.INNER for face in assembly.faces)


def is_dry(assembly: Assembly) -> bool:
    """Whether all faces are dry: none is bonded, a plate's, or of condensed locks."""
    return all(face.kind is Kind.DRY for face in assembly.faces)


def wrenches(points: Floats, axes: Floats, about: Floats) -> Floats:
    """Force and moment about a point of unit forces at ``points``.

    ``points``: (N, 3) in m; ``axes``: (N, K, 3), the K unit directions at each point; ``about``:
    (3,) in m. Returns (6, N * K): rows force x, y, z (1) and moment x, y, z (m); columns point by
    point. This is the paper's C_eq for one block.
    """
    arms = (points - about)[:, None, :]
    columns = np.concatenate([axes, np.cross(arms, axes)], axis=2)
    return np.asarray(columns.reshape(-1, 6).T)


def face_axes(assembly: Assembly) -> Floats:
    """Unit vectors of each face, (F, 3, 3): its normal, then its two tangents."""
    return np.array([face.axes for face in assembly.faces])


def face_frames(assembly: Assembly) -> Floats:
    """Unit vectors at each node, (N, 3, 3): the face's normal, then its two tangents."""
    return np.asarray(face_axes(assembly)[assembly.nodes.face])


def row_units(assembly: Assembly) -> Floats:
    """Units of the rows `free_rows`, (6 F,): 1 for forces, the assembly's length for moments.

    Over these, forces (N) and moments (N m) are all in N.
    """
    free = sum(not piece.fixed for piece in assembly.pieces)
    return np.tile([1.0] * 3 + [assembly.length] * 3, free)


def free_rows(assembly: Assembly) -> NDArray[np.int64]:
    """Rows of the free pieces in `equilibrium_matrix`, (6 F,)."""
    free = [i for i, piece in enumerate(assembly.pieces) if not piece.fixed]
    return (RIGID * np.array(free)[:, None] + np.arange(RIGID)).ravel()


def equilibrium_matrix(assembly: Assembly) -> "csr_array":
    """Forces and moments about their centroids of all pieces under unit node forces.

    Returns (6 * P, 3 * N), sparse. The force at a node, in the frame of `face_frames`, is the one
    that the piece above exerts on the piece below; the piece above gets its opposite. The transpose
    maps displacements of the pieces to relative displacements of the nodes (below minus above).
    """
    frames, position = face_frames(assembly), assembly.nodes.position
    centres = np.array([piece.centre for piece in assembly.pieces])
    ends = np.array([(face.below, face.above) for face in assembly.faces])[assembly.nodes.face]
    columns = 3 * np.arange(len(position))[:, None, None] + np.arange(3)[:, None]
    rows, values = [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        arms = position - centres[ends[:, side]]
        moments = np.cross(arms[:, None, :], frames)
        values.append(sign * np.concatenate([frames, moments], axis=2))  # (N, 3, 6)
        rows.append(6 * ends[:, side][:, None, None] + np.arange(6) + 0 * columns)
    every = np.concatenate([(columns + 0 * rows[0]).ravel()] * 2)
    shape = 6 * len(centres), 3 * len(position)
    # Imported here: the static model of rigid pieces does without it.
    csr_array = importlib.import_module("scipy.sparse").csr_array
    found = csr_array((np.array(values).ravel(), (np.array(rows).ravel(), every)), shape)
    found.eliminate_zeros()
    return found


def sparse_rows(values: Floats, columns: NDArray[np.int64], width: int) -> "csr_array":
    """``values``, (K, C), in those ``columns``, (C,), of a sparse matrix, (K, width)."""
    count, each = values.shape
    ends = np.arange(count + 1) * each
    csr_array = importlib.import_module("scipy.sparse").csr_array
    return csr_array((values.ravel(), np.tile(columns, count), ends), (count, width))


def motion_of(assembly: Assembly, unknowns: Floats) -> Floats:
    """Displacements (m) and rotations (rad) of all pieces, (P, 6), from those of the free ones."""
    motion = np.zeros(RIGID * len(assembly.pieces))
    motion[free_rows(assembly)] = unknowns
    return motion.reshape(-1, RIGID)


def placed(assembly: Assembly, unknowns: Floats) -> Floats:
    """Displacements (m) and rotation vectors (rad) of all pieces, (P, 6).

    ``unknowns``: of a `sidmacib.mechanics.rigid.RigidSolver`, with Gibbs vectors.
    """
    motion = motion_of(assembly, unknowns)
    half = np.linalg.norm(motion[:, 3:], axis=1) / 2.0
    angle = np.divide(np.arctan(half), half, out=np.ones_like(half), where=half > 0.0)
    return np.hstack([motion[:, :3], angle[:, None] * motion[:, 3:]])


def self_weight(pieces: Sequence[Piece]) -> Floats:
    """Force (N, along -z) and moment (N m, none) of the pieces' weight, (P, 6)."""
    return np.array([[0.0, 0.0, -piece.weight, 0.0, 0.0, 0.0] for piece in pieces])


def moments_of(levers: Floats) -> Floats:
    """Moments (N m), (P, 3), of sums of arm times force (N m), (P, 3, 3)."""
    across = levers - np.swapaxes(levers, 1, 2)
    return np.stack([across[:, 1, 2], across[:, 2, 0], across[:, 0, 1]], axis=1)


def unbalanced_forces(
    assembly: Assembly, loads: Loads, load: float, force: Floats, motion: Floats | None = None
) -> Floats:
    """Unbalanced force (N) and moment (N m) on each piece under ``load`` (N), (P, 6).

    ``force``: (N, 3) in N, what the piece below each node exerts on the piece above, in the frame
    of the face. ``motion``: of the pieces since they were built, see `placed`; frames then turn
    with the pieces below, and nodes are where the pieces above have moved, or both halfway. The
    moments are about the pieces' centroids; fixed pieces have 0, and what a guide holds.
    """
    unbalanced = loads.at(load)
    below, above = np.array([(face.below, face.above) for face in assembly.faces])[
        assembly.nodes.face
    ].T
    centre = np.array([each.centre for each in assembly.pieces])
    frames, place = face_frames(assembly), assembly.nodes.position
    if motion is not None:
        rotation = importlib.import_module("scipy.spatial.transform").Rotation
        turns = rotation.from_rotvec(motion[:, 3:])
        turn, quaternion = turns.as_matrix(), turns.as_quat(canonical=True)
        share = assembly.share
        mean = share * quaternion[below] + (1.0 - share) * quaternion[above]
        frames = frames @ np.swapaxes(rotation.from_quat(mean).as_matrix(), 1, 2)
        moved = centre + motion[:, :3]
        of_below, of_above = (
            moved[each] + np.einsum("nij,nj->ni", turn[each], place - centre[each])
            for each in (below, above)
        )
        place, centre = (1.0 - share) * of_below + share * of_above, moved
        permanent, raised = loads.levers()
        unbalanced[:, 3:] += moments_of((turn - np.eye(3)) @ (permanent + load * raised))
    on_above = np.einsum("nk,nkx->nx", force, frames)
    for piece, sign in ((above, 1.0), (below, -1.0)):
        moment = np.cross(place - centre[piece], on_above)
        np.add.at(unbalanced, piece, sign * np.hstack([on_above, moment]))
    unbalanced[[i for i, each in enumerate(assembly.pieces) if each.fixed]] = 0.0
    if loads.guided is not None:
        unbalanced[loads.guided, 0] = 0.0
    return unbalanced


def unbalanced_share(
    assembly: Assembly, loads: Loads, load: float, force: Floats, motion: Floats | None = None
) -> float:
    """Largest unbalanced force on a piece over ``load``, or moment over that times the length.

    Arguments of `unbalanced_forces`.
    """
    unbalanced = unbalanced_forces(assembly, loads, load, force, motion)
    most_force = float(np.linalg.norm(unbalanced[:, :3], axis=1).max())
    most_moment = float(np.linalg.norm(unbalanced[:, 3:], axis=1).max())
    return max(most_force, most_moment / assembly.length) / load


def elastic_stiffness(assembly: Assembly, law: ContactLaw) -> Floats:
    """Stiffness (N/m) by all unknowns, (U, U), with every node closed and bonded by ``law``."""
    balance = equilibrium_matrix(assembly)[free_rows(assembly)] / row_units(assembly)[:, None]
    springs = np.column_stack([law.normal_stiffness, law.shear_stiffness, law.shear_stiffness])
    return np.asarray((balance * springs.ravel() @ balance.T).toarray())


def natural_frequencies(assembly: Assembly) -> Floats:
    """Angular frequencies of the free pieces, ascending, in rad/s, with every node closed.

    Every piece has its largest principal moment of inertia about all axes.
    """
    free = [piece for piece in assembly.pieces if not piece.fixed]
    inertia = [piece.inertia.max() / assembly.length**2 for piece in free]  # kg, as rotations in m
    mass = np.concatenate(
        [[piece.mass] * 3 + [turned] * 3 for piece, turned in zip(free, inertia, strict=True)]
    )
    root = np.sqrt(mass)
    stiffness = elastic_stiffness(assembly, ContactLaw.of(assembly)) / root / root[:, None]
    return np.sqrt(np.linalg.eigvalsh(stiffness))


def soft_law(assembly: Assembly) -> ContactLaw:
    """The law of ``assembly`` with no face stiffer than the softest inner one, if there is any.

    The reference for displacements: where all nodes are bonded, dry faces carry loads past the
    inner ones, and the stiffer they are the less moves. Once they slip, the inner faces decide.
    """
    laws = [face.material for face in assembly.faces]
    stiffness = np.array([(law.normal_stiffness, law.shear_stiffness) for law in laws])
    inner = np.array([face.kind is Kind.INNER for face in assembly.faces])
    most = stiffness[inner].min(axis=0, initial=np.inf)
    normal, shear = np.minimum(1.0, most / stiffness)[assembly.nodes.face].T
    law = ContactLaw.of(assembly)
    return replace(
        law,
        normal_stiffness=law.normal_stiffness * normal,
        shear_stiffness=law.shear_stiffness * shear,
    )


def compliance(assembly: Assembly, loads: Loads) -> float:
    """Displacement along the variable load, per newton of load, in m/N, with every node closed.

    By `soft_law`.
    """
    force = loads.variable.ravel()[free_rows(assembly)] / row_units(assembly)
    stiffness = elastic_stiffness(assembly, soft_law(assembly))
    return float(np.sum(force * np.linalg.solve(stiffness, force)))
