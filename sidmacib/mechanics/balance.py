"""Whether the pieces of an assembly are in equilibrium under given node forces."""

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Loads
from sidmacib.mechanics.equilibrium import face_frames


def unbalanced_forces(assembly: Assembly, loads: Loads, load: float, force: Floats) -> Floats:
    """What is left of force (N) and moment (N m) on each piece under ``load`` (N), (P, 6).

    ``force``: (N, 3) in N, what the piece below each node exerts on the piece above, in the frame
    of the face. The moments are about the pieces' centroids; fixed pieces have 0.
    """
    left = loads.permanent + load * loads.variable
    on_above = np.einsum("nk,nkx->nx", force, face_frames(assembly))
    for side, sign in (("above", 1.0), ("below", -1.0)):
        piece = np.array([getattr(face, side) for face in assembly.faces])[assembly.nodes.face]
        centre = np.array([each.centre for each in assembly.pieces])[piece]
        moment = np.cross(assembly.nodes.position - centre, on_above)
        np.add.at(left, piece, sign * np.hstack([on_above, moment]))
    left[[i for i, each in enumerate(assembly.pieces) if each.fixed]] = 0.0
    return left


def unbalanced_share(assembly: Assembly, loads: Loads, load: float, force: Floats) -> float:
    """Largest unbalanced force on a piece over ``load``, or moment over that times the length."""
    left = unbalanced_forces(assembly, loads, load, force)
    most_force = float(np.linalg.norm(left[:, :3], axis=1).max())
    most_moment = float(np.linalg.norm(left[:, 3:], axis=1).max())
    return max(most_force, most_moment / assembly.length) / load
