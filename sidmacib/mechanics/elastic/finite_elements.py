"""Finite elements of linear elastic cuboids, condensed to their contact nodes.

Elements are hexahedra on a grid of lines along x, y and z. On such a grid every integral over the
cuboid is a product of integrals along lines, which scikit-fem's line elements give. If contact
nodes are the vertices of cells, elements are trilinear and have the same nodes. Otherwise they are
triquadratic, which bend without locking: their nodes include the Gauss-Lobatto nodes, and a node at
the centre of a cell has the mean displacement of the cell.

A piece floats: its rigid motion is left out. Loads that are not in equilibrium are balanced by
accelerations; the displacements are those whose mean over the mass has no translation and no
rotation. In equilibrium of the whole assembly the accelerations add up to zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementLineP1, ElementLineP2, MeshLine

from sidmacib.mechanics.assembly import Floats, Integers

Edges = tuple[float, ...]
Grid = tuple[Edges, Edges, Edges]


@dataclass(frozen=True)
class Spread:
    """A force (N) and moment (N m) about the centroid, spread over a cuboid or one of its sides.

    The stress (or body force) varies linearly: uniform for the force, like a rotation for the
    moment. ``axis`` and ``high`` name the side; ``axis`` is None for the whole volume.
    """

    wrench: tuple[float, ...]
    axis: int | None = None
    high: bool = False


@dataclass(frozen=True)
class Flexibility:
    """Displacements of a cuboid with a Young's modulus of 1 Pa, without its rigid motion.

    ``contact``: of contact components by unit forces on them, (C, C). ``by_load``: the same by the
    loads, (C, L). ``load``: along the loads by the loads, (L, L). All in m times Pa.
    """

    contact: Floats
    by_load: Floats
    load: Floats


@dataclass(frozen=True)
class Line:
    """Elements along a line: integrals of shape functions and of their derivatives."""

    basis: Basis
    order: Integers  # of degrees of freedom by place
    place: Floats  # m
    mass: sp.csr_array
    stiffness: sp.csr_array
    cross: sp.csr_array  # derivative of the row's function times the column's function

    @classmethod
    def of(cls, edges: Edges, quadratic: bool) -> "Line":
        """Elements between ``edges`` (m), linear or quadratic."""
        element = ElementLineP2() if quadratic else ElementLineP1()
        basis = Basis(MeshLine(np.array(edges)), element)
        order = np.argsort(basis.doflocs[0])

        def integral(form: BilinearForm) -> sp.csr_array:
            return sp.csr_array(form.assemble(basis)[order][:, order])

        return cls(
            basis,
            order,
            basis.doflocs[0][order],
            integral(BilinearForm(lambda u, v, _: u * v)),
            integral(BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0])),
            integral(BilinearForm(lambda u, v, _: u * v.grad[0])),
        )

    def values(self, places: Floats) -> sp.csr_array:
        """Shape functions at ``places`` (m), (K,), one row each."""
        # Rounding may put a place beyond the ends.
        places = np.clip(places, self.place[0], self.place[-1])
        return sp.csr_array(self.basis.probes(places[None]))[:, self.order]


class Cuboid:
    """A cuboid of unit Young's modulus; its centroid is the origin."""

    def __init__(self, grid: Grid, poisson: float, *, quadratic: bool = True) -> None:
        self.lines = tuple(Line.of(edges, quadratic) for edges in grid)
        self.place = np.stack(
            np.meshgrid(*(line.place for line in self.lines), indexing="ij"), axis=-1
        ).reshape(-1, 3)
        self.mass = _product([line.mass for line in self.lines])
        axes = np.eye(3)[:, None]
        shifts = np.broadcast_to(axes, (3, *self.place.shape))
        self.rigid = np.concatenate([shifts, np.cross(axes, self.place)]).reshape(6, -1).T
        self.rigid_mass = self._each(self.mass) @ self.rigid
        self.inertia = self.rigid.T @ self.rigid_mass
        self.stiffness = self._stiffness(poisson)
        self.held = self._three_points()

    def _stiffness(self, poisson: float) -> sp.csc_array:
        """Stiffness, the components of a node together: lambda div u div v + 2 mu e(u) : e(v)."""
        lame = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        shear = 0.5 / (1.0 + poisson)

        def gradients(one: int, other: int) -> sp.csr_array:
            """Integral of the derivatives of rows along ``one`` and of columns along ``other``."""
            factors = [line.mass for line in self.lines]
            if one == other:
                factors[one] = self.lines[one].stiffness
            else:
                factors[one] = self.lines[one].cross
                factors[other] = self.lines[other].cross.T
            return _product(factors)

        both = {(a, b): gradients(a, b) for a in range(3) for b in range(3)}
        every = shear * (both[0, 0] + both[1, 1] + both[2, 2])
        blocks = [
            [lame * both[a, b] + shear * both[b, a] + (every if a == b else 0) for b in range(3)]
            for a in range(3)
        ]
        count = len(self.place)
        together = np.arange(3 * count).reshape(3, count).T.ravel()
        return sp.csc_array(sp.csr_array(sp.block_array(blocks))[together][:, together])

    def _each(self, matrix: sp.csr_array) -> sp.csr_array:
        """``matrix`` for each of the three components."""
        return sp.csr_array(sp.kron(matrix, np.eye(3)))

    def _three_points(self) -> Integers:
        """Six degrees of freedom at three corners whose supports exclude rigid motion only."""
        low, high = self.place.min(axis=0), self.place.max(axis=0)

        def corner(*axes: int) -> int:
            where = np.where(np.isin(np.arange(3), axes), high, low)
            return 3 * int(np.abs(self.place - where).sum(axis=1).argmin())

        first, along_x, along_y = corner(), corner(0), corner(1)
        return np.array([first, first + 1, first + 2, along_x + 1, along_x + 2, along_y + 2])

    def contact(self, rows: sp.csr_array, axes: Integers) -> sp.csc_array:
        """Shape functions of contact components, by column; ``rows``: of all nodes, (C, nodes)."""
        count = len(axes)
        direction = sp.csr_array((np.ones(count), (np.arange(count), axes)), (count, 3))
        return sp.csc_array(_row_products([rows, direction]).T)

    def values(self, places: Floats, cell: Floats | None = None) -> sp.csr_array:
        """Shape functions of all nodes at ``places`` (m), (K, 3), one row each.

        ``cell``: edges (m), (K, 3), of cells around the places; if given, means over these cells.
        """

        def along(line: Line, k: int) -> sp.csr_array:
            if cell is None:
                return line.values(places[:, k])
            ends = [line.values(places[:, k] + side * cell[:, k] / 2) for side in (-1.0, 1.0)]
            return (ends[0] + 4.0 * line.values(places[:, k]) + ends[1]) / 6.0

        return _row_products([along(line, k) for k, line in enumerate(self.lines)])

    def load(self, spread: Spread) -> Floats:
        """Nodal forces of a load."""
        factors = [line.mass for line in self.lines]
        if spread.axis is not None:
            place = self.lines[spread.axis].place
            end = len(place) - 1 if spread.high else 0
            factors[spread.axis] = sp.csr_array(([1.0], ([end], [end])), (len(place), len(place)))
        fields = self._each(_product(factors)) @ self.rigid
        # The combination of the six fields of rigid motions that has this wrench.
        wrench, resultant = np.array(spread.wrench), self.rigid.T @ fields
        return np.asarray(fields @ np.linalg.lstsq(resultant, wrench, rcond=1e-9)[0])

    def flexibility(self, seen: sp.csc_array, loads: Sequence[Spread]) -> Flexibility:
        """Flexibility by contact components, the columns of ``seen``, and by ``loads``."""
        forces = np.hstack([seen.toarray(), *(self.load(each)[:, None] for each in loads)])
        share = np.linalg.solve(self.inertia, self.rigid.T @ forces)
        free = np.setdiff1d(np.arange(len(forces)), self.held)
        balanced = (forces - self.rigid_mass @ share)[free]
        factors = splu(
            self.stiffness[free][:, free],
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        moved = np.zeros_like(forces)
        moved[free] = factors.solve(balanced)
        moved -= self.rigid @ np.linalg.solve(self.inertia, self.rigid_mass.T @ moved)
        whole = forces.T @ moved
        whole = (whole + whole.T) / 2
        count = seen.shape[1]
        return Flexibility(whole[:count, :count], whole[:count, count:], whole[count:, count:])


def _product(factors: Sequence[sp.csr_array]) -> sp.csr_array:
    """Kronecker product."""
    return sp.csr_array(reduce(lambda one, other: sp.kron(one, other, format="csr"), factors))


def _row_products(factors: Sequence[sp.csr_array]) -> sp.csr_array:
    """Kronecker product row by row, (K, m), (K, n), ... to (K, m n ...)."""

    def product(one: sp.csr_array, other: sp.csr_array) -> sp.csr_array:
        width = other.shape[1]
        ones = np.ones((1, width))
        left = sp.kron(one, ones, format="csr")
        right = sp.kron(np.ones((1, one.shape[1])), other, format="csr")
        return sp.csr_array(left.multiply(right))

    return reduce(product, factors)
