"""The joint as a chain of springs: seven unknowns for each lock, and stresses in closed form.

Above each lock stands a column of the upper body. A column moves along x and y, tilts about x and
turns about z; a lock moves along x and y and turns about z. What joins them are the faces of the
joint, each with the stiffness of its area and of its second moments: the roots of the locks, the
cuts between columns, and the dry faces between neighbouring locks, which only push and rub. A root
fails where the shear stress at one of its corners reaches the cohesion, a cut where its shear does
or its tension reaches the tensile strength. Locks in a row so share the load as rivets in a lap
joint do (Volkersen, 1938); docs/law.md derives it.

Pieces that bend add the stiffness of the block to the cuts, and make the stress of a root uneven.

Four numbers here are no statics. `LOCK_TILT`, `CUT_SHEAR` and `COLUMN_TILT` stand for motions that
the chain leaves out, `PRESSED` for the forces that hold a tilting column down; they were fitted to
the static model. All other numbers are those of the joint.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.chain.faces import Faces
from sidmacib.chain.pairs import bearing_pairs
from sidmacib.chain.stiffness import UNKNOWNS, add_locks, add_pairs, matrix, outer, row_of
from sidmacib.errors import CapacityError
from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import Loading, LoadShare, Push
from sidmacib.mechanics.assembly import GRAVITY, Failure, Floats
from sidmacib.mechanics.contact_law import Flags

LOCK_TILT = 0.364  # of the tilt of a lock that nothing but its root holds
CUT_SHEAR = 0.178  # of a cut's stiffness against tilt, if columns could not rise
COLUMN_TILT = 0.795  # of a column's stiffness against tilt, if its top could pull as well
PRESSED = 0.45  # of a column's tilting moment over its width: the force on what is below

COLUMN_Y, COLUMN_X, TILT, COLUMN_TURN, LOCK_Y, LOCK_X, LOCK_TURN = range(UNKNOWNS)
POINTS, PARTS = np.polynomial.legendre.leggauss(6)  # of a dry face, along x
STILL = 1e-100  # slip, in m, that counts as none
MOST_STEPS = 300  # until contacts and friction have settled
PATIENCE = 20  # steps before they are averaged more and more
MOST_LOADS = 30  # until the load is that of the first failure
NARROW = 0.05  # part of the interval that is left between a load to try and its ends
SETTLED = 1e-6  # change of a stiffness of friction, over that of the face
NEAR = 5e-3  # the same where friction lets it jump
EXACT = 1e-4  # distance of the first failure from a utilisation of 1, or between two loads
LOOSE = 1e-9  # stiffness, over a root's, of what nothing holds
HELD = 1e-3  # force over the load: where as much hangs on what nothing holds, nothing carries it


@dataclass(frozen=True)
class ChainState:
    """What the roots carry at the first failure, lock by lock: arrays of shape (n,).

    ``load``: along the direction of loading, N. ``force_x``, ``force_y`` in N, ``torque`` in N m.
    ``used``: largest stress of each root over its cohesion. ``cut_used``: the same of the cuts, or
    their tension over their strength; where it is 1 a cut fails first.
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


def first_failure(joint: Joint, loading: Loading, standing: bool = True) -> ChainState:
    """The state in which the first face of ``joint`` reaches its strength.

    ``standing``: whether there is friction above and below the locks, of weight and of what holds
    the joint down; there always is between them.

    ValueError for what is no such chain: fewer than two locks, locks of their own, joined columns
    or bonds that are not brittle. `CapacityError` if no face carries the load.
    """
    _require_chain(joint)
    if not bearing_pairs(joint, loading.push):
        raise CapacityError(f"law: no pair of {joint.locks} locks bears in this direction")
    springs = Springs(joint, loading, standing)
    load = max(joint.strengths)
    moved: Floats | None = None
    low, high = (0.0, 0.0), (np.inf, np.inf)  # loads below and above, with their use
    for _ in range(MOST_LOADS):
        moved = springs.equilibrium(load, moved)
        faces = springs.faces(moved)
        used = faces.used(joint)
        if not 0.0 < used < np.inf or LOOSE * springs.root * np.abs(moved).max() > HELD * load:
            raise CapacityError(f"law: nothing holds {joint.locks} locks in this direction")
        found = abs(used - 1.0) < EXACT
        low, high = ((load, used), high) if used < 1.0 else (low, (load, used))
        if found or (abs(used - 1.0) < NEAR and high[0] < low[0] * (1.0 + EXACT)):
            forces = faces.force_x, faces.force_y, faces.torque
            return ChainState(load, *forces, faces.roots_used(joint), faces.cut_used(joint))
        before, load = load, _next_load(load / used, low, high)
        moved = moved * (load / before)
    raise CapacityError(f"law: contacts and friction of {joint.locks} locks do not settle")


