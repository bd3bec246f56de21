"""The shear and the torque that a dry face carries together, by what presses it.

Node by node, Coulomb's law lets pressure gather in the corners of a face, where its lever is
longest, though nothing presses it there: the torque of a square is then 85 % too high. Here the
pressure is linear over the part of the face that is pressed: of all pressures p with the same
resultant and no tension, the one of least sum of p^2 A, that of stiff blocks on stiff joints.
Friction forces of any direction, at most mu p A at each point, carry a shear V and a torque T of a
convex set. With the motion v of the face's middle and the rotation w it is

    V v + T w  <=  mu sum over points of p A |v + w x r|    for every motion,

where equality holds for the instantaneous centre of rotation. A uniformly pressed square of side a
has T = 0.3826 mu N a at V = 0. Orduna & Lourenco (Three-dimensional limit analysis of rigid blocks
assemblages, part I, International Journal of Solids and Structures 42, 2005, 5140-5160,
doi:10.1016/j.ijsolstr.2005.02.010) bound shear and torque of rectangles by fixed planes; here
planes are added where the forces are outside.

The set depends on the place of the pressure's resultant, which depends on the forces. So limit
analysis takes the places from the round before.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import scipy.sparse as sp
import shapely
from scipy.optimize import nnls

from sidmacib.mechanics.assembly import (
    Assembly,
    Face,
    Floats,
    Integers,
    Kind,
    NodeLayout,
    Rectangle,
)
from sidmacib.mechanics.equilibrium import sparse_rows
from sidmacib.mechanics.polygons import Polygon, outline_nodes

CELLS = 4  # along the longer side of a rectangle, for the integral of its pressure
OTHERS = 2  # along that of any other face, which is cut into more cells
INSIDE = 1e-3  # over the distance from the centroid: a resultant on an edge is moved in by this
TRIES = 20  # at the part of a face that is pressed
WORST = 1e10  # condition of the equations for it
EXACT = 1e4  # weight of a pressure's resultant against its least sum of squares
SEARCH_STEPS = 60  # in the search for the motion that limits a face
STOP = 1e-6  # gain over the use of the limit at which it ends
STUCK = 1e-9  # of the largest speed: points that move less are at the centre of rotation
EXCESS = 1e-3  # over the limit that is none
PRESSED = 1e-6  # over the largest normal force of a face: what a face needs to be pressed at all
# Motions (1, 1, size) that limit every face that is twisted, beside those that are found.
_TURNS = np.arange(8) * np.pi / 4
FIRST = np.array(
    [(0.0, 0.0, w) for w in (-1.0, 1.0)]
    + [(np.cos(t), np.sin(t), 3.0 * w) for t in _TURNS.tolist() for w in (-1.0, 1.0)]
)


@dataclass(frozen=True, eq=False)
class Pressure:
    """A linear pressure on a face, as points: ``places`` (J, 2) along the tangents from its middle.

    In units of ``size`` (m), the face's longer side. ``shares`` of the normal force: (J,); they are
    ``slopes``, (J, 3), times (1, x, y) of its resultant, as long as the same part is pressed.
    """

    places: Floats
    shares: Floats
    slopes: Floats
    size: float

    @classmethod
    def of(cls, face: Face, centre: Floats) -> "Pressure":
        """On ``face``, with its resultant at ``centre``, (2,) in m."""
        return _pressure(_outline(face), *centre.tolist())

    def resistance(self, motions: Floats, at: Floats) -> Floats:
        """Work of friction in ``motions``, (K, 3), over mu N, of forces ``at`` places, (M, 2).

        (K, M); linear in the places, so that the work of several forces together is the sum.
        """
        work = np.hypot(*speeds(self.places, motions)) @ self.slopes
        return np.asarray(work @ np.column_stack([np.ones(len(at)), at]).T)

    def worst(self, load: Floats) -> tuple[float, Floats]:
        """The part of the limit that a ``load``, (3,), uses, and the motion, (3,), that reaches it.

        ``load``: shears and torque / size, over mu N. Least resistance at unit work of the load, by
        weights that are one over the speeds of the step before.
        """
        x, y = self.places.T
        one, zero = np.ones_like(x), np.zeros_like(x)
        rows = np.array([[one, zero], [zero, one], [-y, x]])  # (3, 2, J)
        weight, used, best = self.shares, 0.0, load
        for _ in range(SEARCH_STEPS):
            matrix = (rows * weight).reshape(3, -1) @ rows.reshape(3, -1).T
            matrix += STUCK * matrix.trace() * np.eye(3)  # a line does not resist turning on it
            motion = np.linalg.solve(matrix, load)
            speed = np.hypot(*speeds(self.places, motion[None])[:, 0])
            use = float(load @ motion / (speed @ self.shares))
            if use > used:
                gain, used, best = use - used, use, motion / np.abs(motion).max()
                if gain <= STOP * use:
                    break
            weight = self.shares / np.maximum(speed, STUCK * speed.max())
        return used, best


@dataclass(frozen=True, eq=False)
class Twist:
    """The limits of faces that are twisted.

    ``centres``: where the normal force of each face has its resultant, along the tangents from its
    middle, (F, 2) in m; NaN of faces that have not been pressed. ``motions`` by the number of the
    face, (K, 3), in which the torque is limited.
    """

    centres: Floats
    motions: Mapping[int, Floats]

    @classmethod
    def of(cls, assembly: Assembly, force: Floats) -> "Twist":
        """By the forces of a state without such limits, (N, 3) in N."""
        nowhere = np.full((len(assembly.faces), 2), np.nan)
        return cls(nowhere, {}).after(Resultants.of(assembly, force), 0.0)

    def after(self, where: "Resultants", kept: float) -> "Twist":
        """By resultants with these limits; ``kept``: weight of the centres before them."""
        mean = kept * self.centres + (1.0 - kept) * where.centres
        moved = np.where(np.isnan(self.centres), where.centres, mean)
        centres = np.where(np.isnan(where.centres), self.centres, moved)
        motions = dict(self.motions)
        for number, used, motion in where.uses(centres) if kept else where.own_uses:
            if used > 1.0 + EXCESS:
                motions[number] = np.vstack([motions.get(number, FIRST), motion])
        return Twist(centres, motions)

    def nearer(self) -> "Twist":
        """With the centres half as far from the middles of the faces."""
        return replace(self, centres=self.centres / 2.0)

    def rows(
        self, assembly: Assembly, rough: Integers, unit: Floats
    ) -> tuple[sp.csr_array, sp.csr_array]:
        """Work of the shear forces of nodes and of their friction limits, in every motion.

        ``rough``: the nodes that rub, (R,). ``unit``: of the forces at each node, N, (N,). Returns
        (K, 2 R) and (K, R): that of the forces is at most that of the limits.
        """
        lever = levers(assembly)
        forces, limits = [], []
        for number, motions in self.motions.items():
            pressure = Pressure.of(assembly.faces[number], self.centres[number])
            nodes = np.flatnonzero(assembly.nodes.face == number)
            at = lever[nodes] / pressure.size
            columns = np.searchsorted(rough, nodes)
            moved = speeds(at, motions).transpose(1, 2, 0).reshape(len(motions), -1)
            wide = (2 * columns[:, None] + np.arange(2)).ravel()
            forces.append(sparse_rows(moved, wide, 2 * len(rough)))
            limits.append(sparse_rows(pressure.resistance(motions, at), columns, len(rough)))
        size = unit[rough] / float(unit[rough].max())
        both = (sp.vstack(forces), np.repeat(size, 2)), (sp.vstack(limits), size)
        works, most_works = (rows @ sp.diags_array(of_nodes) for rows, of_nodes in both)
        return works, most_works


@dataclass(frozen=True, eq=False)
class Resultants:
    """Resultants of the faces of an ``assembly``.

    ``shear`` (N), (2, F), and ``torque`` about the middle (N m), (F,). ``limit``:
    friction coefficient times normal force (N), (F,). ``centres``: as in `Twist`.
    """

    assembly: Assembly
    limit: Floats
    shear: Floats
    torque: Floats
    centres: Floats

    @classmethod
    def of(cls, assembly: Assembly, force: Floats) -> "Resultants":
        """Resultants of node ``force``, (N, 3) in N, in the frames of the faces."""
        count, face = len(assembly.faces), assembly.nodes.face

        def sums(values: Floats) -> Floats:
            return np.asarray(np.bincount(face, values, count), float)

        (x, y), (normal, one, other) = levers(assembly).T, force.T
        pressing = sums(normal)
        pressed = pressing > PRESSED * max(float(pressing.max(initial=0.0)), 0.0)
        divisor = np.where(pressed, pressing, np.nan)
        friction = np.array([each.material.friction for each in assembly.faces])
        return cls(
            assembly,
            friction * np.where(pressed, pressing, 0.0),
            np.array([sums(one), sums(other)]),
            sums(x * other - y * one),
            np.array([sums(x * normal), sums(y * normal)]).T / divisor[:, None],
        )

    @cached_property
    def own_uses(self) -> tuple[tuple[int, float, Floats], ...]:
        """The `uses` by the faces' own pressure."""
        return tuple(self.uses(self.centres))

    @property
    def most_used(self) -> float:
        """The largest part of its limit that a face uses by its own pressure."""
        return max((used for _, used, _ in self.own_uses), default=0.0)

    def uses(self, centres: Floats) -> Iterator[tuple[int, float, Floats]]:
        """Dry faces that are pressed and twisted about the resultant of their pressure.

        Their numbers, the part of its limit that each uses, and the motion, (3,), in which it does,
        by a pressure with its resultant at the ``centres``, as in `Twist`.
        """
        x, y = self.centres.T
        about = np.abs(self.torque - x * self.shear[1] + y * self.shear[0])
        for number, face in enumerate(self.assembly.faces):
            limit = self.limit[number]
            twisted = limit > 0.0 and about[number] > EXCESS * limit * points_of(face)[2]
            if face.kind is Kind.DRY and twisted:
                pressure = Pressure.of(face, centres[number])
                both = [*self.shear[:, number], self.torque[number] / pressure.size]
                yield number, *pressure.worst(np.array(both) / limit)


