"""The first failure of a joint: the load at which a bonded face reaches its strength.

It is found by the static model's path of loading, so friction has its history, on the coarsest
nodes that have all stresses of a rigid lock: Lobatto points, which add up stresses that vary
linearly over a face exactly. Up to there it makes no difference how bonds fail.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import Loading, lateral_load
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law import ContactLaw, utilisation
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static.model import static_first_failure
from sidmacib.pieces import assemble, lock_faces
from sidmacib.rule.pairs import bearing_pairs


@dataclass(frozen=True)
class Fineness:
    """``cells`` along the shorter side of a lock; largest ``increment`` of the load over T0."""

    cells: int
    increment: float


# Two cells, so that dry faces may open in part; the finer ones, on smaller increments that follow
# friction more closely, show how far a load depends on both. Blocks that bend cost more, and three
# nodes a side see them bend.
COARSE, FINE, BENDING = Fineness(2, 0.1), Fineness(4, 0.05), Fineness(1, 0.1)


@dataclass(frozen=True)
class JointFailure:
    """What a joint carries at its first failure, lock by lock.

    ``load``: along the direction of loading, N. ``force_x``, ``force_y`` in N and ``torque`` in
    N m, across each root on what is above it, shape (n,). ``used``: largest stress over strength at
    each root, shape (n,). ``cut_used``: the same of the cuts; where it is 1 a cut fails first.
    """

    load: float
    force_x: Floats
    force_y: Floats
    torque: Floats
    used: Floats
    cut_used: float

    @property
    def cut_fails(self) -> bool:
        """Whether it is a cut between columns that fails first."""
        return self.cut_used > self.used.max()


@lru_cache(maxsize=256)  # law, safe rule and explorer ask for the same
def first_failure(joint: Joint, loading: Loading, fineness: Fineness | None = None) -> JointFailure:
    """The state in which the first face of ``joint`` reaches its strength.

    ``fineness``: None: the coarsest that will do. ValueError for what the law is not made for:
    fewer than two locks, locks of their own, joined columns or bonds without strength.
    `CapacityError` if no face carries the load, or if the joint slides or rocks before a bond
    fails.
    """
    _require_row(joint)
    if not bearing_pairs(joint, loading.push):
        raise CapacityError(f"law: no pair of {joint.locks} locks bears in this direction")
    fineness = fineness or (COARSE if joint.elastic is None else BENDING)
    assembly = assemble(joint, joint.least_side / fineness.cells)
    loads = lateral_load(joint, assembly, loading)
    found = static_first_failure(assembly, loads, increment=fineness.increment)
    if not found.point.load > 0.0:
        raise CapacityError(f"law: {joint.locks} locks fail under their permanent loads alone")
    if not found.failing.any():
        raise CapacityError(
            f"law: {joint.locks} locks move off ({found.mode}) at {found.point.load:.4g} N, before "
            "a bond fails; use the static model"
        )
    return _state(joint, assembly, found.point)


def _state(joint: Joint, assembly: Assembly, point: Equilibrium) -> JointFailure:
    """What the roots of ``joint`` carry at ``point``."""
    nodes, roots = assembly.nodes, lock_faces(joint)
    own = utilisation(ContactLaw.of(assembly), point.state, point.force)
    start = np.searchsorted(nodes.face, np.arange(len(assembly.faces)))
    used = np.maximum.reduceat(own, start)
    force = np.einsum("nk,nkx->nx", point.force, face_frames(assembly))
    middle = np.array([(np.array(face.low) + face.high) / 2 for face in assembly.faces])
    arm = nodes.position - middle[nodes.face]
    torque = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    x, y, turned = (np.add.reduceat(each, start) for each in (force[:, 0], force[:, 1], torque))
    locks = {roots[face.name]: i for i, face in enumerate(assembly.faces) if face.name in roots}
    order = [locks[lock] for lock in joint.numbers]
    cuts = [
        used[i]
        for i, face in enumerate(assembly.faces)
        if face.kind is Kind.INNER and face.name not in roots
    ]
    return JointFailure(
        float(point.load), x[order], y[order], turned[order], used[order], max(cuts, default=0.0)
    )


def _require_row(joint: Joint) -> None:
    """ValueError if ``joint`` is not what the law is made for."""
    bond = joint.inner
    faults = (
        (joint.locks < 2, f"locks: {joint.locks}", "at least 2"),
        (bool(joint.different), "different: locks of their own", "none"),
        (joint.upper_body is UpperBody.JOINED, "upper_body: joined", "columns or monolithic"),
        (bond.friction > 0.0, f"inner.friction: {bond.friction:g}", "0"),
        (bond.cohesion == 0.0, "inner.cohesion: 0", "more than 0"),
        (bond.tensile_strength == 0.0, "inner.tensile_strength: 0", "more than 0"),
    )
    for wrong, what, allowed in faults:
        if wrong:
            raise ValueError(f"{what} not possible with the law; it must be {allowed}")
