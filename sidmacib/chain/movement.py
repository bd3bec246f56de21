"""Small movements of the chain's rigid bodies, and what they do at points and across faces."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from sidmacib.mechanics.assembly import Floats, Vector

UNKNOWNS = 6  # of a body, in m: along x, y, z, and the rotation about each times the lever


@dataclass(frozen=True)
class Body:
    """A rigid body among the ``number`` th unknowns of its group; its centre in m."""

    number: int
    centre: Vector


@dataclass(frozen=True)
class Rectangle:
    """A face: its centre, the axis of its normal, and its sides (m) along the two others, in order.

    The axes are 0, 1, 2 for x, y, z.
    """

    centre: Vector
    normal: int
    sides: tuple[float, float]

    @property
    def along(self) -> tuple[int, int]:
        """The axes of its sides."""
        first, second = (axis for axis in range(3) if axis != self.normal)
        return first, second

    @property
    def area(self) -> float:
        """In m2."""
        return self.sides[0] * self.sides[1]

    def points(self, counts: tuple[int, int]) -> tuple[Floats, Floats]:
        """Gauss points (P, 3) in m, so many along each side, and the area (P,) of each in m2."""
        (one, one_part), (two, two_part) = map(np.polynomial.legendre.leggauss, counts)
        points = np.tile(np.array(self.centre), (counts[0] * counts[1], 1))
        points[:, self.along] += np.array(np.meshgrid(one, two, indexing="ij")).reshape(2, -1).T * (
            np.array(self.sides) / 2.0
        )
        return points, self.area * np.outer(one_part, two_part).ravel() / 4.0


def displacements(body: Body | None, points: Floats, bodies: int, lever: float) -> Floats:
    """Displacement of each point (P, 3) from the unknowns of a group of bodies: (P, 3, W).

    None: the ground, which does not move.
    """
    rows = np.zeros((len(points), 3, bodies * UNKNOWNS))
    if body is not None:
        start = body.number * UNKNOWNS
        arm = (points - np.array(body.centre)) / lever
        for axis in range(3):
            rows[:, axis, start + axis] = 1.0
            one, two = (axis + 1) % 3, (axis + 2) % 3
            rows[:, axis, start + 3 + one] = arm[:, two]
            rows[:, axis, start + 3 + two] = -arm[:, one]
    return rows


def across(face: Rectangle, below: Body | None, above: Body, bodies: int, lever: float) -> Floats:
    """Relative displacement and rotation of ``above`` at the centre of a face: (6, W).

    ``below`` and ``above`` as seen along the face's normal.
    """
    centre = np.array([face.centre])
    rows = np.zeros((2 * 3, bodies * UNKNOWNS))
    for body, sign in ((above, 1.0), (below, -1.0)):
        rows[:3] += sign * displacements(body, centre, bodies, lever)[0]
        if body is not None:
            turn = np.arange(3)
            rows[3 + turn, body.number * UNKNOWNS + 3 + turn] += sign / lever
    return rows


def corners(face: Rectangle) -> list[tuple[float, float]]:
    """The corners from the centre, along the face's two sides, in m."""
    one, two = (side / 2.0 for side in face.sides)
    return list(product((-one, one), (-two, two)))
