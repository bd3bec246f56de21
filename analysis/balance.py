"""Check that all pieces are in equilibrium under the stresses that a model found."""

from dataclasses import replace

import numpy as np

from analysis.reading import CaseResult
from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import Floats, Nodes
from sidmacib.mechanics.equilibrium import equilibrium_matrix, face_frames
from sidmacib.pieces import assemble


def unbalanced_forces(result: CaseResult) -> Floats:
    """What is left of force (N) and moment (N m) on each piece at the peak, (pieces, 6).

    The moments are about the pieces' centroids; fixed pieces have 0.
    """
    nodes = result.nodes
    assembly = assemble(result.case.joint, result.case.mesh)
    number = {face.name: index for index, face in enumerate(assembly.faces)}
    places = nodes[["x_m", "y_m", "z_m"]].to_numpy()
    owner = nodes["face"].map(number).to_numpy()
    assembly = replace(assembly, nodes=Nodes(owner, places, nodes["area_m2"].to_numpy()))
    shear_on_above = nodes[["shear_x_Pa", "shear_y_Pa", "shear_z_Pa"]].to_numpy()
    frames = face_frames(assembly)
    # Node forces on the piece below, in the frame of the face: compression pushes it back.
    local = -np.einsum("nij,nj->ni", frames, shear_on_above)
    local[:, 0] -= nodes["normal_Pa"].to_numpy()
    node_forces = local * assembly.nodes.area[:, None]
    loads = lateral_load(result.case.joint, assembly, result.case.loading)
    outside = loads.permanent + result.peak_load * loads.variable
    inside = equilibrium_matrix(assembly) @ node_forces.ravel()
    force = inside.reshape(-1, 6) + outside
    for index, piece in enumerate(assembly.pieces):
        if piece.fixed:
            force[index] = 0.0
    return force


def unbalanced_share(result: CaseResult) -> float:
    """Largest unbalanced force on a piece over the peak load, or moment over that times a."""
    wrench = unbalanced_forces(result)
    force = np.linalg.norm(wrench[:, :3], axis=1).max()
    moment = np.linalg.norm(wrench[:, 3:], axis=1).max()
    return float(max(force, moment / result.case.joint.a)) / result.peak_load