def linear_pressure(places: Floats, areas: Floats, centre: Floats) -> tuple[Floats, Floats]:
    """Shares of a normal force at ``places``, (J, 2), that are no tension and linear if pressed.

    ``areas``: (J,), which add up to 1, as the shares do. ``centre``: (2,), of the force; it is
    moved inside the places if it is on their edge. They are the shares of least sum of p^2 / A.
    Also their slopes, (J, 3), see `Pressure`.
    """
    middle = areas @ places
    # From (1, x, y) of the centre to what is sought.
    inside = (1.0 - INSIDE) * np.column_stack([-middle, np.eye(2)])
    seen = np.vstack([[1.0, 0.0, 0.0], inside])
    sought = seen @ [1.0, *centre]
    basis = np.column_stack([np.ones(len(areas)), places - middle])
    pressed = np.ones(len(areas), bool)
    for _ in range(TRIES):
        matrix = (basis[pressed].T * areas[pressed]) @ basis[pressed]
        if np.linalg.cond(matrix) > WORST:
            break
        slopes = basis @ np.linalg.solve(matrix, seen)
        pressure = slopes @ [1.0, *centre]
        if np.array_equal(pressure > 0.0, pressed):
            slopes = (areas * pressed)[:, None] * slopes
            return slopes @ [1.0, *centre], slopes
        pressed = pressure > 0.0
    # Rare: the part that is pressed is found among all, one point after the other.
    root = np.sqrt(areas)
    rows = np.vstack([EXACT * basis.T * root, np.eye(len(areas))])
    shares = nnls(rows, np.concatenate([EXACT * sought, np.zeros(len(areas))]))[0] * root
    shares = np.asarray(shares / shares.sum())
    return shares, np.column_stack([shares, np.zeros((len(areas), 2))])


