"""The shape of a V-M curve: two straight parts, as the paper describes it."""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Floats


@dataclass(frozen=True)
class TwoParts:
    """A curve as two straight parts, in V and M over their largest values.

    ``turn``: share of the curve's length, from pure shear on, where they meet; ``slopes``: -dM/dV
    of both; ``residual``: root mean square distance from the curve.
    """

    turn: float
    slopes: tuple[float, float]
    residual: float

    @classmethod
    def of(cls, points: Floats) -> "TwoParts":
        """The closest two straight parts to ``points`` (V, M) from pure shear on, (N, 2)."""
        scaled = points / points.max(axis=0)
        length = length_along(scaled)
        place = length / length[-1]
        fits = []
        for turn in np.linspace(0.1, 0.9, 81):
            base = np.column_stack([np.interp(place, [0.0, turn, 1.0], row) for row in np.eye(3)])
            knots = np.linalg.lstsq(base, scaled, rcond=None)[0]
            residual = float(np.sqrt(np.mean(np.sum((base @ knots - scaled) ** 2, axis=1))))
            fits.append((residual, float(turn), knots))
        residual, turn, knots = min(fits, key=lambda fit: fit[0])
        first, second = np.diff(knots, axis=0)
        slopes = (float(-first[1] / first[0]), float(-second[1] / second[0]))
        return cls(turn, slopes, residual)


def length_along(points: Floats) -> Floats:
    """Length of a curve from its first point to each of ``points``, (N, 2); shape (N,)."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