def _next_load(proportional: float, low: tuple[float, float], high: tuple[float, float]) -> float:
    """A load (N) to try: the ``proportional`` one, or one between ``low`` and ``high``.

    Friction that was called up before makes the use rise faster than the load.
    """
    if not low[0] or not np.isfinite(high[0]):
        return proportional
    part = -np.log(low[1]) / np.log(high[1] / low[1])
    return float(low[0] * (high[0] / low[0]) ** np.clip(part, NARROW, 1.0 - NARROW))


def _require_chain(joint: Joint) -> None:
    """ValueError if ``joint`` is not what the chain stands for."""
    faults = (
        (joint.locks < 2, f"locks: {joint.locks}", "at least 2"),
        (bool(joint.different), "different: locks of their own are", "none"),
        (joint.upper_body is UpperBody.JOINED, "upper_body: joined", "columns or monolithic"),
        (joint.failure is not Failure.BRITTLE, f"failure: {joint.failure}", "brittle"),
        (joint.inner.friction > 0.0, f"inner.friction: {joint.inner.friction:g}", "0"),
    )
    for wrong, what, allowed in faults:
        if wrong:
            raise ValueError(f"{what} not possible with the law; it must be {allowed}")


class Springs:
    """Stiffness of the chain of ``joint``, and the loads on it; all in N and m."""

    def __init__(self, joint: Joint, loading: Loading, standing: bool = True) -> None:
        self.joint = joint
        self.count = joint.locks
        pushed = range(self.count) if loading.push is Push.PLUS_Y else range(self.count)[::-1]
        # Seen from the side that is pushed: the chain is the same for both pushes.
        self.upper = np.array([joint.is_upper(lock + 1) for lock in pushed])
        one_piece = joint.upper_body is UpperBody.MONOLITHIC
        self.rigid_body = one_piece and joint.elastic is None
        self.basis = _one_piece(self.count, joint) if self.rigid_body else None
        self.unit = self._loads(loading)
        self.linear = self._linear()
        self.pressing = self._pressing()
        dry = joint.dry
        parts = joint.a * joint.h * PARTS / 2.0
        self.push, self.rub = dry.normal_stiffness * parts, dry.shear_stiffness * parts
        self.stand = dry.shear_stiffness * joint.a * joint.b * standing
        self.pushed_rows, self.rubbed_rows = _contact_rows(joint)
        self.pushed_matrices, self.rubbed_matrices = (
            outer(self.pushed_rows),
            outer(self.rubbed_rows),
        )
        self.standing_rows = _standing_rows(joint, self.upper)
        self.standing_matrices = outer(self.standing_rows).sum(axis=1)

    # --- stiffness ---------------------------------------------------------------------------
    @property
    def leaning_root(self) -> float:
        """Stiffness of a root along y, with the tilt of its lock."""
        joint, law = self.joint, self.joint.inner
        area = joint.a * joint.b
        tilt = LOCK_TILT * 3.0 * (joint.h / joint.b) ** 2 / law.normal_stiffness
        return area / (1.0 / law.shear_stiffness + tilt)

    @property
    def root(self) -> float:
        """Stiffness of a root along x."""
        return self.joint.inner.shear_stiffness * self.joint.a * self.joint.b

    @property
    def turning_root(self) -> float:
        """Stiffness of a root against turning, over a squared."""
        joint = self.joint
        return self.root * (joint.a**2 + joint.b**2) / 12.0 / joint.a**2

    @property
    def cut(self) -> tuple[float, float]:
        """Stiffness between two columns, across and along the cut, with the block that bends."""
        joint, law, block = self.joint, self.joint.inner, self.joint.elastic
        area = joint.a * joint.H
        whole = joint.upper_body is UpperBody.MONOLITHIC
        soft = [0.0, 0.0] if whole else [1.0 / law.normal_stiffness, 1.0 / law.shear_stiffness]
        if block is not None:
            soft[0] += joint.b / block.young
            soft[1] += joint.b * 2.0 * (1.0 + block.poisson) / block.young
        return area / soft[0], area / soft[1]

    def _linear(self) -> Floats:
        """Stiffness matrix (7 n, 7 n) of everything but the dry faces."""
        joint = self.joint
        arm = (joint.H + joint.h) / 2.0 / joint.b
        upper = matrix(
            (self.leaning_root, {COLUMN_Y: 1.0, TILT: -arm, LOCK_Y: -1.0}),
            (self.root, {COLUMN_X: 1.0, LOCK_X: -1.0}),
            (self.turning_root, {COLUMN_TURN: 1.0, LOCK_TURN: -1.0}),
        )
        lower = matrix(
            (self.leaning_root, {LOCK_Y: 1.0}),
            (self.root, {LOCK_X: 1.0}),
            (self.turning_root, {LOCK_TURN: 1.0}),
        )
        top = matrix(
            (COLUMN_TILT * joint.dry.normal_stiffness * joint.a * joint.b / 12.0, {TILT: 1.0})
        )
        whole = np.zeros((self.count * UNKNOWNS,) * 2)
        add_locks(whole, np.where(self.upper[:, None, None], upper, lower) + top)
        if self.rigid_body:
            return whole
        pull, slide = self.cut
        half = joint.b / 2.0 / joint.a
        cut = matrix(
            (pull, {COLUMN_Y: 1.0, UNKNOWNS + COLUMN_Y: -1.0}),
            (pull * (joint.H / joint.b) ** 2 / 12.0, {TILT: 1.0, UNKNOWNS + TILT: -1.0}),
            (pull / 12.0, {COLUMN_TURN: 1.0, UNKNOWNS + COLUMN_TURN: -1.0}),
            (CUT_SHEAR * slide, {TILT: 0.5, UNKNOWNS + TILT: 0.5}),
            (slide, _slip(COLUMN_X, COLUMN_TURN, half)),
            size=2 * UNKNOWNS,
        )
        add_pairs(whole, np.tile(cut, (self.count - 1, 1, 1)))
        return whole

    def _pressing(self) -> Floats:
        """What always presses on each lock's dry faces, N: weight, and what is given on top."""
        joint = self.joint
        area = joint.a * joint.b
        weight = joint.density * GRAVITY * area
        given = (joint.pressing_force or 0.0) / joint.locks
        return given + weight * (joint.H + np.where(self.upper, joint.h, 0.0))

    def _loads(self, loading: Loading) -> Floats:
        """Loads of 1 N along the direction of ``loading``, on the unknowns."""
        joint, direction = self.joint, loading.direction
        on_lock = loading.share is LoadShare.FACE and self.upper[0]
        lock = joint.h / (joint.h + joint.H) if on_lock else 0.0
        unit = np.zeros(self.count * UNKNOWNS)
        unit[[COLUMN_Y, COLUMN_TURN]] = direction.shear, direction.torque
        unit[[LOCK_Y, LOCK_TURN]] = unit[[COLUMN_Y, COLUMN_TURN]] * lock
        unit[[COLUMN_Y, COLUMN_TURN]] *= 1.0 - lock
        return unit

    # --- equilibrium -------------------------------------------------------------------------
    def equilibrium(self, load: float, moved: Floats | None) -> Floats:
        """Movements (7 n,) under ``load`` (N), from a guess; contacts and friction have settled.

        Each step solves for the stiffnesses of the last one. Where they go round in circles, they
        are averaged more and more.
        """
        friction = self.joint.dry.friction
        touching = np.ones((self.count - 1, len(POINTS)))
        rubbing = np.tile(self.rub * (friction > 0.0), (self.count - 1, 1))
        standing = np.full(self.count, self.stand * (friction > 0.0))
        if moved is not None:
            touching = (self._closing(moved) > 0.0).astype(float)
            if friction:
                rubbing, standing = self._friction(moved, load)
        for step in range(MOST_STEPS):
            moved = self._solved(load, touching, rubbing, standing)
            calm = 1.0 if step < PATIENCE else PATIENCE / (step + 1.0)
            now = self._closing(moved) > 0.0
            settled = bool(np.abs(now - touching).max() < SETTLED)
            touching = touching + calm * (now - touching)
            if friction:
                rub, stand = self._friction(moved, load)
                settled &= bool(np.abs(rub - rubbing).max() < SETTLED * self.rub.max())
                settled &= bool(np.abs(stand - standing).max() <= SETTLED * self.stand)
                rubbing = rubbing + calm * (rub - rubbing) / 2.0
                standing = standing + calm * (stand - standing) / 2.0
            if settled:
                break
        assert moved is not None
        return moved

    def _solved(self, load: float, touching: Floats, rubbing: Floats, standing: Floats) -> Floats:
        """Movements for given contacts and stiffnesses of friction."""
        whole = self.linear.copy()
        push = np.tensordot(touching * self.push, self.pushed_matrices, 1)
        push += np.tensordot(touching * rubbing, self.rubbed_matrices, 1)
        add_pairs(whole, push)
        add_locks(whole, standing[:, None, None] * self.standing_matrices)
        force = load * self.unit
        if self.basis is not None:
            whole, force = self.basis.T @ whole @ self.basis, self.basis.T @ force
        whole[np.diag_indices_from(whole)] += LOOSE * self.root
        found = np.linalg.solve(whole, force)
        return np.asarray(found if self.basis is None else self.basis @ found)

    def _closing(self, moved: Floats) -> Floats:
        """How far the locks press into each other, m, at the points of each dry face."""
        return self._pairs(moved) @ self.pushed_rows.T

    def _friction(self, moved: Floats, load: float) -> tuple[Floats, Floats]:
        """Stiffness of friction, between locks and above or below, such that none exceeds mu N."""
        limit = self.joint.dry.friction
        slip = np.abs(self._pairs(moved) @ self.rubbed_rows.T)
        normal = self.push * np.maximum(self._closing(moved), 0.0)
        rubbing = np.minimum(self.rub, limit * normal / np.maximum(slip, STILL))
        slid = np.linalg.norm(
            np.einsum("nij,nj->ni", self.standing_rows, self._locks(moved)), axis=1
        )
        held = limit * (self.pressing + self._pressed(moved, load))
        standing = np.minimum(self.stand, held / np.maximum(slid, STILL))
        return rubbing, standing

    def _pressed(self, moved: Floats, load: float) -> Floats:
        """What presses on each lock's dry faces because the body tilts, N."""
        joint = self.joint
        if self.rigid_body:  # on its far end
            moment = abs(load) * self.unit[[COLUMN_Y, LOCK_Y]].sum() * joint.H / 2.0
            return np.eye(self.count)[-1] * PRESSED * moment / (self.count * joint.b)
        held = COLUMN_TILT * joint.dry.normal_stiffness * joint.a * joint.b / 12.0
        return PRESSED * held * np.abs(self._locks(moved)[:, TILT])

    # --- forces ------------------------------------------------------------------------------
    def faces(self, moved: Floats) -> Faces:
        """Forces in all roots and cuts."""
        joint, own = self.joint, self._locks(moved)
        arm = (joint.H + joint.h) / 2.0 / joint.b
        hung = self.upper
        over = own[:, COLUMN_Y] - arm * own[:, TILT]
        force_y = self.leaning_root * (np.where(hung, over, 0.0) - own[:, LOCK_Y])
        force_x = self.root * (np.where(hung, own[:, COLUMN_X], 0.0) - own[:, LOCK_X])
        turn = self.turning_root * (np.where(hung, own[:, COLUMN_TURN], 0.0) - own[:, LOCK_TURN])
        roots = force_x, force_y, turn * joint.a
        if self.rigid_body:
            return Faces(*roots, *(np.zeros(0),) * 5)
        pull, slide = self.cut
        step = np.diff(own, axis=0)
        mean = (own[1:] + own[:-1]) / 2.0
        return Faces(
            *roots,
            normal=pull * step[:, COLUMN_Y],
            turn=pull / 12.0 * step[:, COLUMN_TURN] * joint.a,
            tilt=pull * (joint.H / joint.b) ** 2 / 12.0 * step[:, TILT] * joint.b,
            slide_x=slide * (step[:, COLUMN_X] + joint.b / joint.a * mean[:, COLUMN_TURN]),
            slide_z=CUT_SHEAR * slide * mean[:, TILT],
        )

    def _locks(self, moved: Floats) -> Floats:
        """Movements lock by lock, shape (n, 7)."""
        return moved.reshape(self.count, UNKNOWNS)

    def _pairs(self, moved: Floats) -> Floats:
        """Movements of each two neighbours, shape (n - 1, 14)."""
        own = self._locks(moved)
        return np.hstack([own[:-1], own[1:]])


