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

from sidmacib.capacity import solve
from sidmacib.discretisation import Block, Discretisation, Floats, Kind
from sidmacib.equilibrium import equilibrium_matrix, free_rows, permanent_and_reference
from sidmacib.loading import PieceLoad


@dataclass(frozen=True)
class LimitState:
    """The limit load, and forces that carry it; there are many such forces.

    ``load``: along the direction, in N. ``force``: (N, 3) in N, what the piece below each node
    exerts on the piece above, in the frame of the face (normal, two tangents).
    """

    load: float
    force: Floats


def limit_load(
    model: Discretisation,
    loads: tuple[PieceLoad, ...],
    *,
    friction: bool = False,
    overload: float | None = None,
) -> LimitState:
    """The largest multiple of ``loads`` that ``model`` carries.

    ``overload`` (N, down, shared by the pieces under the plate) takes the plate's place. Associated
    friction needs it: a fixed plate can press as hard as it likes, and so friction has no limit.
    ValueError without; `sidmacib.capacity.CapacityError` where there is no largest load.
    """
    if friction and overload is None:
        raise ValueError(
            "overload: got None, allowed with friction is a force in N: under a fixed plate "
            "associated friction has no limit"
        )
    rows = free_rows(model)
    balance = equilibrium_matrix(model)[rows]
    permanent, reference = permanent_and_reference(model, loads)
    if overload is not None:
        bodies = [i for i, p in enumerate(model.pieces) if p.block is Block.UPPER and not p.lock]
        permanent[6 * np.array(bodies) + 2] -= overload / len(bodies)

    kinds = np.array([str(face.kind) for face in model.faces])[model.nodes.face]
    area, count = model.nodes.area, len(model.nodes.area)
    load, force = cp.Variable(), cp.Variable((count, 3))
    normal, shear = force[:, 0], force[:, 1:]
    constraints = [
        # The pieces below get the opposite of ``force``: hence no minus on this side.
        balance @ cp.vec(force, order="C") == permanent[rows] + load * reference[rows]
    ]
    for kind in Kind:
        own = np.flatnonzero(kinds == kind)
        law = model.material(kind)
        size = cp.norm(shear[own], 2, axis=1)
        if kind is Kind.INNER:
            constraints += [size <= law.cohesion * area[own]]
            constraints += [normal[own] >= -law.tensile_strength * area[own]]
        elif kind is Kind.DRY and friction:
            constraints += [size <= law.friction * normal[own]]
        else:
            constraints += [shear[own] == 0, normal[own] >= 0]
        if kind is Kind.PLATE and overload is not None:
            constraints += [normal[own] == 0]
    problem = cp.Problem(cp.Maximize(load), constraints)
    solve(problem, "limit analysis of the whole joint", cp.CLARABEL)
    return LimitState(float(load.value), np.array(force.value))
