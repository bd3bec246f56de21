"""Equilibrium of rigid pieces on contact nodes, in terms of the pieces' displacements.

The contact law gives a node's force from the relative displacement of its two pieces, so the size
of the matrices in Newton's method depends on the number of pieces only, not on the mesh.
"""

import math
from copy import copy

import numpy as np

from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, components
from sidmacib.mechanics.contact_law.kernels import NORMAL
from sidmacib.mechanics.equilibrium import RIGID, face_axes, free_rows, row_units, soft_law
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.newton import LOST, PATIENT, QUICK, controlled, elastic, newton, put_at
from sidmacib.mechanics.newton.drift import falls, pushed, settled
from sidmacib.mechanics.newton.faces import (
    Applied,
    ContactFaces,
    new_point,
    put_slips,
)
from sidmacib.mechanics.newton.friction_rounds import EquilibriumSearch, by_rounds
from sidmacib.mechanics.newton.linear import Matrix
from sidmacib.mechanics.newton.stiffness import whole_faces
from sidmacib.mechanics.ordering import Ordering, ends_of, ordering
from sidmacib.mechanics.solution import (
    LARGEST_STEP,
    Equilibrium,
    Solver,
    farthest_motion,
    lifted_part,
)
from sidmacib.quantities import four_digits

# Unbalanced force over the loads, at equilibrium; and where faces are so stiff that they carry the
# rounding of displacements.
RESIDUAL, RESIDUAL_OF_STIFF = 1e-10, 1e-8
# Of a face's stiffness, see `sidmacib.mechanics.newton.faces.tangent_stiffness`; and of the
# stiffest face, at least: less is lost in rounding.
FLOOR, LEAST_FLOOR = 1e-10, 1e-14
DRAG = 1e-6  # over a face's stiffness, on pieces that move away: far less than holds them
# Of the assembly's length: the largest step of a path; that of pieces that bonds keep near, where
# one is sought thoroughly; how far a piece may drift to rest, and how far it is moved before, so
# that it does not stay where rest is not stable.
LEAP, LONGEST_LEAP, FAR, NUDGE = 0.01, 0.1, 0.05, 1e-9
DRAG_AT_START = 0.1  # over the stiffness of the stiffest face, on pieces that drift
AT_FIRST = 1e-3  # of the loads' scale: what may hold pieces that slide where nothing pushes
PUSHED = 1e-3  # of the assembly's length: how far pieces are followed that move away
# Stiffness of the stiffest face over that of the softest: above the first, rounding matters; above
# the second, Newton's method may not follow pieces that turn. Faces far below are as good as rigid.
STIFF, MOST_STIFF = 1e4, 1e6


