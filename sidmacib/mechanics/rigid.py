"""Equilibrium of rigid pieces on contact nodes, in terms of the pieces' displacements.

The contact law gives a node's force from the relative displacement of its two pieces, so the size
of the matrices in Newton's method depends on the number of pieces only, not on the mesh.

Unknowns are ordered so that coupled ones are close together. Pieces that touch few others give the
stiffness a narrow band. A piece that touches very many, such as a monolithic body above all locks,
would make the band as wide as the matrix; it goes into a border behind the band.
"""

import math
from copy import copy
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Loads
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, components
from sidmacib.mechanics.contact_law.kernels import NORMAL, put_slip
from sidmacib.mechanics.equilibrium import RIGID, face_axes, free_rows, row_units, soft_law
from sidmacib.mechanics.newton import Matrix, elastic, equilibrium
from sidmacib.mechanics.newton.faces import ContactFaces, new_point, whole_faces
from sidmacib.mechanics.newton.friction_rounds import EquilibriumSearch, by_rounds
from sidmacib.mechanics.solution import LARGEST_STEP, Equilibrium, Solver, lifted_part

Graph = dict[int, set[int]]  # pieces and those that they touch
RESIDUAL = 1e-10  # unbalanced force over the loads, at equilibrium
# Of a face's stiffness, see `sidmacib.mechanics.newton.faces.tangent_stiffness`; and of the
# stiffest face, at least: less is lost in rounding.
FLOOR, LEAST_FLOOR = 1e-10, 1e-14
DRAG = 1e-6  # over a face's stiffness, on pieces that move away: far less than holds them
# Stiffness of the stiffest face over that of the softest: above the first, rounding matters; above
# the second, it decides. Faces far below the second are as good as rigid.
STIFF, MOST_STIFF = 1e4, 1e8


@dataclass(frozen=True)
class Ordering:
    """An order of the free pieces, see `sidmacib.mechanics.newton.faces.ContactFaces`.

    ``begin``: first unknown of each piece, (P,). ``inner``, ``outer``: numbers of unknowns in the
    band and behind it. ``band``: largest distance between coupled inner unknowns.
    """

    begin: Integers
    inner: int
    outer: int
    band: int

    @property
    def work(self) -> int:
        """Approximate number of multiplications in one elimination."""
        return self.inner * (self.band + self.outer) ** 2 + self.outer**3


def ordering(assembly: Assembly) -> Ordering:
    """The order with the least work: pieces go into the border as long as that saves any."""
    free = sum(not piece.fixed for piece in assembly.pieces)
    return _least_work(free, tuple(map(tuple, _ends(assembly)[1].tolist())))


def _ends(assembly: Assembly) -> tuple[Integers, Integers]:
    """Pieces below and above each face, (F, 2), and these counted among free ones, -1 for fixed."""
    fixed = np.array([piece.fixed for piece in assembly.pieces])
    ends = np.array([(face.below, face.above) for face in assembly.faces])
    return ends, np.where(fixed, -1, np.cumsum(~fixed) - 1)[ends]


@lru_cache(maxsize=32)  # joints with as many locks differ in sizes only
def _least_work(pieces: int, pairs: tuple[tuple[int, ...], ...]) -> Ordering:
    """`ordering` of that many free ``pieces``; ``pairs``: those that touch, -1 for fixed ones."""
    graph: Graph = {piece: set() for piece in range(pieces)}  # and the free ones that they touch
    for below, above in pairs:
        if below >= 0 and above >= 0:
            graph[below].add(above)
            graph[above].add(below)
    by_contacts = sorted(graph, key=lambda piece: -len(graph[piece]))
    best = _bordered(graph, [])
    for count in range(1, len(by_contacts)):
        other = _bordered(graph, by_contacts[:count])
        if other.work >= best.work:
            break
        best = other
    return best


