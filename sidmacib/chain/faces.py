"""Bonded faces of the chain: their stiffness as a whole, and how far forces use their strength."""

import math
from dataclasses import dataclass

import numpy as np

from sidmacib.chain.movement import Rectangle, corners
from sidmacib.joint import Joint
from sidmacib.mechanics.assembly import FaceMaterial, Floats

# Of pieces that bend: x squared over Ks b2 / (E h). Fitted to the static model, as no beam or plate
# has the proportions of a lock.
SHEAR_LAG = 0.87
TURN_LAG = 1.74


@dataclass(frozen=True)
class Bond:
    """A bonded face: stiffness per area (Pa/m) along its normal and across it."""

    face: Rectangle
    normal_stiffness: float
    shear_stiffness: float

    @property
    def stiffness(self) -> Floats:
        """Of relative displacements (N/m) and rotations (N m) at the centre, shape (6,)."""
        face, (one, two) = self.face, self.face.along
        squares = {axis: side**2 / 12.0 for axis, side in zip(face.along, face.sides, strict=True)}
        own = np.empty(6)
        own[[one, two]] = self.shear_stiffness
        own[face.normal] = self.normal_stiffness
        own[[3 + one, 3 + two]] = self.normal_stiffness * np.array([squares[two], squares[one]])
        own[3 + face.normal] = self.shear_stiffness * math.fsum(squares.values())
        return own * face.area

    def used(
        self, forces: Floats, law: FaceMaterial, uneven: tuple[float, float] = (1.0, 1.0)
    ) -> Floats:
        """The largest of shear and tension over strength at the corners, shape (N,).

        ``forces`` (N) and moments (N m) at the centre, (N, 6). ``uneven``: the stress at the end
        over that of a rigid piece, from shear and from turning, see `concentrations`.
        """
        face, (one, two) = self.face, self.face.along
        first, second = face.sides
        along, turned = uneven
        turn = turned * 12.0 * forces[:, 3 + face.normal] / (first**2 + second**2)
        shear = [
            np.hypot(along * forces[:, one] - turn * y, along * forces[:, two] + turn * x)
            for x, y in corners(face)
        ]
        bent = 6.0 * (np.abs(forces[:, 3 + one]) / second + np.abs(forces[:, 3 + two]) / first)
        pull = forces[:, face.normal] + bent
        used = np.max(shear, axis=0) / law.cohesion, pull / law.tensile_strength
        return np.asarray(np.maximum(*used) / face.area)


def concentrations(joint: Joint) -> tuple[float, float]:
    """Stress at the end of a root over that under a rigid lock: from shear, and from turning.

    x coth x, the shear lag of a plate that is bonded at one end: the stiffer the root for its lock,
    the more uneven is its stress.
    """
    if joint.elastic is None:
        return 1.0, 1.0
    ratio = joint.inner.shear_stiffness * joint.b**2 / (joint.elastic.young * joint.h)
    shear, turn = (np.sqrt(lag * ratio) for lag in (SHEAR_LAG, TURN_LAG))
    return float(shear / np.tanh(shear)), float(turn / np.tanh(turn))