class RigidSolver(Solver):
    """Newton's method on ``assembly`` under ``loads``.

    Callers see the displacements of the free pieces, in m and rad. Internally, displacements and
    forces have the units of `sidmacib.mechanics.newton.faces` and the order of `ordering`.
    `CapacityError` if faces differ in stiffness by more than `MOST_STIFF`.
    """

    finite = True

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        order, self.contact_law = ordering(assembly), ContactLaw.of(assembly)
        laws = {face.material for face in assembly.faces}
        both = [k for law in laws for k in (law.normal_stiffness, law.shear_stiffness)]
        ratio = max(both) / min(both)
        if ratio > MOST_STIFF * (1.0 + 1e-9):  # rounding of their quotient
            raise CapacityError(
                f"the stiffest face is {ratio:.3g} times as stiff as the softest; at most "
                f"{MOST_STIFF:g} times are computed, which is as good as rigid"
            )
        self.residual = RESIDUAL if ratio < STIFF else RESIDUAL_OF_STIFF
        self.contacts = _contact_faces(assembly, self.contact_law, order)
        self.soft = self.contacts._replace(
            law=soft_law(assembly).rows(), whole=np.zeros_like(self.contacts.whole)
        )
        self.here = new_point(self.contacts)
        self.matrix = _matrix(order)
        for each in (self.contacts, self.soft):
            whole_faces(each, self.here)
        self.free = [i for i, piece in enumerate(assembly.pieces) if not piece.fixed]
        self.most_opening, self.careful = assembly.most_opening, False
        inner = [face for face in assembly.faces if face.kind is Kind.INNER]
        bonded = {piece for face in inner for piece in (face.below, face.above)}
        self.drifts = not bonded.issuperset(self.free)
        self.bordered = _matrix(order, 1)
        self.place = (order.begin[:, None] + np.arange(RIGID)).ravel()
        self.turned = order.begin // RIGID  # of each free piece: its number in order
        self.size = assembly.length
        self.units, self.rows = row_units(assembly), free_rows(assembly)
        self.stiffness, softer = _stiffest(self.contacts), _stiffest(self.soft)
        self.floor = max(FLOOR * softer, LEAST_FLOOR * self.stiffness)
        self.drag = DRAG * softer
        number = np.arange(order.inner + order.outer)
        self.nudge = NUDGE * self.size * ((number * 37) % 13 - 6.0) / 6.0
        self._carry(loads)

    def under(self, loads: Loads) -> "RigidSolver":
        """The solver of the same assembly under other ``loads``; it shares what both compute in."""
        other = copy(self)
        other._carry(loads)
        return other

    def _carry(self, loads: Loads) -> None:
        loads.require_proportional()
        self.scale = loads.scale
        guided = -1 if loads.guided is None else self.turned[self.free.index(loads.guided)] * RIGID
        self.contacts, self.soft = (
            each._replace(guided=guided) for each in (self.contacts, self.soft)
        )
        self.levers = np.zeros((2, *self.here.turn.shape))
        self.levers[:, self.turned] = loads.levers()[:, self.free]
        self.weight = self._inside(loads.permanent.ravel()[self.rows] / self.units)
        self.load = self._inside(loads.variable.ravel()[self.rows] / self.units)
        reach = (
            np.abs(self._elastic(self.soft, force)).max()
            for force in (self.weight, loads.scale * self.load)
        )
        self.largest_step = LARGEST_STEP * float(sum(reach))

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone.

        Where no friction holds pieces, and none is found, under a small part of the load as well.
        """
        try:
            return self._start_at(0.0)
        except NoEquilibriumError:
            if self.contacts.guided < 0:
                raise
            return self._start_at(AT_FIRST * self.scale)

    def _start_at(self, load: float) -> Equilibrium:
        initial = NodeState.initial(self.contact_law.cohesive)
        rest = self._outside(self._elastic(self.contacts, self.weight + load * self.load))
        try:
            point = self.solve(load, rest, initial, thorough=True)
        except NoEquilibriumError:
            point = None
        if point is None or not self.stable(point):
            self.careful = True  # the pieces drift from where they were built
            return self.solve(load, np.zeros_like(rest), initial, thorough=True)
        return point

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the displacements and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method finds none nearby and, if ``thorough``,
        neither do rounds of given friction limits where bonds keep all pieces near; elsewhere
        pieces that drift from there do not come to rest.
        """
        target = self._applied(load)
        allowed = self.residual * float(np.abs(target.wrench).max())
        begin, slip = self._inside(guess * self.units), components(state.slip).copy()
        here, solved = self.here, (self.contacts, self.matrix, self.here, target)
        limits = self.floor, allowed, self.largest_step
        nodes = begin, slip, state.whole, limits
        rounds = thorough and not self.drifts  # which find what patience would
        lost = math.inf if self.drifts else LOST
        found = newton(*solved, *nodes, (*QUICK, lost))
        found = found or (not rounds and newton(*solved, *nodes, (*PATIENT, lost)))
        if found:
            leap = LONGEST_LEAP if rounds else LEAP
            found = float(np.abs(here.unknowns - begin).max()) <= leap * self.size
            found = found and not (self.careful and self._falls(target, slip, state.whole))
        if not found and thorough and self.drifts:
            drifts = DRAG_AT_START * self.stiffness, self.floor, allowed, FAR * self.size
            found = settled(*solved, begin + self.nudge, slip, state.whole, drifts)
            found = found and not self._falls(target, slip, state.whole)
        elif not found and rounds:
            at_nodes = slip, state.whole, self.stiffness
            found = by_rounds(EquilibriumSearch(*solved, *at_nodes, *limits), begin)
            found = found and not (self.careful and self._falls(target, slip, state.whole))
        if not found:
            raise NoEquilibriumError(f"no equilibrium at {four_digits(load)} N")
        return self._found(load, slip, state)

    def at_displacement(
        self, displacement: float, guess: Equilibrium, state: NodeState
    ) -> Equilibrium:
        """Equilibrium at a ``displacement`` along the load (m), from a ``guess`` and nodes' state.

        `NoEquilibriumError` if Newton's method finds none nearby.
        """
        contacts = self.contacts._replace(outer=self.contacts.outer + 1)
        loads = self._applied(0.0), Applied(self.load, self.levers[1])
        slip = components(state.slip).copy()
        most = float(np.abs(loads[0].wrench + guess.load * self.load).max())
        limits = self.floor, self.residual * most, self.largest_step
        begin = self._inside(guess.unknowns * self.units)
        found, load = controlled(
            *(contacts, self.bordered, self.here, loads, begin, guess.load, displacement),
            *(slip, state.whole, limits),
        )
        found = found and float(np.abs(self.here.unknowns - begin).max()) <= LEAP * self.size
        if not found:
            raise NoEquilibriumError(f"no equilibrium {displacement:g} m along the load")
        return self._found(load, slip, state)

    def _found(self, load: float, slip: Floats, state: NodeState) -> Equilibrium:
        """The equilibrium ``here``."""
        here = self.here
        put_slips(self.contacts, slip, state.whole, here, slip)
        displacement = math.fsum(self.load * here.unknowns)  # the same on every processor
        after = NodeState(slip.T, state.whole)
        unknowns, force = self._outside(here.unknowns), here.force.copy()
        rotation, moved = farthest_motion(unknowns)
        rotation = 2.0 * math.atan(rotation / 2.0)
        far = -float(here.moved[0].min()), float(here.moved[0].max())
        return Equilibrium(load, unknowns, displacement, force.T, after, rotation, moved, *far)

    def stable(self, point: Equilibrium) -> bool:
        """Whether the pieces return to ``point`` where they are moved a little."""
        target, slip = self._applied(point.load), components(point.state.slip)
        begin = self._inside(point.unknowns * self.units)
        put_at(self.contacts, slip, point.state.whole, target, self.here, begin)
        return not self._falls(target, slip, point.state.whole)

    def stable_only(self) -> None:
        """Find no other equilibria from here on."""
        self.careful = True

    def _falls(self, target: Applied, slip: Floats, whole: Floats) -> bool:
        nodes = self.contacts, slip, whole, target, self.matrix, self.here
        return bool(falls(*nodes, self.floor))

    def lift(self, point: Equilibrium, load: float) -> float:
        """Fraction of the pieces' motion that lifts them when they move away under ``load`` (N).

        All of it where faces open further than any of them slides.
        """
        motion, apart = self._pushed(point, load)
        opening, sliding = -apart[0].min(), np.hypot(apart[1], apart[2]).max()
        return 1.0 if opening > sliding else lifted_part(self.weight, motion)

    def motion(self, point: Equilibrium, load: float) -> Floats:
        """Displacements (m, rad) of the free pieces when they move away under ``load`` (N)."""
        return self._outside(self._pushed(point, load)[0])

    def _pushed(self, point: Equilibrium, load: float) -> tuple[Floats, Floats]:
        """Motion from ``point`` under a ``load`` (N) that nothing but drag carries.

        Of the pieces, (U,), and of the nodes, (3, N), in m.
        """
        begin, slip = self._inside(point.unknowns * self.units), components(point.state.slip)
        target, whole = self._applied(load), point.state.whole
        put_at(self.contacts, slip, whole, target, self.here, begin)
        before, solved = self.here.moved.copy(), (self.contacts, self.matrix, self.here)
        pushed(*solved, target, begin, slip, whole, self.drag, PUSHED * self.size)
        return np.asarray(self.here.unknowns - begin), np.asarray(self.here.moved - before)

    def _applied(self, load: float) -> Applied:
        levers = self.levers[0] + load * self.levers[1]
        return Applied(load * self.load + self.weight, levers)

    def _elastic(self, contacts: ContactFaces, target: Floats) -> Floats:
        """Unknowns of ``contacts`` under ``target`` (N) with every node closed and bonded."""
        return np.asarray(elastic(contacts, self.matrix, self.here, target, self.floor))

    def _inside(self, values: Floats) -> Floats:
        inside = np.empty_like(values)
        inside[self.place] = values
        return inside

    def _outside(self, unknowns: Floats) -> Floats:
        return np.asarray(unknowns[self.place] / self.units)


