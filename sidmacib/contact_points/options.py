"""SiDMACIB's contact points: where the forces between the blocks act on the abstracted plane."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sidmacib.joint.joint import Joint
from sidmacib.mechanics.assembly import Floats
from sidmacib.validation import is_number, refused

NEAREST = 1e-12  # over a: a point that is nearer to the lock's middle lies in it, but for rounding


@dataclass(frozen=True)
class ContactOption:
    """Contact points of every lock, on its centreline.

    ``positions``: distance from the lock's centre over its length a, between -1/2 and 1/2.
    ``portions``: share p of the lock's strength that each point may carry; they add up to 1.
    ValueError if they do not, or differ in number.
    """

    positions: tuple[float, ...]
    portions: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.positions) != len(self.portions):
            raise ValueError(
                f"positions: must be one for each of the {len(self.portions)} portions "
                f"(got {len(self.positions)})"
            )
        if not all(is_number(x) and abs(x) <= 0.5 for x in self.positions):
            raise refused("positions", self.positions, "from -0.5 to 0.5 (of a)")
        if not all(is_number(p) and p >= 0.0 for p in self.portions) or not math.isclose(
            math.fsum(self.portions), 1.0
        ):
            raise refused("portions", self.portions, "shares from 0 to 1 that add up to 1")
        apart = tuple(0.0 if abs(x) < NEAREST else x for x in self.positions)
        object.__setattr__(self, "positions", apart)

    @classmethod
    def pair(cls, distance: float) -> "ContactOption":
        """Two points at ``distance`` (over a) on either side of the lock's centre, half each."""
        return cls((-distance, distance), (0.5, 0.5))


# The paper's four options. It does not print the positions: these are assumptions, ordered as its
# text orders the pure torsion that they give.
OPTIONS = {
    "option1": ContactOption.pair(1 / 2),  # the ends of the lock
    "option2": ContactOption.pair(1 / 3),  # resultants of a linear stress on each half
    "option3": ContactOption.pair(1 / (2 * math.sqrt(3))),  # radius of gyration
    "option4": ContactOption.pair(1 / 4),  # resultants of a uniform stress on each half
}

# These and one more, which studies can name. `bilinear` has three points per lock, as the paper's
# option of that name; the paper prints neither positions nor portions (ASSUMED). A stress that is
# linear from each end to the middle is given by its values at these three places; by tributary
# lengths the middle represents half of the lock, each end a quarter. Without friction M is
# n T0 a / 4 as long as the middles can carry V, up to n T0 / 2; it then falls to 0 at n T0. The
# envelope so has two straight parts.
READY_OPTIONS = {
    **OPTIONS,
    "bilinear": ContactOption((-1 / 2, 0.0, 1 / 2), (1 / 4, 1 / 2, 1 / 4)),
}


@dataclass(frozen=True)
class ContactPoints:
    """Contact points of all locks, one row each."""

    position: Floats  # (N, 3) in m
    lock: NDArray[np.int64]  # (N,) number of the lock, from 1
    portion: Floats  # (N,) share p of the lock's strength


def contact_points(joint: Joint, option: ContactOption) -> ContactPoints:
    """The points of ``option`` on every lock, at mid-height."""
    lock = np.repeat(np.arange(1, joint.locks + 1), len(option.positions))
    position = np.column_stack(
        [
            np.tile(np.array(option.positions) * joint.a, joint.locks),
            np.array([joint.lock_centre_y(int(number)) for number in lock]),
            np.full(len(lock), joint.h / 2),
        ]
    )
    return ContactPoints(position, lock, np.tile(option.portions, joint.locks))
