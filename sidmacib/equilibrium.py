"""Equilibrium matrices: the force and moment of unit forces at points."""

import numpy as np
from numpy.typing import NDArray

from sidmacib.discretisation import Discretisation, Floats
from sidmacib.loading import PieceLoad


def wrenches(points: Floats, axes: Floats, about: Floats) -> Floats:
    """Force and moment about a point of unit forces at ``points``.

    ``points``: (N, 3) in m; ``axes``: (N, K, 3), the K unit directions at each point; ``about``:
    (3,) in m. Returns (6, N * K): rows force x, y, z (1) and moment x, y, z (m); columns point by
    point. This is the paper's C_eq for one block.
    """
    arms = (points - about)[:, None, :]
    columns = np.concatenate([axes, np.cross(arms, axes)], axis=2)
    return np.asarray(columns.reshape(-1, 6).T)


def face_frames(model: Discretisation) -> Floats:
    """Unit vectors at each node, (N, 3, 3): the face's normal, then its two tangents."""
    frames = np.array([np.roll(np.eye(3), -face.axis, axis=0) for face in model.faces])
    return np.asarray(frames[model.nodes.face])


def equilibrium_matrix(model: Discretisation) -> Floats:
    """Forces and moments about their centroids of all pieces under unit node forces.

    Returns (6 * P, 3 * N). The force at a node, in the frame of `face_frames`, is the one that the
    piece above exerts on the piece below; the piece above gets its opposite. The transpose maps
    displacements of the pieces to relative displacements of the nodes (below minus above).
    """
    matrix = np.zeros((6 * len(model.pieces), 3 * len(model.nodes.area)))
    frames = face_frames(model)
    for number, face in enumerate(model.faces):
        own = np.flatnonzero(model.nodes.face == number)
        columns = (3 * own[:, None] + np.arange(3)).ravel()
        for piece, sign in ((face.below, 1.0), (face.above, -1.0)):
            rows = slice(6 * piece, 6 * piece + 6)
            centre = model.pieces[piece].centre
            matrix[rows, columns] = sign * wrenches(model.nodes.position[own], frames[own], centre)
    return matrix


def free_rows(model: Discretisation) -> NDArray[np.int64]:
    """Rows of the free pieces in `equilibrium_matrix`, (6 F,)."""
    free = [i for i, piece in enumerate(model.pieces) if not piece.fixed]
    return np.concatenate([np.arange(6 * i, 6 * i + 6) for i in free])


def permanent_and_reference(
    model: Discretisation, loads: tuple[PieceLoad, ...]
) -> tuple[Floats, Floats]:
    """Self-weight (N, N m) and ``loads`` (per N of load) as forces and moments on all pieces.

    Both (6 P,), force and moment about the centroid piece by piece.
    """
    permanent, reference = np.zeros((2, len(model.pieces), 6))
    permanent[:, 2] = [-piece.weight for piece in model.pieces]
    for load in loads:
        reference[load.piece] += np.concatenate([load.force, load.moment])
    return permanent.ravel(), reference.ravel()
