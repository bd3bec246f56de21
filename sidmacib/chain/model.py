"""The joint as a chain: rigid bodies between the springs of whole faces.

Each lock is a rigid body, and so is the column of the upper body above it; a body in one piece
moves as one. What joins them are the joint's faces: bonded ones with the stiffness of their area
and of its second moments, dry ones, which only push and rub, at Gauss points. So there is no mesh,
and no number in it that is not the joint's. Pieces that bend add the stiffness of the block to the
cuts, and make the stress of a root uneven.

Locks in a row so share the load as rivets in a lap joint do (Volkersen, 1938); docs/law.md derives
it. The chain is seen from the side that is pushed, so that both pushes are alike.
"""

from functools import cached_property

import numpy as np

from sidmacib.chain.contacts import Contacts
from sidmacib.chain.faces import Bond, concentrations
from sidmacib.chain.movement import UNKNOWNS, Body, Rectangle, across, displacements
from sidmacib.chain.unknowns import of_columns, of_neighbours, of_one_piece
from sidmacib.joint import Joint, UpperBody
from sidmacib.loading import Loading, LoadShare, Push
from sidmacib.mechanics.assembly import GRAVITY, Floats
from sidmacib.mechanics.contact_law import Flags

X, Y, Z = range(3)
BETWEEN = (6, 3)  # Gauss points between two locks, along x and z
ABOVE = (4, 6)  # and on a horizontal face, along x and y
LOOSE = 1e-9  # stiffness, over a root's, of what nothing holds


