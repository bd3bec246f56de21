"""Check that all pieces are in equilibrium under the stresses that a model found."""

from dataclasses import replace

import numpy as np

from analysis.reading import CaseResult
from sidmacib.discretisation import Floats, Nodes, discretise
from sidmacib.equilibrium import equilibrium_matrix, face_frames, permanent_and_reference
from sidmacib.loading import lateral_load


def unbalanced_forces(result: CaseResult) -> Floats:
    """What is left of force (N) and moment (N m) on each piece at the peak, (pieces, 6).

    The moments are about the pieces' centroids; fixed pieces have 0.
    """
    nodes = result.nodes
    model = discretise(result.case.joint, result.case.mesh)
    number = {face.name: index for index, face in enumerate(model.faces)}
    places = nodes[["x_m", "y_m", "z_m"]].to_numpy()
    owner = nodes["face"].map(number).to_numpy()
    model = replace(model, nodes=Nodes(owner, places, nodes["area_m2"].to_numpy()))
    shear_on_above = nodes[["shear_x_Pa", "shear_y_Pa", "shear_z_Pa"]].to_numpy()
    frames = face_frames(model)
    # Node forces on the piece below, in the frame of the face: compression pushes it back.
    local = -np.einsum("nij,nj->ni", frames, shear_on_above)
    local[:, 0] -= nodes["normal_Pa"].to_numpy()
    node_forces = local * model.nodes.area[:, None]
    permanent, reference = permanent_and_reference(model, lateral_load(model, result.case.loading))
    inside = equilibrium_matrix(model) @ node_forces.ravel()
    force = (inside + permanent + result.peak_load * reference).reshape(-1, 6)
    for index, piece in enumerate(model.pieces):
        if piece.fixed:
            force[index] = 0.0
    return force


def unbalanced_share(result: CaseResult) -> float:
    """Largest unbalanced force on a piece over the peak load, or moment over that times a."""
    wrench = unbalanced_forces(result)
    force = np.linalg.norm(wrench[:, :3], axis=1).max()
    moment = np.linalg.norm(wrench[:, 3:], axis=1).max()
    return float(max(force, moment / result.case.joint.a)) / result.peak_load
