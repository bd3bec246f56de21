"""The first failure of a joint: the load at which a bonded face reaches its strength.

The static model finds it, with the history of friction, on the coarsest nodes that represent all
stresses of a rigid lock: Lobatto points, which integrate linear stresses exactly. Up to this load
it makes no difference how bonds fail.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint.joint import Joint, UpperBody
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble, lock_faces
from sidmacib.mechanics.assembly import Assembly, Floats, Kind, Loads, self_weight
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import FirstFailure, Mode, Solver
from sidmacib.mechanics.static.model import first_failure_of, solver_of
from sidmacib.rule.pairs import bearing_pairs

# Cells along the shorter side of a lock. Two, so that dry faces may open in part; more show how far
# a load depends on them. Elastic blocks cost more, and three nodes a side represent their bending.
COARSE, FINE = 2, 4
FINEST = 6  # for dry faces so stiff that four cells may not be enough
ELASTIC, FINE_ELASTIC = 1, 2


@dataclass(frozen=True)
class JointFailure:
    """The state of a joint at its first failure, lock by lock.

    ``load``: along the direction of loading, N. ``mode``: whether a bond fails there, or the joint
    slides or rocks before one does. ``force_x``, ``force_y`` in N and ``torque`` in
    N m, across each root on the piece above it, shape (n,). ``utilisation``: largest stress over
    strength at each root, shape (n,). ``cut_utilisation``: the same at the cuts between columns.
    """

    load: float
    mode: Mode
    force_x: Floats
    force_y: Floats
    torque: Floats
    utilisation: Floats
    cut_utilisation: float

    @property
    def cut_fails(self) -> bool:
        """Whether a cut between columns fails first."""
        return self.cut_utilisation > self.utilisation.max()


@lru_cache(maxsize=256)  # law, safe rule and explorer need the same results
def first_failure(joint: Joint, loading: Loading, cells: int | None = None) -> JointFailure:
    """The state in which the first face of ``joint`` reaches its strength, or the joint moves away.

    ``cells``: along the shorter side of a lock; None for the least that suffice. ValueError for
    joints that the law does not cover: fewer than two locks, locks that differ, joined columns,
    bonds with friction or without strength. `CapacityError` if no pair of locks bears, or if
    permanent loads alone make the joint fail.
    """
    _require_row(joint)
    if not bearing_pairs(joint, loading.push):
        raise CapacityError(f"law: no pair of {joint.locks} locks bears in this direction")
    cells = cells or (COARSE if joint.elastic is None else ELASTIC)
    assembly = _cut(joint, cells)
    loads = lateral_load(joint, assembly, loading)
    if joint.elastic is None:
        solver: Solver = _rigid(joint, cells).under(loads)
    else:
        solver = solver_of(assembly, loads)
    failure = first_failure_of(solver, loads.scale)
    if not failure.point.load > 0.0:
        raise CapacityError(f"law: {joint.locks} locks fail under their permanent loads alone")
    return _state(joint, assembly, solver.contact_law, failure)


def weakened(joint: Joint, margin: float) -> Joint:
    """``joint`` with all its strengths divided by ``margin``."""
    inner = joint.inner
    weak = replace(
        inner,
        cohesion=inner.cohesion / margin,
        tensile_strength=inner.tensile_strength / margin,
    )
    return replace(joint, inner=weak)


@lru_cache(maxsize=8)  # a curve asks for many directions of one joint
def _cut(joint: Joint, cells: int) -> Assembly:
    """The pieces of ``joint`` with that many ``cells`` along the shorter side of a lock.

    And half of them, at least, along its height, on which first failures may hang as well.
    """
    return assemble(joint, joint.least_side / cells, least=max(1, cells // 2))


@lru_cache(maxsize=8)
def _rigid(joint: Joint, cells: int) -> RigidSolver:
    """A solver of `_cut`, with any loads."""
    assembly = _cut(joint, cells)
    weight = self_weight(assembly.pieces)
    return RigidSolver(assembly, Loads(weight, np.zeros_like(weight), 1.0))


def _state(
    joint: Joint, assembly: Assembly, contact_law: ContactLaw, failure: FirstFailure
) -> JointFailure:
    """Forces and utilisation of the roots of ``joint`` at its ``failure``."""
    point, nodes, roots = failure.point, assembly.nodes, lock_faces(joint)
    of_nodes = utilisation(contact_law, point.state, point.force)
    start = np.searchsorted(nodes.face, np.arange(len(assembly.faces)))
    of_faces = np.maximum.reduceat(of_nodes, start)
    force = np.einsum("nk,nkx->nx", point.force, face_frames(assembly))
    middle = np.array([face.middle for face in assembly.faces])
    arm = nodes.position - middle[nodes.face]
    torque = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    x, y, turned = (np.add.reduceat(each, start) for each in (force[:, 0], force[:, 1], torque))
    locks = {roots[face.name]: i for i, face in enumerate(assembly.faces) if face.name in roots}
    order = [locks[lock] for lock in joint.numbers]
    cuts = [
        of_faces[i]
        for i, face in enumerate(assembly.faces)
        if face.kind is Kind.INNER and face.name not in roots
    ]
    return JointFailure(
        float(point.load),
        failure.mode,
        x[order],
        y[order],
        turned[order],
        of_faces[order],
        max(cuts, default=0.0),
    )


def _require_row(joint: Joint) -> None:
    """ValueError if the law does not cover ``joint``."""
    bond = joint.inner
    faults = (
        (joint.locks < 2, "locks", joint.locks, "at least 2"),
        (bool(joint.different), "different", "locks that differ", "none"),
        (joint.upper_body is UpperBody.JOINED, "upper_body", "joined", "columns or monolithic"),
        (bond.friction > 0.0, "inner.friction", f"{bond.friction:g}", "0"),
        (bond.bond_friction > 0.0, "inner.bond_friction", f"{bond.bond_friction:g}", "0"),
        (bond.cohesion == 0.0, "inner.cohesion", 0, "more than 0"),
        (bond.tensile_strength == 0.0, "inner.tensile_strength", 0, "more than 0"),
    )
    for wrong, name, value, allowed in faults:
        if wrong:
            raise ValueError(f"{name}: must be {allowed} for the law (got {value})")