def speeds(places: Floats, motions: Floats) -> Floats:
    """Of ``places``, (J, 2), in ``motions``, (K, 3), along both tangents, (2, K, J)."""
    x, y = places.T
    one, other, turn = motions.T[:, :, None]
    return np.array([one - turn * y, other + turn * x])


def levers(assembly: Assembly) -> Floats:
    """Places of the nodes along the tangents from their faces' middles, (N, 2) in m."""
    faces = assembly.nodes.face
    middle = np.array([face.middle for face in assembly.faces])[faces]
    tangents = np.array([face.axes[1:] for face in assembly.faces])[faces]
    return np.asarray(np.einsum("nx,ntx->nt", assembly.nodes.position - middle, tangents))


def points_of(face: Face) -> tuple[Floats, Floats, float]:
    """Points along the tangents from the middle over the size, (J, 2), their areas, and the size.

    Areas over that of the face, (J,). The size in m: the longer side of the face.
    """
    return _points(_outline(face))


def _outline(face: Face) -> shapely.Polygon:
    """Along the tangents of the ``face`` from its middle, in m."""
    if isinstance(face, Rectangle):
        u, v = face.axes[1:] @ (np.array(face.high) - np.array(face.low))
        return shapely.box(-u / 2, -v / 2, u / 2, v / 2)
    assert isinstance(face, Polygon)
    return face.outline


@lru_cache(maxsize=4096)
def _pressure(outline: shapely.Polygon, x: float, y: float) -> Pressure:
    """On a face of an ``outline``, with its resultant there (m)."""
    places, areas, size = _points(outline)
    return Pressure(places, *linear_pressure(places, areas, np.array([x, y]) / size), size)


@lru_cache(maxsize=4096)
def _points(outline: shapely.Polygon) -> tuple[Floats, Floats, float]:
    low_x, low_y, high_x, high_y = outline.bounds
    size = float(max(high_x - low_x, high_y - low_y))
    rectangle = len(outline.exterior.coords) == 5 and not outline.interiors
    cells = CELLS if rectangle else OTHERS
    places, areas = outline_nodes(outline, size / cells, NodeLayout.LOBATTO)[:2]
    return places / size, areas / areas.sum(), size
