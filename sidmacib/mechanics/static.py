"""Static brittle model of an assembly: equilibrium of pieces on springs that can fail.

The unknowns are the displacements of every free piece. A node's force follows from the relative
displacement of its two pieces by `sidmacib.mechanics.contact_law`, so Newton's method needs
matrices of the size of the pieces, however fine the mesh. The load rises in increments, which gives
friction its history. When the first node fails, all of its strength goes at once (those that fail
together go together) and a new equilibrium is sought at the same load; where none exists is the
peak.

Pieces may also move off with all bonds whole. How they do is seen by pushing on, slightly beyond
the peak, against drag. They rock where that lifts them against what always acts: sliding along
plane faces lifts nothing.
"""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sidmacib.errors import NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats, Loads
from sidmacib.mechanics.contact_law import Flags, NodeState, utilisation
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.newton import Matrix, Structure, elastic, equilibrium
from sidmacib.mechanics.ordering import Ordering, ordering
from sidmacib.mechanics.springs import Springs

INCREMENT = 0.1  # largest load increment over the loads' scale,
GROWTH = 0.01  # or over the load where that is more
LEAST_INCREMENT = 1e-5  # over the load: where the search for a failure or for the peak ends,
LEAST_LOAD = 1e-3  # or over this part of the loads' scale where the load is less
MOST_LOAD = 1e9  # over the loads' scale: what carries this carries any load
TOGETHER = 1e-5  # nodes fail together whose utilisations differ by less
RESIDUAL = 1e-10  # unbalanced force over the loads, at equilibrium
FLOOR = 1e-10  # of a face's stiffness, see `sidmacib.mechanics.newton.tangent_stiffness`
FARTHEST = 1e5  # Newton step over the displacements of the unbroken assembly
BEYOND = 0.01  # over the peak: load at which pieces are seen to move off
DRAG = 1e-6  # on them, over a face's stiffness: what they move off by is far from elastic
LIFT = 1e-3  # part of their motion that lifts, at least; rounding and elasticity make 1e-5


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium of the assembly.

    ``load``: along the direction of loading, in N. ``displacement``: of the free pieces, (6 F,), in
    m and rad. ``force``: (N, 3) in N, what the piece below each node exerts on the piece above in
    the frame of the face: normal (compression positive) and two tangents. ``state``: of the nodes.
    """

    load: float
    displacement: Floats
    force: Floats
    state: NodeState


class Mode(StrEnum):
    """Why the load cannot rise beyond the peak."""

    BONDS = "bonds"  # they fail, and no equilibrium follows
    MECHANISM = "mechanism"  # pieces slide although no bond is at its strength
    ROCKING = "rocking"  # pieces are lifted against what always acts, and no bond is either


@dataclass(frozen=True)
class StaticSolution:
    """The path of the assembly to its peak.

    ``first_failure_load`` in N: where the first node fails, or that of the peak if none does.
    ``path``: the equilibria on the way; the last is the peak. ``mode``: why it is.
    """

    first_failure_load: float
    path: tuple[Equilibrium, ...]
    mode: Mode

    @property
    def peak(self) -> Equilibrium:
        """The equilibrium at the largest load."""
        return self.path[-1]

    @property
    def failed_load(self) -> float:
        """Just above the peak, where bonds fail and no equilibrium follows, in N."""
        return self.peak.load * (1.0 + LEAST_INCREMENT)


class Solver:
    """Newton's method on ``assembly`` under ``loads``.

    Inside, unknowns and forces are measured as in `sidmacib.mechanics.springs` and in the order of
    `sidmacib.mechanics.ordering`.
    """

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        springs = Springs.of(assembly)
        order, rows = ordering(springs), free_rows(assembly)
        self.law = springs.law
        self.structure, self.matrix = _structure(springs, order), _matrix(order)
        size = np.diff(springs.unknowns)
        self.place = np.arange(springs.unknowns[-1])
        self.place += np.repeat(order.begin - springs.unknowns[:-1], size)
        self.units = springs.units
        self.weight = self._inside(loads.permanent.ravel()[rows] / self.units)
        self.load = self._inside(loads.variable.ravel()[rows] / self.units)
        per_face = np.add.reduceat(self.law.normal_stiffness, springs.start[:-1])
        self.floor, self.drag = FLOOR * float(per_face.max()), DRAG * float(per_face.max())
        self.rest, reach = self._elastic(self.weight), self._elastic(loads.scale * self.load)
        self.farthest = FARTHEST * float(np.abs(self.rest).max() + np.abs(reach).max())

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        return self.solve(0.0, self._outside(self.rest), NodeState.initial(self.law))

    def solve(self, load: float, guess: Floats, state: NodeState) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the displacements and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method ends nowhere.
        """
        target = load * self.load + self.weight
        allowed = RESIDUAL * float(np.abs(target).max())
        begin = self._inside(guess * self.units)
        found, unknowns, force, slip = equilibrium(
            self.structure,
            self.matrix,
            target,
            begin,
            state.slip,
            state.bonded,
            (self.floor, allowed, self.farthest),
        )
        if not found:
            raise NoEquilibriumError(f"no equilibrium at {load:g} N")
        return Equilibrium(load, self._outside(unknowns), force, NodeState(slip, state.bonded))

    def lift(self, point: Equilibrium, load: float) -> float:
        """Part of the pieces' motion that lifts them where they move off under ``load`` (N).

        It is the cosine between their displacements and the opposite of what always acts.
        """
        target = load * self.load + self.weight
        begin = self._inside(point.displacement * self.units)
        # Newton's steps with drag in place of a floor: as nothing carries the load, they go on.
        limits = self.drag, 0.0, math.inf
        state = point.state
        _, end, _, _ = equilibrium(
            self.structure, self.matrix, target, begin, state.slip, state.bonded, limits
        )
        moved = end - begin
        size = float(np.linalg.norm(self.weight) * np.linalg.norm(moved))
        return -float(self.weight @ moved) / size if size else 0.0

    def _elastic(self, target: Floats) -> Floats:
        """Unknowns under ``target`` (N) with every node closed and bonded."""
        count = len(self.law.friction)
        slip, bonded = np.zeros((count, 2)), np.ones(count, bool)
        found = elastic(self.structure, self.matrix, target, slip, bonded, self.floor)
        return np.asarray(found)

    def _inside(self, values: Floats) -> Floats:
        inside = np.empty_like(values)
        inside[self.place] = values
        return inside

    def _outside(self, unknowns: Floats) -> Floats:
        return np.asarray(unknowns[self.place] / self.units)


