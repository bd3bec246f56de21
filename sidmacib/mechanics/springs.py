"""The joint's contact nodes as springs between rigid pieces, in matrices of the pieces' size.

The unknowns are the six displacements of every free piece, so the matrices stay small however fine
the mesh.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Flags, NodeLaw
from sidmacib.mechanics.equilibrium import face_frames, wrenches


@dataclass(frozen=True)
class Springs:
    """Rigid pieces and the nodes between them.

    The nodes of a face move like a rigid body: delta = ``motion`` w, (N, 3, 6), with six components
    w = ``faces`` u, (F, 6, 6 P), of the face's two pieces. ``starts``: index of each face's first
    node.
    """

    law: NodeLaw
    motion: Floats
    faces: Floats
    starts: NDArray[np.int64]

    @classmethod
    def of(cls, assembly: Assembly) -> "Springs":
        """The springs of ``assembly``."""
        nodes, frames = assembly.nodes, face_frames(assembly)
        origins = np.array([(np.array(f.low) + np.array(f.high)) / 2 for f in assembly.faces])
        free = [i for i, piece in enumerate(assembly.pieces) if not piece.fixed]
        faces = np.zeros((len(assembly.faces), 6, 6 * len(free)))
        for number, face in enumerate(assembly.faces):
            for piece, sign in ((face.below, 1.0), (face.above, -1.0)):
                if piece in free:
                    column = 6 * free.index(piece)
                    arm = origins[number] - assembly.pieces[piece].centre
                    faces[number, :, column : column + 6] = sign * np.eye(6)
                    # A turn moves the origin of the face by turn x arm.
                    faces[number, :3, column + 3 : column + 6] = -sign * np.cross(arm, np.eye(3)).T
        return cls(
            NodeLaw.of(assembly),
            # Row by row, force and moment of a unit force about the face's origin.
            wrenches(nodes.position - origins[nodes.face], frames, np.zeros(3))
            .T.reshape(-1, 3, 6)
            .copy(),
            faces,
            np.flatnonzero(np.diff(nodes.face, prepend=-1)),
        )

    def part(self, own: Flags) -> "Springs":
        """The same joint with only its ``own`` nodes, (N,), and the faces that have any."""
        owner = np.repeat(np.arange(len(self.faces)), self._counts())[own]
        present, starts = np.unique(owner, return_index=True)
        return replace(
            self,
            law=self.law.part(own),
            motion=self.motion[own],
            faces=self.faces[present],
            starts=starts,
        )

    def node_displacements(self, displacement: Floats) -> Floats:
        """Relative displacement at each node, below minus above, in the frame of its face."""
        per_face = np.repeat(self.faces @ displacement, self._counts(), axis=0)
        return np.asarray((self.motion @ per_face[:, :, None])[:, :, 0])

    def piece_forces(self, force: Floats) -> Floats:
        """Forces on the free pieces that balance node forces, (6 P,)."""
        per_node = (force[:, None, :] @ self.motion)[:, 0]
        per_face = np.add.reduceat(per_node, self.starts)
        return np.asarray(np.einsum("fk,fkp->p", per_face, self.faces))

    def stiffness(self, tangent: Floats) -> Floats:
        """Derivative of `piece_forces` by the displacements, (6 P, 6 P)."""
        forces = (tangent @ self.motion).reshape(-1, 6)
        motions = self.motion.reshape(-1, 6)
        per_face = np.empty_like(self.faces[:, :, :6])
        for number, (start, count) in enumerate(zip(self.starts, self._counts(), strict=True)):
            rows = slice(3 * start, 3 * (start + count))
            per_face[number] = motions[rows].T @ forces[rows]
        size = self.faces.shape[2]
        return self.faces.reshape(-1, size).T @ (per_face @ self.faces).reshape(-1, size)

    def elastic_stiffness(self) -> Floats:
        """Stiffness with every node closed and bonded."""
        tangent = np.zeros((len(self.motion), 3, 3))
        tangent[:, 0, 0] = self.law.normal_stiffness
        tangent[:, 1, 1] = tangent[:, 2, 2] = self.law.shear_stiffness
        return self.stiffness(tangent)

    def _counts(self) -> NDArray[np.int64]:
        """Number of nodes of each face, (F,)."""
        return np.diff(self.starts, append=len(self.motion))
