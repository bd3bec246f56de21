"""The equations of equilibrium of all pieces as a sparse matrix."""

import numpy as np
from scipy.sparse import csr_array

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.equilibrium import face_frames


def equilibrium_matrix(assembly: Assembly) -> csr_array:
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
    found = csr_array((np.array(values).ravel(), (np.array(rows).ravel(), every)), shape)
    found.eliminate_zeros()
    return found