def _bordered(graph: Graph, border: list[int]) -> Ordering:
    inside = {piece: graph[piece].difference(border) for piece in graph if piece not in border}
    order = [*_cuthill_mckee(inside), *border]
    begin = np.empty(len(order), dtype=np.int64)
    begin[order] = RIGID * np.arange(len(order))
    first = begin.tolist()
    apart = [first[one] - first[other] for one in inside for other in inside[one]]
    band = max(apart, default=0) + RIGID - 1
    return Ordering(begin, RIGID * len(inside), RIGID * len(border), band)


def _cuthill_mckee(graph: Graph) -> list[int]:
    """Pieces in the order of Cuthill and McKee (1969), from an end of each connected part.

    `scipy.sparse.csgraph.reverse_cuthill_mckee` breaks ties in another way, as for three locks
    below one body, which changes the order of elimination and so the last digits of results.
    """
    order: list[int] = []
    seen: set[int] = set()
    for piece in sorted(graph, key=lambda piece: len(graph[piece])):
        if piece not in seen:
            part = _breadth_first(graph, _breadth_first(graph, piece)[-1])
            order += part
            seen.update(part)
    return order


def _breadth_first(graph: Graph, start: int) -> list[int]:
    """The pieces connected to ``start``, nearest first, among equals those with few neighbours."""
    order, seen = [start], {start}
    for piece in order:  # which grows meanwhile
        new = sorted(graph[piece] - seen, key=lambda other: (len(graph[other]), other))
        order += new
        seen.update(new)
    return order


