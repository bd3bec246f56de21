"""Limit analysis of the whole joint: pieces and nodes of the distinct elements, rigid-plastic.

The static theorem: the largest load for which node forces exist that keep every piece in
equilibrium and no strength exceeded. At inner nodes |s_t| <= tau A and s_n >= -sigma A; dry nodes
cannot pull, and resist along the face only where friction is asked for, |s_t| <= mu s_n
(associated: sliding would dilate, so it overestimates). Forces can be redistributed freely: every
lock is used as far as the geometry allows, with no reduction rule put in. One convex programme,
solved by Clarabel.
"""

from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Loads
from sidmacib.mechanics.contact_law import NodeLaw
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows
from sidmacib.mechanics.optimisation import solve


@dataclass(frozen=True)
class LimitState:
    """The limit load, and forces that carry it; there are many such forces.

    ``load``: along the direction, in N. ``force``: (N, 3) in N, what the piece below each node
    exerts on the piece above, in the frame of the face (normal, two tangents).
    """

    load: float
    force: Floats


def limit_load(assembly: Assembly, loads: Loads, *, friction: bool = False) -> LimitState:
    """The largest multiple of the variable ``loads`` that ``assembly`` carries.

    Associated friction has no limit under a fixed plate, which can press as hard as it likes: put a
    force in its place, see `sidmacib.loading.pressed`. ValueError otherwise;
    `sidmacib.errors.CapacityError` where there is no largest load.
    """
    if friction and any(face.kind is Kind.PLATE for face in assembly.faces):
        raise ValueError(
            "friction: got True, allowed under a fixed plate is False: associated friction has no "
            "limit there; put a force in its place"
        )
    rows = free_rows(assembly)
    balance = equilibrium_matrix(assembly)[rows]
    law = NodeLaw.of(assembly)
    load, force = cp.Variable(), cp.Variable((len(law.friction), 3))
    normal, shear = force[:, 0], force[:, 1:]
    inner = np.flatnonzero(law.cohesive)
    rough = np.flatnonzero(~law.cohesive & friction & (law.friction > 0.0))
    smooth = np.setdiff1d(np.flatnonzero(~law.cohesive), rough)

    def size(own: NDArray[np.int64]) -> cp.Expression:
        return cp.norm(shear[own], 2, axis=1)

    target = loads.permanent.ravel()[rows] + load * loads.variable.ravel()[rows]
    constraints = [
        # The pieces below get the opposite of ``force``: hence no minus on this side.
        balance @ cp.vec(force, order="C") == target,
        size(inner) <= law.shear_strength[inner],
        normal[inner] >= -law.tensile_strength[inner],
        size(rough) <= cp.multiply(law.friction[rough], normal[rough]),
        shear[smooth] == 0,
        normal[smooth] >= 0,
    ]
    problem = cp.Problem(cp.Maximize(load), constraints)
    solve(problem, "limit analysis of the whole joint", cp.CLARABEL)
    return LimitState(float(load.value), np.array(force.value))
