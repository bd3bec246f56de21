"""Lock weights: the shear that each lock's inner face carries, over its strength.

The paper (section 4) defines the weight of a lock as the mean shear stress on its inner face over
the cohesion. Under torque the resultant can vanish while the stress does not, so the mean
magnitude and the largest value are given as well.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.joint import Joint
from sidmacib.joint.pieces import lock_faces
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.validation import require_positive


@dataclass(frozen=True)
class LockWeight:
    """The shear on the inner face of one lock.

    ``weight``: resultant over the lock's strength. ``mean_shear_ratio``: mean magnitude of the
    shear stress over the cohesion. ``max_shear_ratio``: its largest value over the cohesion.
    ``shear_x_N`` and ``shear_y_N``: the resultant on the piece above the face.
    """

    lock: int
    block: str  # upper or lower
    weight: float
    mean_shear_ratio: float
    max_shear_ratio: float
    shear_x_N: float
    shear_y_N: float


def lock_weights(joint: Joint, assembly: Assembly, force: Floats) -> tuple[LockWeight, ...]:
    """Weights of all locks, by number.

    ``force``: (N, 3) in N, what the piece below each node exerts on the piece above, in the frame
    of the face. ValueError for a lock without cohesion.
    """
    numbers = lock_faces(joint)
    shear = np.einsum("nt,ntx->nx", force[:, 1:], face_frames(assembly)[:, 1:])[:, :2]
    size = np.hypot(shear[:, 0], shear[:, 1])

    def weight(lock: int, nodes: Flags) -> LockWeight:
        require_positive(**{f"cohesion of lock {lock}": joint.inner_of(lock).cohesion})
        x, y = (float(value) for value in shear[nodes].sum(axis=0))
        return LockWeight(
            lock,
            "upper" if joint.is_upper(lock) else "lower",
            float(np.hypot(x, y)) / joint.strength(lock),
            float(size[nodes].sum()) / joint.strength(lock),
            float((size[nodes] / assembly.nodes.area[nodes]).max()) / joint.inner_of(lock).cohesion,
            x,
            y,
        )

    weights = [
        weight(numbers[face.name], assembly.nodes.face == index)
        for index, face in enumerate(assembly.faces)
        if face.name in numbers
    ]
    return tuple(sorted(weights, key=lambda each: each.lock))