def static_peak(assembly: Assembly, loads: Loads) -> StaticSolution:
    """Raise ``loads`` from 0 to the peak of ``assembly``.

    Raises `NoEquilibriumError` if it does not stand under its permanent loads, `UnboundedError` if
    it carries any load, ValueError if its failure is not brittle.
    """
    if assembly.failure is not Failure.BRITTLE:
        raise ValueError(f"failure: {assembly.failure} is not known here, only {Failure.BRITTLE}")
    solver = Solver(assembly, loads)
    path = [solver.start()]
    first_failure: float | None = None
    while True:
        path, failing = _raised(solver, path, loads.scale)
        first_failure = path[-1].load if first_failure is None else first_failure
        if not failing.any():
            mode = _motion(solver, path[-1], loads.scale)
            break
        try:
            path.append(_redistributed(solver, path[-1], failing))
        except NoEquilibriumError:
            mode = Mode.BONDS
            break
    peak = int(np.argmax([point.load for point in path]))  # bonds fail at the peak, at that load
    return StaticSolution(first_failure, tuple(path[: peak + 1]), mode)


def _motion(solver: Solver, point: Equilibrium, scale: float) -> Mode:
    """How pieces move off beyond the peak ``point``, no bond being at its strength."""
    load = point.load + BEYOND * max(point.load, LEAST_LOAD * scale)
    return Mode.ROCKING if solver.lift(point, load) > LIFT else Mode.MECHANISM


def _raised(
    solver: Solver, path: list[Equilibrium], scale: float
) -> tuple[list[Equilibrium], Flags]:
    """Raise the load until nodes are about to fail, in increments that suit loads of ``scale`` (N).

    Returns the path to there and which nodes fail: none where the load cannot rise any more. Where
    no equilibrium is found the increment is halved, and doubled again where one is: Newton's method
    may fail from afar and arrive from nearby.
    """

    def used(point: Equilibrium) -> Floats:
        return utilisation(solver.law, point.state, point.force)

    def least(load: float) -> float:
        return LEAST_INCREMENT * max(load, LEAST_LOAD * scale)

    path, increment = list(path), INCREMENT * scale
    own = used(path[-1])
    above: Equilibrium | None = None  # at a load that is too high: a bond is overstressed
    over = own
    while path[-1].load <= MOST_LOAD * scale:
        low, most = path[-1], own.max()
        if most >= 1.0 - LEAST_INCREMENT:
            return path, own >= most * (1.0 - TOGETHER)
        if above and above.load - low.load <= least(above.load):
            return path, over >= 1.0
        if increment <= least(low.load + increment):
            return path, np.zeros(len(low.force), bool)
        load = low.load + increment
        if above:  # where the utilisation, all but linear, comes just below 1
            share = (1.0 - most) / (over.max() - most) if np.isfinite(over.max()) else 0.5
            near = low.load + (above.load - low.load) * min(share, 0.99) * (1.0 - 1e-7)
            load = min(load, max(near, low.load + least(above.load) / 2))
        try:
            point = solver.solve(load, _guess(load, path, above), low.state)
        except NoEquilibriumError:
            increment = (load - low.load) / 2
            continue
        reached = used(point)
        if reached.max() > 1.0:
            above, over = point, reached
        else:
            path.append(point)
            own = reached
            increment = min(2 * increment, max(INCREMENT * scale, GROWTH * load))
    raise UnboundedError(f"no failure up to {path[-1].load:g} N: the load can grow without limit")


def _guess(load: float, path: list[Equilibrium], above: Equilibrium | None) -> Floats:
    """Displacements at ``load``, on a line through the equilibria next to it."""
    low = path[-1]
    other = above or (path[-2] if len(path) > 1 else low)
    if other.load == low.load:
        return low.displacement
    onward = (load - low.load) / (other.load - low.load)
    return low.displacement + onward * (other.displacement - low.displacement)


def _redistributed(solver: Solver, point: Equilibrium, failing: Flags) -> Equilibrium:
    """The equilibrium at the same load after nodes have failed, and those that fail in turn.

    Raises `NoEquilibriumError` if there is none.
    """
    state = point.state
    while failing.any():
        state = replace(state, bonded=state.bonded & ~failing)
        after = solver.solve(point.load, point.displacement, state)
        failing = utilisation(solver.law, state, after.force) > 1.0
    return after


def _structure(springs: Springs, order: Ordering) -> Structure:
    law = springs.law
    return Structure(
        np.column_stack([law.normal_stiffness, law.shear_stiffness, law.friction, springs.place]),
        springs.start,
        springs.motion,
        np.where(springs.piece < 0, -1, order.begin[springs.piece]),
        order.inner,
        order.outer,
        order.band,
    )


def _matrix(order: Ordering) -> Matrix:
    inner, outer = order.inner, order.outer
    return Matrix(
        np.empty((inner, 3 * order.band + 1)),
        np.empty((inner, outer)),
        np.empty((outer, inner + outer)),
    )