def _slip(along: int, turn: int, half: float) -> dict[int, float]:
    """Slip along x between neighbours ``half`` a width (over a) from the face between them."""
    return {along: -1.0, UNKNOWNS + along: 1.0, turn: half, UNKNOWNS + turn: half}


def _contact_rows(joint: Joint) -> tuple[Floats, Floats]:
    """How far neighbouring locks press into each other, and slip along x, at each point."""
    size = 2 * UNKNOWNS
    push = [
        row_of({LOCK_Y: 1.0, LOCK_TURN: x, UNKNOWNS + LOCK_Y: -1.0, UNKNOWNS + LOCK_TURN: -x}, size)
        for x in POINTS / 2.0
    ]
    slip = row_of(_slip(LOCK_X, LOCK_TURN, joint.b / 2.0 / joint.a), size)
    return np.array(push), np.tile(slip, (len(POINTS), 1))


def _standing_rows(joint: Joint, upper: Flags) -> Floats:
    """Slip of each lock's horizontal dry face along y and x, shape (n, 2, 7).

    An upper lock slips on the lower block, a column on its lower lock.
    """
    hung = [{LOCK_Y: 1.0}, {LOCK_X: 1.0}]
    borne = [
        {COLUMN_Y: 1.0, TILT: -joint.H / 2.0 / joint.b, LOCK_Y: -1.0},
        {COLUMN_X: 1.0, LOCK_X: -1.0},
    ]
    return np.array([[row_of(row, UNKNOWNS) for row in (hung if up else borne)] for up in upper])


def _one_piece(count: int, joint: Joint) -> Floats:
    """The unknowns from the three of a rigid body and those of locks, shape (7 n, 3 + 3 n)."""
    basis = np.zeros((count, UNKNOWNS, 3 + 3 * count))
    lock = np.arange(count)
    basis[:, COLUMN_Y, 0] = basis[:, COLUMN_X, 1] = basis[:, COLUMN_TURN, 2] = 1.0
    basis[:, COLUMN_X, 2] = -(lock - (count - 1) / 2.0) * joint.b / joint.a
    for place, unknown in enumerate((LOCK_Y, LOCK_X, LOCK_TURN)):
        basis[lock, unknown, 3 + 3 * lock + place] = 1.0
    return basis.reshape(count * UNKNOWNS, -1)
