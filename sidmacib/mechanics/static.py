"""Static brittle model of an assembly: equilibrium of pieces on springs that can fail.

The load rises in increments, which gives friction its history. When the first node fails, all of
its strength goes at once (those that fail together go together) and a new equilibrium is sought at
the same load; where none exists is the peak. How an equilibrium is found is up to a solver: one for
rigid pieces, one for pieces that deform.

Pieces may also move off with all bonds whole. How they do is seen by pushing on, slightly beyond
the peak, against drag. They rock where that lifts them against what always acts: sliding along
plane faces lifts nothing.
"""

import importlib
from dataclasses import replace

import numpy as np

from sidmacib.errors import NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats, Loads
from sidmacib.mechanics.contact_law import Flags, utilisation
from sidmacib.mechanics.path import (
    LEAST_INCREMENT,
    Equilibrium,
    FirstFailure,
    Mode,
    Solver,
    StaticSolution,
)
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.softening import Softening, settled
from sidmacib.validation import require_positive

INCREMENT = 0.1  # largest load increment over the loads' scale,
GROWTH = 0.01  # or over the load where that is more
LEAST_FINE = 1 / 16  # part of these increments that the history of friction may ask for
HISTORY = 1e-3  # over the load: what half the increments may change at the first failure
LEAST_LOAD = 1e-3  # or over this part of the loads' scale where the load is less
MOST_LOAD = 1e9  # over the loads' scale: what carries this carries any load
SOFTENING_INCREMENT = 0.02  # of the load, over the first failure, where bonds fade,
LEAST_SOFTENING_INCREMENT = 1e-4  # over the load: where the search for the peak ends
FARTHEST = 200.0  # displacement over that of whole bonds, as in the engines: more is failure
BEYOND = 0.01  # over the peak: load at which pieces are seen to move off
LIFT = 1e-3  # part of their motion that lifts, at least; rounding and elasticity make 1e-5
TOGETHER = 1e-5  # nodes fail together whose utilisations differ by less


def solver_of(assembly: Assembly, loads: Loads) -> Solver:
    """The solver for ``assembly``: for rigid pieces, unless one of them deforms."""
    if any(piece.elastic and not piece.fixed for piece in assembly.pieces):
        # Imported where it is needed: elements take longer to import than most joints to solve.
        deformable = importlib.import_module("sidmacib.mechanics.deformable")
        return deformable.DeformableSolver(assembly, loads)
    return RigidSolver(assembly, loads)


def static_first_failure(
    assembly: Assembly, loads: Loads, *, increment: float | None = None
) -> FirstFailure:
    """Raise ``loads`` from 0 to the first failure of ``assembly``, on the path of `static_peak`.

    ``increment``: the largest one over the loads' scale, on a path of its own; without one they are
    as small as the history of friction asks for. Errors as there, and ValueError unless it is
    positive.
    """
    solver = solver_of(assembly, loads)
    if increment is None:
        path, failing, _ = _to_first_failure(solver, loads.scale)
    else:
        require_positive(increment=increment)
        path, failing = _raised(solver, [solver.start()], loads.scale, increment / INCREMENT)
    mode = Mode.BONDS if failing.any() else _motion(solver, path[-1], loads.scale)
    return FirstFailure(path[-1], failing, mode)


def static_peak(assembly: Assembly, loads: Loads) -> StaticSolution:
    """Raise ``loads`` from 0 to the peak of ``assembly``.

    Raises `NoEquilibriumError` if it does not stand under its permanent loads, `UnboundedError` if
    it carries any load.
    """
    if assembly.failure is not Failure.BRITTLE:
        return _softened(assembly, loads)
    solver = solver_of(assembly, loads)
    path, failing, fine = _to_first_failure(solver, loads.scale)
    first_failure, mode = path[-1].load, Mode.BONDS
    while failing.any():
        try:
            path.append(_redistributed(solver, path[-1], failing))
        except NoEquilibriumError:
            break
        path, failing = _raised(solver, path, loads.scale, fine)
    else:
        mode = _motion(solver, path[-1], loads.scale)
    peak = int(np.argmax([point.load for point in path]))  # bonds fail at the peak, at that load
    return StaticSolution(first_failure, tuple(path[: peak + 1]), mode)