def _matrix(order: Ordering, more: int = 0) -> Matrix:
    """A matrix of the unknowns, and ``more`` behind them."""
    outer = order.outer + more
    return Matrix(
        np.empty((order.inner, 3 * order.band + 1)),
        np.empty((order.inner, outer)),
        np.empty((outer, order.inner + outer)),
    )


def _stiffest(contacts: ContactFaces) -> float:
    """Normal stiffness (N/m) of the stiffest face."""
    return float(np.add.reduceat(contacts.law[NORMAL], contacts.start[:-1]).max())


def _contact_faces(assembly: Assembly, law: ContactLaw, order: Ordering) -> ContactFaces:
    nodes, axes, (ends, free) = assembly.nodes, face_axes(assembly), ends_of(assembly)
    middle = np.array([face.middle for face in assembly.faces])
    arms = nodes.position - middle[nodes.face]
    centres = np.array([piece.centre for piece in assembly.pieces])
    normal = np.array([face.material.normal_stiffness for face in assembly.faces])
    of_triangle = nodes.face[nodes.triangles[:, 0]]
    return ContactFaces(
        law.rows(),
        np.ascontiguousarray((axes[nodes.face, 1:] * arms[:, None]).sum(axis=2).T),
        np.searchsorted(nodes.face, np.arange(len(axes) + 1)),
        axes,
        middle[:, None] - centres[ends],
        np.where(free < 0, -1, order.begin[free]),
        nodes.triangles,
        normal[of_triangle] * nodes.parts,
        np.searchsorted(of_triangle, np.arange(len(axes) + 1)),
        np.zeros((len(ends), 6, 6)),
        assembly.length,
        assembly.share,
        -1,
        float(normal.max()) * assembly.length**2,
        order.inner,
        order.outer,
        order.band,
    )