class ChainModel:
    """Stiffness of the chain of ``joint``, and the loads on it; in N and m.

    ``standing``: whether there is friction above and below the locks; there always is between them.

    ``own``: the movements of each column and its lock, from the unknowns; ``pairs``: of each two
    neighbours. A body in one rigid piece has the unknowns of one column.
    """

    def __init__(self, joint: Joint, loading: Loading, standing: bool = True) -> None:
        self.joint = joint
        self.count = joint.locks
        pushed = range(self.count) if loading.push is Push.PLUS_Y else range(self.count)[::-1]
        self.upper: Flags = np.array([joint.is_upper(lock + 1) for lock in pushed])
        self.standing = standing
        self.column = Body(0, (0.0, 0.0, joint.h + joint.H / 2.0))
        self.lock = Body(1, (0.0, 0.0, joint.h / 2.0))
        self.rigid = joint.upper_body is UpperBody.MONOLITHIC and joint.elastic is None
        self.weight, self.unit = self._weight(), self._unit(loading)
        count, b = self.count, joint.b
        self.own = of_one_piece(count, b) if self.rigid else of_columns(count)
        self.pairs = of_neighbours(self.own)

    # --- bonds -------------------------------------------------------------------------------
    @cached_property
    def root(self) -> Bond:
        """The face across which a lock meets its own block."""
        joint, law = self.joint, self.joint.inner
        face = Rectangle((0.0, 0.0, 0.0), Z, (joint.a, joint.b))
        return Bond(face, law.normal_stiffness, law.shear_stiffness)

    @cached_property
    def cut(self) -> Bond:
        """The face between two columns, with the block that bends."""
        joint, law, block = self.joint, self.joint.inner, self.joint.elastic
        whole = joint.upper_body is UpperBody.MONOLITHIC
        soft = [0.0, 0.0] if whole else [1.0 / law.normal_stiffness, 1.0 / law.shear_stiffness]
        if block is not None:
            soft[0] += joint.b / block.young
            soft[1] += joint.b * 2.0 * (1.0 + block.poisson) / block.young
        face = Rectangle((0.0, joint.b / 2.0, joint.h + joint.H / 2.0), Y, (joint.a, joint.H))
        return Bond(face, 1.0 / soft[0], 1.0 / soft[1])

    @cached_property
    def root_rows(self) -> Floats:
        """What each lock's own unknowns do across its root, shape (n, 6, 12)."""
        joint, (a, b) = self.joint, self.root.face.sides
        head = Rectangle((0.0, 0.0, joint.h), Z, (a, b))
        hung = across(head, self.lock, self.column, 2, b)
        borne = across(self.root.face, None, self.lock, 2, b)
        return np.where(self.upper[:, None, None], hung, borne)

    @cached_property
    def cut_rows(self) -> Floats:
        """What the unknowns of two neighbours do across the cut between them, shape (6, 24)."""
        near, far, _, _ = self._neighbours
        return across(self.cut.face, near, far, 4, self.joint.b)

    @cached_property
    def _neighbours(self) -> tuple[Body, Body, Body, Body]:
        """Columns and locks of two neighbours: near column, far column, near lock, far lock."""
        column, lock, b = self.column.centre, self.lock.centre, self.joint.b
        far = [(x, y + b, z) for x, y, z in (column, lock)]
        return Body(0, column), Body(2, far[0]), Body(1, lock), Body(3, far[1])

    @property
    def loose(self) -> float:
        """Stiffness on every movement, N/m: next to nothing, but what nothing holds stays near."""
        return LOOSE * self.joint.inner.shear_stiffness * self.root.face.area

    @cached_property
    def own_stiffness(self) -> Floats:
        """Of each lock with its column: root, and next to nothing on all; (n, 12, 12)."""
        rows = self.root_rows
        stiff = np.matmul(rows.transpose(0, 2, 1) * self.root.stiffness, rows)
        return stiff + self.loose * np.eye(2 * UNKNOWNS)

    @cached_property
    def pair_stiffness(self) -> Floats:
        """Of the cut between two neighbours; (24, 24)."""
        if self.rigid:
            return np.zeros((4 * UNKNOWNS,) * 2)
        return (self.cut_rows.T * self.cut.stiffness) @ self.cut_rows

    # --- contacts ----------------------------------------------------------------------------
    @cached_property
    def between(self) -> Contacts:
        """The dry faces between neighbouring locks."""
        joint, (_, _, near, far) = self.joint, self._neighbours
        face = Rectangle((0.0, joint.b / 2.0, joint.h / 2.0), Y, (joint.a, joint.h))
        points, areas = face.points(BETWEEN)
        rows = displacements(near, points, 4, joint.b) - displacements(far, points, 4, joint.b)
        return Contacts.of(rows[None, :, [Y, X, Z]], areas, joint.dry, joint.dry.friction)

    @cached_property
    def standing_on(self) -> Contacts:
        """The horizontal dry faces: of an upper lock below, of a lower lock above."""
        joint, lever = self.joint, self.joint.b
        foot, areas = self._level(0.0)
        head, _ = self._level(joint.h)
        below = -displacements(self.lock, foot, 2, lever)
        above = displacements(self.lock, head, 2, lever)
        above -= displacements(self.column, head, 2, lever)
        rows = np.where(self.upper[:, None, None, None], below, above)[:, :, [Z, X, Y]]
        return Contacts.of(rows, areas, joint.dry, joint.dry.friction * self.standing)

    @cached_property
    def under_plate(self) -> Contacts:
        """The top of the columns, under a plate without friction; without a plate it is nothing."""
        joint = self.joint
        points, areas = self._level(joint.h + joint.H)
        rows = displacements(self.column, points, 2, joint.b)[None, :, [Z, X, Y]]
        return Contacts.of(rows, areas * (joint.pressing_force is None), joint.dry, 0.0)

    def _level(self, height: float) -> tuple[Floats, Floats]:
        """Points of a lock's horizontal face at a ``height`` (m), and their areas (m2)."""
        face = Rectangle((0.0, 0.0, height), Z, self.root.face.sides)
        return face.points(ABOVE)

    # --- loads -------------------------------------------------------------------------------
    def _weight(self) -> Floats:
        """What always acts: weight, and what is given on top; (n, 12) in N."""
        joint = self.joint
        per_height = joint.density * GRAVITY * joint.a * joint.b
        given = (joint.pressing_force or 0.0) / joint.locks
        weight = np.zeros((self.count, 2 * UNKNOWNS))
        weight[:, Z] = -given - per_height * joint.H
        weight[:, UNKNOWNS + Z] = -per_height * joint.h
        return weight

    def _unit(self, loading: Loading) -> Floats:
        """Loads of 1 N along the direction of ``loading``; (n, 12) in N."""
        joint, direction = self.joint, loading.direction
        on_lock = loading.share is LoadShare.FACE and bool(self.upper[0])
        lock = joint.h / (joint.h + joint.H) if on_lock else 0.0
        unit = np.zeros((self.count, 2 * UNKNOWNS))
        for start, part in ((0, 1.0 - lock), (UNKNOWNS, lock)):
            unit[0, start + Y] = direction.shear * part
            unit[0, start + UNKNOWNS // 2 + Z] = direction.torque * joint.a / joint.b * part
        return unit

    # --- use of strength ---------------------------------------------------------------------
    def root_forces(self, unknowns: Floats) -> Floats:
        """Forces (N) and moments (N m) across the roots, on what is above them: (n, 6)."""
        moved = self.own.movements(unknowns)
        return np.matmul(self.root_rows, moved[:, :, None])[:, :, 0] * self.root.stiffness

    def roots_used(self, unknowns: Floats) -> Floats:
        """Largest stress over strength at the corners of each root, shape (n,)."""
        law, uneven = self.joint.inner, concentrations(self.joint)
        return self.root.used(self.root_forces(unknowns), law, uneven)

    def cut_used(self, unknowns: Floats) -> float:
        """The same of all cuts together; a body in one piece has none, though it may bend."""
        if self.joint.upper_body is UpperBody.MONOLITHIC:
            return 0.0
        forces = self.pairs.movements(unknowns) @ self.cut_rows.T * self.cut.stiffness
        return float(self.cut.used(forces, self.joint.inner).max())