def _softened(assembly: Assembly, loads: Loads) -> StaticSolution:
    """The same where bonds fade: increments are halved where no equilibrium is found nearby."""
    solver, softening = solver_of(assembly, loads), Softening.of(assembly)
    path, failing, _ = _to_first_failure(solver, loads.scale)
    first_failure = path[-1].load
    if not failing.any():
        return StaticSolution(first_failure, tuple(path), _motion(solver, path[-1], loads.scale))
    increment = SOFTENING_INCREMENT * first_failure
    give = abs(path[-1].displacement) / first_failure
    while increment > LEAST_SOFTENING_INCREMENT * path[-1].load:
        low = path[-1]
        if low.load > MOST_LOAD * loads.scale:
            raise UnboundedError(f"no peak up to {low.load:g} N: the load can grow without limit")
        load = low.load + increment
        try:
            point = settled(solver, softening, load, _guess(load, path, None), low.state)
        except NoEquilibriumError:
            increment /= 2
            continue
        if abs(point.displacement) > FARTHEST * load * give:
            increment /= 2
        else:
            path.append(point)
    return StaticSolution(first_failure, tuple(path), Mode.BONDS)


def _motion(solver: Solver, point: Equilibrium, scale: float) -> Mode:
    """How pieces move off beyond the peak ``point``, no bond being at its strength."""
    load = point.load + BEYOND * max(point.load, LEAST_LOAD * scale)
    return Mode.ROCKING if solver.lift(point, load) > LIFT else Mode.MECHANISM


def _to_first_failure(solver: Solver, scale: float) -> tuple[list[Equilibrium], Flags, float]:
    """The path to the first failure, the nodes that fail there, and how fine its increments are.

    Friction depends on its history, which increments follow to first order: where contacts have
    slipped on the way the increments are halved until the first failure stays where it is. A path
    on which the solver gives up before a bond fails is not taken.
    """
    start, fine = solver.start(), 1.0
    path, failing = _raised(solver, [start], scale)
    while fine > LEAST_FINE and any(point.state.slip.any() for point in path):
        closer, fail = _raised(solver, [start], scale, fine / 2)
        gave_up = failing.any() and not fail.any()
        if gave_up or abs(closer[-1].load - path[-1].load) <= HISTORY * path[-1].load:
            break
        path, failing, fine = closer, fail, fine / 2
    return path, failing, fine


def _raised(
    solver: Solver, path: list[Equilibrium], scale: float, fine: float = 1.0
) -> tuple[list[Equilibrium], Flags]:
    """Raise the load until nodes are about to fail, in increments that suit loads of ``scale`` (N).

    ``fine``: what these are multiplied by.

    Returns the path to there and which nodes fail: none where the load cannot rise any more. Where
    no equilibrium is found the increment is halved, and doubled again where one is: Newton's method
    may fail from afar and arrive from nearby. Where it does not, the solver is thorough from there.
    """

    def used(point: Equilibrium) -> Floats:
        return utilisation(solver.law, point.state, point.force)

    def least(load: float) -> float:
        return LEAST_INCREMENT * max(load, LEAST_LOAD * scale)

    path, increment, thorough = list(path), fine * INCREMENT * scale, False
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
            if thorough:
                return path, np.zeros(len(low.force), bool)
            thorough = True
        load = low.load + increment
        if above:  # where the utilisation, all but linear, comes just below 1
            share = (1.0 - most) / (over.max() - most) if np.isfinite(over.max()) else 0.5
            near = low.load + (above.load - low.load) * min(share, 0.99) * (1.0 - 1e-7)
            load = min(load, max(near, low.load + least(above.load) / 2))
        try:
            point = solver.solve(load, _guess(load, path, above), low.state, thorough=thorough)
        except NoEquilibriumError:
            increment = (load - low.load) / 2
            continue
        reached = used(point)
        if reached.max() > 1.0:
            above, over = point, reached
        else:
            path.append(point)
            own = reached
            increment = min(2 * increment, fine * max(INCREMENT * scale, GROWTH * load))
    raise UnboundedError(f"no failure up to {path[-1].load:g} N: the load can grow without limit")


def _guess(load: float, path: list[Equilibrium], above: Equilibrium | None) -> Floats:
    """Unknowns at ``load``, on a line through the equilibria next to it."""
    low = path[-1]
    other = above or (path[-2] if len(path) > 1 else low)
    if other.load == low.load:
        return low.unknowns
    onward = (load - low.load) / (other.load - low.load)
    return low.unknowns + onward * (other.unknowns - low.unknowns)


def _redistributed(solver: Solver, point: Equilibrium, failing: Flags) -> Equilibrium:
    """The equilibrium at the same load after nodes have failed, and those that fail in turn.

    Raises `NoEquilibriumError` if there is none.
    """
    state = point.state
    while failing.any():
        state = replace(state, whole=np.where(failing, 0.0, state.whole))
        after = solver.solve(point.load, point.unknowns, state, thorough=True)
        failing = utilisation(solver.law, state, after.force) > 1.0
    return after
