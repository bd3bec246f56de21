"""Resultants and utilisation of each interface of a structure, from forces at nodes."""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Face, Floats, Vector
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.polygons import hull_sides

ROUNDING = 1e-9  # of the largest node force: nodes below carry nothing
LEVERAGE = 1e-3  # of all normal forces: what they add up to, if they act anywhere


@dataclass(frozen=True)
class InterfaceForce:
    """Forces that an interface carries.

    ``normal``: compression in N, negative in tension; ``shear``: size of the resultant along the
    interface, N. ``eccentricity``: of the resultant from the centroid, over the distance to the
    edge that way: 1 where it acts at the edge, as in a hinge; None where it acts nowhere.
    ``utilisation``, 1 at failure: where any of it is bonded, shear or tension over strength at the
    bonded node that is used most; of a dry interface the larger of the eccentricity and of shear
    and torsion over what friction allows. Forces at dry nodes are not unique, resultants are.
    ``bonded``: the part of its area that is bonded. ``resultant``: of the forces on the block
    above, N, along x, y and z. ``at``: the point (m) of the interface's plane through which it
    acts, torsion apart; None where compression and tension leave next to none of either.
    """

    name: str
    normal: float
    shear: float
    eccentricity: float | None
    utilisation: float
    bonded: float
    resultant: Vector
    at: Vector | None


def interface_forces(
    assembly: Assembly, force: Floats, state: NodeState | None = None
) -> tuple[InterfaceForce, ...]:
    """Resultants of each face of ``assembly`` under node forces, (N, 3) in N as in `Equilibrium`.

    ``state``: of the nodes; by default all bonds are whole.
    """
    law, area = ContactLaw.of(assembly), assembly.nodes.area
    limit = law.friction * force[:, 0]
    state = state or NodeState.initial(law)
    used = np.where(state.bonded, utilisation(law, state, force), 0.0)
    nothing = ROUNDING * float(np.abs(force).max(initial=0.0))
    found = []
    for number, face in enumerate(assembly.faces):
        nodes = assembly.nodes.face == number
        whole = force[nodes].sum(axis=0)
        normal, *shear = whole.tolist()
        bonded = float(area[nodes & state.bonded].sum() / area[nodes].sum())
        places = assembly.nodes.position[nodes]
        at = _centre(places, force[nodes, 0])
        off = None if at is None else _eccentricity(face, np.array(at))
        most = float(used[nodes].max())
        if not bonded and at is not None and normal > nothing:
            rubbing = _rubbing(face, places - np.array(at), force[nodes], limit[nodes], nothing)
            most = max(off or 0.0, rubbing)
        found.append(
            InterfaceForce(
                face.name,
                normal,
                float(np.hypot(*shear)),
                off,
                most,
                bonded,
                _vector(whole @ face.axes),
                at,
            )
        )
    return tuple(found)


def _eccentricity(face: Face, at: Floats) -> float:
    """Distance of the point ``at`` (m) from the middle of a face, over that of the edge beyond."""
    middle = np.array(face.middle)
    flat = (face.corners - middle) @ face.axes[1:].T
    outward, reach = hull_sides(flat)
    return float((outward @ (face.axes[1:] @ (at - middle)) / reach).max())


def _rubbing(face: Face, arms: Floats, force: Floats, limit: Floats, nothing: float) -> float:
    """Shear, and torsion about the point of action, over what friction allows.

    Both together on an ellipse, which is near what a face that slides and turns carries.
    ``arms``: of the nodes from there, m, (K, 3); ``force``: of the nodes, N, (K, 3); ``limit``: of
    their friction, N, (K,).
    """
    flat = arms @ face.axes[1:].T
    torsion = abs(float((flat[:, 0] * force[:, 2] - flat[:, 1] * force[:, 1]).sum()))
    lever = np.hypot(*flat.T)
    reach = float(lever.max())
    pairs = (
        (float(np.hypot(*force[:, 1:].sum(axis=0))), float(limit.sum()), nothing),
        (torsion, float((limit * lever).sum()), nothing * reach),
    )
    return math.hypot(
        *(
            (demand / limit if limit > 0.0 else math.inf) if demand > least else 0.0
            for demand, limit, least in pairs
        )
    )


def _centre(places: Floats, normal: Floats) -> Vector | None:
    """Centre of normal forces, (N,) in N, at ``places``, (N, 3) in m; None if they add up to 0."""
    whole = float(normal.sum())
    if abs(whole) <= LEVERAGE * float(np.abs(normal).sum()):
        return None
    return _vector(normal @ places / whole)


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
