"""Elements along a line, with scikit-fem's shape functions and their integrals."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from skfem import ElementLineP1, ElementLineP2

from sidmacib.mechanics.assembly import Floats, Integers

Edges = tuple[float, ...]
MIRRORED = 1e-12  # of a line's length: edges that differ by less are each other's mirror image


def shapes(quadratic: bool, local: Floats) -> tuple[Floats, Floats]:
    """Shape functions of an element and their derivatives at ``local`` places, 0 to 1, (K, D)."""
    element = ElementLineP2() if quadratic else ElementLineP1()
    functions = [element.lbasis(local[None], i) for i in np.argsort(element.doflocs[:, 0])]
    values, slopes = zip(*functions, strict=True)
    return np.stack(values, axis=1), np.stack([slope[0] for slope in slopes], axis=1)


@lru_cache(maxsize=2)
def _unit_integrals(quadratic: bool) -> tuple[Floats, Floats, Floats]:
    """Mass, stiffness and cross integrals, see `ElementLine`, of an element of length 1."""
    places, weights = np.polynomial.legendre.leggauss(3)
    value, slope = shapes(quadratic, (places + 1.0) / 2.0)
    by_weight = np.sqrt(weights[:, None] / 2.0)  # in both factors, so that results are symmetric
    value, slope = by_weight * value, by_weight * slope
    return value.T @ value, slope.T @ slope, slope.T @ value


@dataclass(frozen=True)
class ElementLine:
    """Elements between ``edges`` (m), linear or quadratic, and integrals of shape functions.

    ``mass``: of products, ``stiffness``: of products of derivatives, ``cross``: of the derivative
    of the row's function times the column's function; all of shape (D, D).
    """

    edges: Floats
    quadratic: bool
    mass: Floats
    stiffness: Floats
    cross: Floats

    @classmethod
    @lru_cache(maxsize=64)  # pieces of an assembly have most lines in common
    def of(cls, edges: Edges, quadratic: bool) -> "ElementLine":
        """Elements between ``edges`` (m), linear or quadratic."""
        places, step = np.array(edges), 2 if quadratic else 1
        length = np.diff(places)
        freedoms = step * np.arange(len(length))[:, None] + np.arange(step + 1)
        integrals = np.zeros((3, step * len(length) + 1, step * len(length) + 1))
        scales = length, 1.0 / length, np.ones_like(length)
        for whole, unit, scale in zip(integrals, _unit_integrals(quadratic), scales, strict=True):
            where = freedoms[:, :, None], freedoms[:, None, :]
            np.add.at(whole, where, scale[:, None, None] * unit)
        return cls(places, quadratic, *integrals)

    @cached_property
    def place(self) -> Floats:
        """Places of the degrees of freedom, ascending (m), (D,)."""
        if not self.quadratic:
            return self.edges
        between = (self.edges[1:] + self.edges[:-1]) / 2.0
        return np.sort(np.concatenate([self.edges, between]))

    @property
    def mirrored(self) -> bool:
        """Whether the line is its own mirror image about 0."""
        tolerance = MIRRORED * float(self.edges[-1] - self.edges[0])
        return bool(np.abs(self.edges + self.edges[::-1]).max() <= tolerance)

    def values(self, places: Floats) -> tuple[Integers, Floats]:
        """Degrees of freedom and their shape functions at ``places`` (m), (K,), both (K, W)."""
        # Rounding may put a place beyond the ends.
        cell = np.clip(np.searchsorted(self.edges, places, "right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[cell], self.edges[cell + 1]
        value, _ = shapes(self.quadratic, np.clip((places - low) / (high - low), 0.0, 1.0))
        step = value.shape[1] - 1
        return step * cell[:, None] + np.arange(step + 1), value

    def means(self, places: Floats, width: Floats) -> tuple[Integers, Floats]:
        """`values`, as means over cells of a ``width`` (m) around the places (Simpson's rule)."""
        parts = [self.values(places + side * width / 2.0) for side in (-1.0, 0.0, 1.0)]
        weights = [
            part * share for (_, part), share in zip(parts, (1 / 6, 4 / 6, 1 / 6), strict=True)
        ]
        return np.hstack([freedoms for freedoms, _ in parts]), np.hstack(weights)
