"""The model that designs: forces between rigid blocks, at nodes of interfaces and from their locks.

An interface carries what it carries without locks: compression and friction at its nodes, or bonds.
Locks add a force in its plane across them, up to the strength of their roots. It acts at the
contact points of a `ContactOption`: along its line of action a force may be moved, so the points of
all locks of a row that lie side by side are one. All forces redistribute freely (the static
theorem), friction is associated, and locks have no height, no friction and no tensile strength:
what is designed with this model must be checked with others.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import cvxpy as cp
import numpy as np
import shapely
from scipy.sparse import csr_array, eye_array, kron

from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.design import Layout, WeightsSection
from sidmacib.mechanics.admissible import balanced, in_units, within
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, NodeLayout
from sidmacib.mechanics.contact_law import Cone, ContactLaw
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.polygons import CondensedLocks, Polygon, polygon_nodes


@dataclass(frozen=True, eq=False)
class LoadCase:
    """A load case: ``loads``, and the ``load`` (N) of the variable ones that is to be carried."""

    name: str
    loads: Loads
    load: float


@dataclass(frozen=True, eq=False)
class Site:
    """An interface that may get locks: the index of its ``face``, and the rows it may get."""

    face: int
    layouts: tuple[Layout, ...]


@dataclass(frozen=True, eq=False)
class DesignProblem:
    """A task of design: an assembly without locks, its sites and load cases.

    That it stands before loads are raised is a case too. ``option``: where the forces of locks act.
    ValueError without a site, and for what the model has not: blocks that are crushed, condensed
    locks, and loads that are not raised in proportion.
    """

    assembly: Assembly
    sites: tuple[Site, ...]
    cases: tuple[LoadCase, ...]
    weights: WeightsSection
    option: ContactOption = OPTIONS["option3"]

    def __post_init__(self) -> None:
        if crushed_faces(self.assembly):
            raise ValueError("compressive_strength: is for multilock assembly, not for designs")
        if any(face.kind is Kind.LOCKED for face in self.assembly.faces):
            raise ValueError("condensed locks: must not be there, as the design finds them")
        for case in self.cases:
            case.loads.require_proportional()
        if not any(site.layouts for site in self.sites):
            raise ValueError("design: no dry interface of two convex blocks has room for the locks")

    @cached_property
    def layouts(self) -> tuple[Layout, ...]:
        """The rows of all sites, one after the other."""
        return tuple(layout for site in self.sites for layout in site.layouts)

    @cached_property
    def site_of(self) -> Integers:
        """Index of the site of each of `layouts`."""
        return np.repeat(np.arange(len(self.sites)), [len(site.layouts) for site in self.sites])

    @cached_property
    def costs(self) -> Floats:
        """Cost of each of `layouts`."""
        return np.array([self.weights.cost(layout) for layout in self.layouts])

    @cached_property
    def rows(self) -> tuple[tuple[int, int], ...]:
        """Site and direction of each direction that some layout has: the rows of `strengths`."""
        return tuple(
            (number, direction)
            for number, site in enumerate(self.sites)
            for direction in sorted({layout.direction for layout in site.layouts})
        )

    @cached_property
    def site_of_row(self) -> Integers:
        """Index of the site of each of `rows`."""
        return np.array([site for site, _ in self.rows])

    @cached_property
    def row_of(self) -> Integers:
        """Index in `rows` of each of `layouts`."""
        place = {row: number for number, row in enumerate(self.rows)}
        ends = zip(self.site_of.tolist(), self.layouts, strict=True)
        return np.array([place[site, layout.direction] for site, layout in ends])

    @cached_property
    def strengths(self) -> csr_array:
        """Strength (N) along each of `rows` of each of `layouts`."""
        values = [layout.strength for layout in self.layouts]
        shape = len(self.rows), len(self.layouts)
        return csr_array((values, (self.row_of, np.arange(len(values)))), shape)

    def chosen(self, choice: Sequence[Layout | None]) -> Floats:
        """1 for each of `layouts` that is in the ``choice``, one or None for each site, else 0."""
        taken = {id(layout) for layout in choice if layout is not None}
        return np.array([float(id(layout) in taken) for layout in self.layouts])

    @cached_property
    def all_cases(self) -> tuple[LoadCase, ...]:
        """The cases, and that without any variable load."""
        return (*self.cases, replace(self.cases[0], name="at rest", load=0.0))

    @cached_property
    def unit(self) -> float:
        """Unit of forces: the mean weight of what can move, in N."""
        return float(np.mean([p.weight for p in self.assembly.pieces if not p.fixed]))

    @cached_property
    def free(self) -> Integers:
        """The rows of equilibrium."""
        return free_rows(self.assembly)

    @cached_property
    def row_scale(self) -> Floats:
        """Units of the rows of equilibrium, in N."""
        return np.asarray(row_units(self.assembly) * self.unit)

    @cached_property
    def at_nodes(self) -> csr_array:
        """Equilibrium of forces at nodes in units, (R, 3 N)."""
        return self._in_units(self.assembly)

    @cached_property
    def at_locks(self) -> csr_array:
        """Equilibrium of forces across locks in units, a column for each contact point."""
        faces = tuple(self._lock_faces())
        nodes = polygon_nodes(faces, self.assembly.mesh, NodeLayout.VERTICES)
        locked = replace(self.assembly, faces=faces, nodes=nodes)
        return self._in_units(locked)[:, 2::3]

    @cached_property
    def portions(self) -> csr_array:
        """The part of the strength of each of `rows` that each contact point may carry."""
        of_row = np.array(self.option.portions)[:, None]
        return csr_array(kron(eye_array(len(self.rows)), of_row))

    def _in_units(self, assembly: Assembly) -> csr_array:
        forces = np.full(len(assembly.nodes.area), self.unit)
        return in_units(equilibrium_matrix(assembly)[self.free], self.row_scale, forces)

    def _lock_faces(self) -> Iterator[CondensedLocks]:
        """A face of contact points for each of `rows`."""
        for number, direction in self.rows:
            site = self.sites[number]
            face = self.assembly.faces[site.face]
            assert isinstance(face, Polygon)
            layouts = [each for each in site.layouts if each.direction == direction]
            run = np.array(layouts[0].run)
            across = np.cross(face.axes[0], run)
            places = shapely.get_coordinates(face.outline) @ face.axes[1:] @ across
            length = face.outline.area / float(np.ptp(places))  # of a lock, on the mean
            points = np.outer(np.array(self.option.positions) * length, [1.0, 0.0])
            areas = np.array(self.option.portions) * face.outline.area
            yield CondensedLocks(
                f"{face.name}-{direction}",
                Kind.LOCKED,
                face.material,
                face.below,
                face.above,
                np.array([face.axes[0], run, across]),
                face.middle,
                face.outline,
                points,
                areas,
            )


@dataclass(frozen=True, eq=False)
class CaseForces:
    """Unknown forces of a case, in units: across ``locks``, (K,), and those at nodes."""

    locks: cp.Variable
    constraints: list[cp.Constraint]
    limits: tuple[cp.Constraint, cp.Constraint]  # of locks, either way


def case_forces(
    structure: DesignProblem, case: LoadCase, factor: cp.Expression | float, strength: cp.Expression
) -> CaseForces:
    """Forces that carry ``factor`` times a case, with locks of a ``strength`` for each of `rows`.

    The strength is in units, and counts as it is.
    """
    cone, unit = ContactLaw.of(structure.assembly).cone(), structure.unit
    nodes = cp.Variable((len(cone.held), 3))
    locks = cp.Variable(structure.at_locks.shape[1])
    scaled = Cone(cone.held / unit, cone.slope, cone.torn / unit)
    most = structure.portions @ strength
    loads = case.loads.permanent, case.load * case.loads.variable
    permanent, variable = (each.ravel()[structure.free] / structure.row_scale for each in loads)
    either = (locks <= most, -locks <= most)
    constraints = [
        balanced(
            structure.at_nodes, nodes, permanent + factor * variable, structure.at_locks @ locks
        ),
        *within(scaled, nodes[:, 0], nodes[:, 1:], np.arange(len(cone.held))),
        *either,
    ]
    return CaseForces(locks, constraints, either)
