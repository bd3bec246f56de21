"""Forces in the faces of the chain of springs, and how far they use the faces' strength."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from sidmacib.joint import Joint, UpperBody
from sidmacib.mechanics.assembly import Floats

# Of pieces that bend: x squared over Ks b2 / (E h). Fitted to the static model, as no beam or plate
# has the proportions of a lock.
SHEAR_LAG = 0.87
TURN_LAG = 1.74
SIGNS = (-1.0, 1.0)


@dataclass(frozen=True)
class Faces:
    """Forces (N) and moments (N m) in roots, shape (n,), and in cuts, shape (n - 1,).

    Of a cut: ``normal`` is a pull, ``turn`` and ``tilt`` bend it about z and x, ``slide_x`` and
    ``slide_z`` shear it. A body of one rigid piece has no cuts.
    """

    force_x: Floats
    force_y: Floats
    torque: Floats
    normal: Floats
    turn: Floats
    tilt: Floats
    slide_x: Floats
    slide_z: Floats

    def used(self, joint: Joint) -> float:
        """The largest utilisation of any face: 1 is the first failure."""
        return max(self.root_used(joint), self.cut_used(joint))

    def root_used(self, joint: Joint) -> float:
        """The largest shear stress at a corner of any root, over the cohesion."""
        return float(self.roots_used(joint).max())

    def roots_used(self, joint: Joint) -> Floats:
        """The largest shear stress at a corner of each root, over the cohesion, shape (n,)."""
        area, polar = joint.a * joint.b, joint.a * joint.b * (joint.a**2 + joint.b**2) / 12.0
        mean, turn = concentrations(joint)
        force_x, force_y = mean * self.force_x / area, mean * self.force_y / area
        torque = turn * self.torque / polar
        shear = [
            np.hypot(force_x - torque * y * joint.b / 2.0, force_y + torque * x * joint.a / 2.0)
            for x, y in product(SIGNS, SIGNS)
        ]
        return np.asarray(np.max(shear, axis=0) / joint.inner.cohesion)

    def cut_used(self, joint: Joint) -> float:
        """The largest use of a cut's tensile strength, at a corner, or of its cohesion.

        A body of one piece has none, though it may bend.
        """
        if joint.upper_body is UpperBody.MONOLITHIC:
            return 0.0
        a, height, law = joint.a, joint.H, joint.inner
        bent = 6.0 * np.abs(self.turn) / (height * a**2) + 6.0 * np.abs(self.tilt) / (a * height**2)
        pull = (self.normal / (a * height) + bent).max()
        shear = np.hypot(self.slide_x, self.slide_z).max() / (a * height)
        torn = pull / law.tensile_strength if law.tensile_strength else np.inf * max(pull, 0.0)
        return float(max(torn, shear / law.cohesion))


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
