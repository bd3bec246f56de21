"""Finite elements of linear elastic cuboids, condensed to their contact nodes.

Elements are hexahedra on a grid of lines along x, y and z. On such a grid every integral over the
cuboid is a product of integrals along lines. If contact nodes are the vertices of cells, elements
are trilinear and have the same nodes. Otherwise they are triquadratic, which bend without locking:
their nodes include the Gauss-Lobatto nodes, and a node at the centre of a cell has the mean
displacement of the cell.

A piece floats: its rigid motion is left out. Loads that are not in equilibrium are balanced by
accelerations; the displacements are those whose mean over the mass has no translation and no
rotation. In equilibrium of the whole assembly the accelerations add up to zero.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cholesky, qr, solve_triangular
from skfem import ElementLineP1, ElementLineP2

from sidmacib.mechanics.assembly import Floats, Integers

LEAST_LAYER = 200  # degrees of freedom of a block: smaller layers are taken together
Edges = tuple[float, ...]
MIRRORED = 1e-12  # of a line's length: edges that differ by less are each other's mirror image
LARGE = 600  # degrees of freedom of a cuboid: mirror planes of smaller ones save nothing
Grid = tuple[Edges, Edges, Edges]
Terms = tuple[Integers, Floats]  # nodes along a line and what to multiply their values by, (K, W)
Half = tuple[Terms, Terms]  # for components along the mirror plane, and across it
NO_MOTION = 1e-9  # of a rigid motion: less of it is none


def compliance(stiffness: sp.csr_array, layer: Integers, forces: Floats) -> Floats:
    """Displacements along ``forces`` by each other: forces' K^-1 forces, (F, F), symmetric.

    By Cholesky's method, layer by layer: each layer of elements touches the next one only. The
    factors are dense blocks of two layers at a time, so that nearly all work is done in products of
    full matrices: thirty times faster than a general sparse factorisation, which spends its time on
    the right sides.

    ``stiffness``: positive definite, (D, D). ``layer``: of each degree of freedom, ascending, (D,);
    only those in the same or in neighbouring layers are coupled. ``forces``: (D, F), overwritten.
    """
    before: tuple[slice, Floats] | None = None
    for block in _blocks(layer):
        own = stiffness[block, block].toarray()
        if before is not None:
            last, factor = before
            # Rows of the factor's block below the diagonal.
            across = _solved(factor, stiffness[last, block].toarray()).T
            own -= across @ across.T
            forces[block] -= across @ forces[last]
        factor = cholesky(own, lower=True, overwrite_a=True, check_finite=False)
        forces[block] = _solved(factor, forces[block])
        before = block, factor
    return forces.T @ forces


def _solved(factor: Floats, right: Floats) -> Floats:
    return np.asarray(solve_triangular(factor, right, lower=True, check_finite=False))


def _blocks(layer: Integers) -> list[slice]:
    """Whole layers, at least `LEAST_LAYER` degrees of freedom in each block."""
    ends = [*(np.flatnonzero(np.diff(layer)) + 1).tolist(), len(layer)]
    blocks, start = [], 0
    for end in ends:
        if end - start >= LEAST_LAYER or end == ends[-1]:
            blocks.append(slice(start, end))
            start = end
    return blocks


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


class ElasticCuboid:
    """A cuboid of unit Young's modulus; its centroid is the origin."""

    def __init__(self, grid: Grid, poisson: float, *, quadratic: bool = True) -> None:
        self.lines = tuple(ElementLine.of(edges, quadratic) for edges in grid)
        self.counts = tuple(len(line.place) for line in self.lines)
        self.place = np.stack(
            np.meshgrid(*(line.place for line in self.lines), indexing="ij"), axis=-1
        ).reshape(-1, 3)
        axes = np.eye(3)[:, None]
        shifts = np.broadcast_to(axes, (3, *self.place.shape))
        self.rigid = np.concatenate([shifts, np.cross(axes, self.place)]).reshape(6, -1).T
        self.rigid_mass = self._rigid_times([line.mass for line in self.lines])
        self.stiffness = self._stiffness(poisson)

    def _stiffness(self, poisson: float) -> sp.csr_array:
        """Stiffness, the components of a node together: lambda div u div v + 2 mu e(u) : e(v)."""
        lame = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
        shear = 0.5 / (1.0 + poisson)
        pairs = [np.nonzero(line.mass) for line in self.lines]  # of coupled nodes

        def gradients(one: int, other: int) -> Floats:
            """Integral of the derivatives of rows along ``one`` and of columns along ``other``."""
            factors = [line.mass for line in self.lines]
            if one == other:
                factors[one] = self.lines[one].stiffness
            else:
                factors[one] = self.lines[one].cross
                factors[other] = self.lines[other].cross.T
            x, y, z = (factor[pair] for factor, pair in zip(factors, pairs, strict=True))
            return np.asarray((x[:, None, None] * y[:, None] * z).ravel())

        both = [[gradients(a, b) for b in range(3)] for a in range(3)]
        every = shear * (both[0][0] + both[1][1] + both[2][2])
        values = np.array(
            [
                [
                    lame * both[a][b] + shear * both[b][a] + (every if a == b else 0)
                    for b in range(3)
                ]
                for a in range(3)
            ]
        )
        row, column = (self._nodes(*(pair[side] for pair in pairs)) for side in (0, 1))
        k = np.arange(3)[:, None, None]
        rows, columns = np.broadcast_arrays(3 * row + k, 3 * column + k.swapaxes(0, 1))
        where = rows.ravel(), columns.ravel()
        return sp.csr_array((values.ravel(), where), 2 * (self.rigid.shape[0],))

    def _nodes(self, *along: Integers) -> Integers:
        """Numbers of the nodes at all combinations of places ``along`` the lines."""
        return np.asarray(np.ravel_multi_index(np.ix_(*along), self.counts).ravel())

    def _rigid_times(self, factors: Sequence[Floats]) -> Floats:
        """The product of matrices along the lines, applied to each component of rigid motions."""
        fields = self.rigid.reshape(*self.counts, -1)
        for axis, factor in enumerate(factors):
            fields = np.moveaxis(np.tensordot(factor, fields, (1, axis)), 0, axis)
        return np.asarray(fields.reshape(self.rigid.shape))

    def contact(self, rows: sp.csr_array, axes: Integers) -> sp.csc_array:
        """Shape functions of contact components, by column; ``rows``: of all nodes, (C, nodes)."""
        parts = rows.tocoo()
        where = 3 * parts.col + axes[parts.row], parts.row
        return sp.csc_array((parts.data, where), (3 * rows.shape[1], rows.shape[0]))

    def values(self, places: Floats, cell: Floats | None = None) -> sp.csr_array:
        """Shape functions of all nodes at ``places`` (m), (K, 3), one row each.

        ``cell``: edges (m), (K, 3), of cells around the places; if given, means over these cells.
        """
        parts = [
            line.values(places[:, k]) if cell is None else line.means(places[:, k], cell[:, k])
            for k, line in enumerate(self.lines)
        ]
        return _row_products(parts, self.counts)

    def load(self, spread: Spread) -> Floats:
        """Nodal forces of a load."""
        factors = [line.mass for line in self.lines]
        if spread.axis is not None:
            count = self.counts[spread.axis]
            factors[spread.axis] = np.diag(np.arange(count) == (count - 1) * spread.high) * 1.0
        fields = self._rigid_times(factors)
        # The combination of the six fields of rigid motions that has this wrench.
        wrench, resultant = np.array(spread.wrench), self.rigid.T @ fields
        return np.asarray(fields @ np.linalg.lstsq(resultant, wrench, rcond=1e-9)[0])

    def flexibility(self, seen: sp.csc_array, loads: Sequence[Spread]) -> Flexibility:
        """Flexibility by contact components, the columns of ``seen``, and by ``loads``."""
        forces = np.zeros((len(self.rigid), len(loads)))
        for column, each in enumerate(loads):
            forces[:, column] = self.load(each)
        contact = np.zeros(2 * (seen.shape[1],))
        by_load, load = np.zeros((seen.shape[1], len(loads))), np.zeros(2 * (len(loads),))
        for basis, layer, stiffness in self._classes:
            part = sp.csr_array(basis.T @ seen)
            touched = np.flatnonzero(np.diff(part.indptr))
            part, count = part[touched], len(touched)
            both = np.zeros((basis.shape[1], count + len(loads)))
            both[touched, np.arange(count)] = 1.0
            both[:, count:] = basis.T @ forces
            moved = self._compliance(basis, layer, stiffness, both)
            contact += (part.T @ (part.T @ moved[:count, :count]).T).T
            by_load += part.T @ moved[:count, count:]
            load += moved[count:, count:]
        return Flexibility((contact + contact.T) / 2, by_load, load)

    def _compliance(
        self, basis: sp.csr_array, layer: Integers, stiffness: sp.csr_array, forces: Floats
    ) -> Floats:
        """Displacements in the span of ``basis``, without rigid motion, along forces by forces."""
        rigid, rigid_mass = basis.T @ self.rigid, basis.T @ self.rigid_mass
        size = np.linalg.norm(rigid, axis=0)
        used = size > NO_MOTION * np.linalg.norm(self.rigid, axis=0)
        rigid, rigid_mass = rigid[:, used], rigid_mass[:, used]
        inertia = rigid.T @ rigid_mass
        forces -= rigid_mass @ np.linalg.solve(inertia, rigid.T @ forces)
        # Degrees of freedom whose supports exclude rigid motion only.
        held = qr(rigid.T, mode="r", pivoting=True)[1][: len(inertia)]
        free = np.setdiff1d(np.arange(len(forces)), held)
        return compliance(stiffness[free][:, free], layer[free], forces[free])

    @cached_property
    def _classes(self) -> tuple[tuple[sp.csr_array, Integers, sp.csr_array], ...]:
        """Bases of displacements that are equal or opposite to their mirror images.

        A large cuboid has mirror planes where its grid has, and these displacements are independent
        of each other. With each basis: the layer of each of its vectors along the longest line, and
        the stiffness.
        """
        large = len(self.rigid) > LARGE
        halves = [_halves(len(line.place), large and line.mirrored) for line in self.lines]
        longest = int(np.argmax(self.counts))
        return tuple(self._class(chosen, longest) for chosen in product(*halves))

    def _class(
        self, chosen: tuple[Half, ...], longest: int
    ) -> tuple[sp.csr_array, Integers, sp.csr_array]:
        parts, layers = [], []
        for component in range(3):
            # A mirror turns the component across it into its opposite.
            along = [half[k == component] for k, half in enumerate(chosen)]
            grid = np.meshgrid(*(np.arange(len(nodes)) for nodes, _ in along), indexing="ij")
            places = [place.ravel() for place in grid]
            each = [
                (nodes[place], values[place])
                for (nodes, values), place in zip(along, places, strict=True)
            ]
            axes = np.full(len(places[0]), component)
            parts.append(self.contact(_row_products(each, self.counts), axes))
            layers.append(places[longest] // 2)  # elements couple nodes up to two places apart
        layer = np.concatenate(layers)
        order = np.argsort(layer, kind="stable")
        basis = sp.csr_array(sp.hstack(parts, format="csc")[:, order])
        return basis, layer[order], sp.csr_array(basis.T @ self.stiffness @ basis)


def _halves(count: int, mirrored: bool) -> tuple[Half, ...]:
    """Bases of even and odd values at ``count`` places; all values if there is no mirror plane."""
    if not mirrored:
        every = np.arange(count)[:, None], np.ones((count, 1))
        return ((every, every),)
    side = np.arange(count // 2)
    nodes = np.column_stack([side, count - 1 - side])
    root = math.sqrt(0.5)
    one, other = (np.tile([root, end], (len(side), 1)) for end in (root, -root))
    even, odd = (nodes, one), (nodes, other)
    if count % 2:
        middle = np.array([[count // 2, count // 2]])
        even = np.vstack([nodes, middle]), np.vstack([one, [[1.0, 0.0]]])
    return (even, odd), (odd, even)


def _row_products(parts: Sequence[Terms], counts: Sequence[int]) -> sp.csr_array:
    """Products of terms along x, y and z, row by row, as a matrix of all nodes, (K, nodes)."""
    (i, x), (j, y), (k, z) = parts
    each = i[:, :, None, None], j[:, None, :, None], k[:, None, None, :]
    nodes = np.ravel_multi_index(each, counts)
    values = x[:, :, None, None] * y[:, None, :, None] * z[:, None, None, :]
    row, *inside = np.nonzero(values)
    where = row, nodes[row, *inside]
    return sp.csr_array((values[row, *inside], where), (len(i), math.prod(counts)))