class RigidSolver(Solver):
    """Newton's method on ``assembly`` under ``loads``.

    Callers see the displacements of the free pieces, in m and rad. Internally, displacements and
    forces have the units of `sidmacib.mechanics.newton.faces` and the order of `ordering`.
    `CapacityError` if faces differ in stiffness by more than `MOST_STIFF`.
    """

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        order, self.contact_law = ordering(assembly), ContactLaw.of(assembly)
        laws = {face.material for face in assembly.faces}
        both = [k for law in laws for k in (law.normal_stiffness, law.shear_stiffness)]
        ratio = max(both) / min(both)
        if ratio > MOST_STIFF * (1.0 + 1e-9):  # rounding of their quotient
            raise CapacityError(
                f"the stiffest face is {ratio:.3g} times as stiff as the softest; with more than "
                f"{MOST_STIFF:g} times rounding errors decide"
            )
        self.contacts = _contact_faces(assembly, self.contact_law, order, ratio > STIFF)
        self.soft = self.contacts._replace(
            law=soft_law(assembly).rows(), bonded=np.zeros_like(self.contacts.bonded)
        )
        self.here = new_point(order.inner + order.outer, self.contacts.start)
        self.matrix = Matrix(
            np.empty((order.inner, 3 * order.band + 1)),
            np.empty((order.inner, order.outer)),
            np.empty((order.outer, order.inner + order.outer)),
        )
        for each in (self.contacts, self.soft):
            whole_faces(each, self.here)
        self.most_opening = assembly.most_opening
        self.place = (order.begin[:, None] + np.arange(RIGID)).ravel()
        self.units, self.rows = row_units(assembly), free_rows(assembly)
        self.stiffness, softer = _stiffest(self.contacts), _stiffest(self.soft)
        self.floor = max(FLOOR * softer, LEAST_FLOOR * self.stiffness)
        self.drag = DRAG * softer
        self._carry(loads)

    def under(self, loads: Loads) -> "RigidSolver":
        """The solver of the same assembly under other ``loads``; it shares what both compute in."""
        other = copy(self)
        other._carry(loads)
        return other

    def _carry(self, loads: Loads) -> None:
        loads.require_proportional()
        self.scale = loads.scale
        self.weight = self._inside(loads.permanent.ravel()[self.rows] / self.units)
        self.load = self._inside(loads.variable.ravel()[self.rows] / self.units)
        self.rest = self._elastic(self.contacts, self.weight)
        reach = (
            np.abs(self._elastic(self.soft, force)).max()
            for force in (self.weight, loads.scale * self.load)
        )
        self.largest_step = LARGEST_STEP * float(sum(reach))

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        initial = NodeState.initial(self.contact_law.cohesive)
        return self.solve(0.0, self._outside(self.rest), initial, thorough=True)

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the displacements and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method finds none and, if ``thorough``, rounds of
        given friction limits find none either.
        """
        target = load * self.load + self.weight
        allowed = RESIDUAL * float(np.abs(target).max())
        begin, before = self._inside(guess * self.units), components(state.slip)
        limits = self.floor, allowed, self.largest_step
        nodes = target, begin, before, state.whole
        found = equilibrium(self.contacts, self.matrix, self.here, *nodes, limits)
        if not found and thorough:
            at_nodes = target, before, state.whole, self.stiffness
            search = EquilibriumSearch(self.contacts, self.matrix, self.here, *at_nodes, *limits)
            found = by_rounds(search, begin)
        if not found:
            raise NoEquilibriumError(f"no equilibrium at {load:g} N")
        here = self.here
        slip = np.empty_like(before)
        put_slip(self.contacts.law, before, state.whole, here.moved, here.force, slip)
        displacement = float(self.load @ here.unknowns)
        after = NodeState(slip.T, state.whole)
        unknowns, force = self._outside(here.unknowns), here.force.copy()
        rotation = float(np.linalg.norm(unknowns.reshape(-1, RIGID)[:, 3:], axis=1).max())
        opening = -float(here.moved[0].min())
        return Equilibrium(load, unknowns, displacement, force.T, after, rotation, opening)

    def lift(self, point: Equilibrium, load: float) -> float:
        """Fraction of the pieces' motion that lifts them when they move away under ``load`` (N)."""
        return lifted_part(self.weight, self._pushed(point, load))

    def motion(self, point: Equilibrium, load: float) -> Floats:
        """Displacements (m, rad) of the free pieces when they move away under ``load`` (N)."""
        return self._outside(self._pushed(point, load))

    def _pushed(self, point: Equilibrium, load: float) -> Floats:
        """Motion from ``point`` under a ``load`` (N) that nothing but drag carries."""
        target = load * self.load + self.weight
        begin = self._inside(point.unknowns * self.units)
        # With drag in place of the floor: as nothing carries the load, Newton's steps go on.
        limits = self.drag, 0.0, math.inf
        state = point.state
        nodes = target, begin, components(state.slip), state.whole
        equilibrium(self.contacts, self.matrix, self.here, *nodes, limits)
        return np.asarray(self.here.unknowns - begin)

    def _elastic(self, contacts: ContactFaces, target: Floats) -> Floats:
        """Unknowns of ``contacts`` under ``target`` (N) with every node closed and bonded."""
        return np.asarray(elastic(contacts, self.matrix, self.here, target, self.floor))

    def _inside(self, values: Floats) -> Floats:
        inside = np.empty_like(values)
        inside[self.place] = values
        return inside

    def _outside(self, unknowns: Floats) -> Floats:
        return np.asarray(unknowns[self.place] / self.units)


def _stiffest(contacts: ContactFaces) -> float:
    """Normal stiffness (N/m) of the stiffest face."""
    return float(np.add.reduceat(contacts.law[NORMAL], contacts.start[:-1]).max())


def _contact_faces(
    assembly: Assembly, law: ContactLaw, order: Ordering, stiff: bool
) -> ContactFaces:
    nodes, axes, (ends, free) = assembly.nodes, face_axes(assembly), _ends(assembly)
    middle = np.array([face.middle for face in assembly.faces])
    arms = (nodes.position - middle[nodes.face]) / assembly.length
    centres = np.array([piece.centre for piece in assembly.pieces])
    return ContactFaces(
        law.rows(),
        np.ascontiguousarray((axes[nodes.face, 1:] * arms[:, None]).sum(axis=2).T),
        np.searchsorted(nodes.face, np.arange(len(axes) + 1)),
        axes,
        (middle[:, None] - centres[ends]) / assembly.length,
        np.where(free < 0, -1, order.begin[free]),
        np.zeros((len(ends), 2, 2, 6, 6)),
        stiff,
        order.inner,
        order.outer,
        order.band,
    )
