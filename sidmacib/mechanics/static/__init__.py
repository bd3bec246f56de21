"""The static model of an assembly: equilibrium of pieces on springs that can fail.

The load rises in increments, so that friction has its history. When a node reaches its strength it
loses all of it at once, together with the nodes that fail at the same load, and a new equilibrium
is sought at that load; if there is none, the load is the peak. A solver finds the equilibria: one
for rigid pieces, whose forces balance where they have moved to, one for elastic pieces, whose
forces balance where they were built. Equilibria in which a piece has turned by more than 2 degrees
where bonds have failed do not count, as it may meet others there. Before, locks may not come apart
by more than a share of their height.

Pieces may also move away while all bonds are whole. To see how, the model pushes them slightly
beyond the peak, against drag. If that lifts them against the permanent loads they rock; otherwise
they slide, as sliding along plane faces lifts nothing.
"""

import importlib
import math
from dataclasses import replace

import numpy as np

from sidmacib.errors import NoEquilibriumError, NoStiffnessError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import compliance
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import (
    Equilibrium,
    FirstFailure,
    Mode,
    SmallMotions,
    Solver,
    StaticSolution,
)
from sidmacib.mechanics.static.path import (
    DEEP,
    FARTHEST_TURN,
    INCREMENT,
    LEAST_LOAD,
    MOST_LOAD,
    guess_at,
    raised,
    redistributed,
)
from sidmacib.mechanics.static.softening import Softening, softened_equilibrium
from sidmacib.quantities import four_digits
from sidmacib.validation import require_positive

FEWEST = 8.0  # increments to the end of a path that is compared: a few agree by chance
LEAST_REFINEMENT = 1 / 64  # the least factor on these increments
# Change of the end of a path when increments are halved, over the load: converged. Where bonds
# fail, and where the joint slides or rocks, which depends more on the history of friction.
HISTORY, MOTION = 1e-3, 2.5e-4
SOFTENING_INCREMENT = 0.02  # largest load increment of softening bonds, over the first failure
SOFTENING_GROWTH = 1e-3  # over the load: at least so much, as long as none had to be halved
LEAST_SOFTENING_INCREMENT = 1e-4  # over the load: precision of their peak
MOST_DISPLACEMENT = 200.0  # over that of whole bonds, as in the engines; more is failure
# Largest rotation (rad) of a piece behind the first failure, and over that at it, if this is more:
# a column that has broken off and turns further need not be held, as forces act elsewhere.
MOST_ROTATION, TURNED = 0.035, 2.0
BEYOND = 0.01  # over the peak: excess of the load at which the motion of the pieces is seen
LIFT = 1e-3  # least fraction of the motion that counts as lifting; rounding and elasticity: 1e-5
NEARLY = 0.99  # of the largest opening: where a path ends that it limits


def solver_of(assembly: Assembly, loads: Loads) -> Solver:
    """The solver for ``assembly``: the one for elastic pieces if any free piece is elastic.

    `NoStiffnessError` for contact points in place of locks.
    """
    if reason := assembly.without_stiffness:
        raise NoStiffnessError(reason)
    if assembly.elastic:
        # Imported here: finite elements take longer to import than most joints to solve.
        elastic = importlib.import_module("sidmacib.mechanics.elastic")
        return elastic.ElasticSolver(assembly, loads)
    return RigidSolver(assembly, loads)


def static_first_failure(
    assembly: Assembly, loads: Loads, *, increment: float | None = None
) -> FirstFailure:
    """Raise ``loads`` from 0 to the first failure of ``assembly``, on the path of `static_peak`.

    ``increment``: the largest increment over the loads' scale; None: increments are halved until
    the first failure converges, as friction depends on its history. Errors of `static_peak`, and
    ValueError unless ``increment`` is above 0.
    """
    return first_failure_of(solver_of(assembly, loads), increment)


def first_failure_of(solver: Solver, increment: float | None = None) -> FirstFailure:
    """`static_first_failure` by a ``solver`` that is there."""
    if increment is None:
        path, failing, refinement = _to_first_failure(solver)
        increment = refinement * INCREMENT
    else:
        require_positive(increment=increment)
        limited = SmallMotions(solver, opening=solver.most_opening)
        path, failing = raised(limited, [solver.start()], increment / INCREMENT)
    mode = Mode.BONDS if failing.any() else _motion(solver, path[-1])
    return FirstFailure(path[-1], failing, mode, increment)


def static_peak(assembly: Assembly, loads: Loads) -> StaticSolution:
    """Raise ``loads`` from 0 to the peak of ``assembly``, on a single path.

    `sidmacib.mechanics.static.peaks` looks for lower ones.

    Raises `NoEquilibriumError` if there is no equilibrium under the permanent loads,
    `UnboundedError` if the assembly carries any load.
    """
    solver = solver_of(assembly, loads)
    if assembly.failure is not Failure.BRITTLE:
        return _softened(solver, assembly, loads)
    return peak_of(solver)


def peak_of(solver: Solver) -> StaticSolution:
    """`static_peak` of brittle bonds by a ``solver`` that is there."""
    return _with_motion(solver, *brittle_path(solver))


def another_peak(solver: Solver, searches: Solver, other: StaticSolution) -> StaticSolution:
    """A path like that of ``other`` up to the first failure, and by ``searches`` from there.

    ``solver``: that of ``other``; ``searches``: it, or one that finds other equilibria of the same
    assembly. At the peak of ``other`` they are not thorough: whether a path ends there or goes on,
    its peak is no lower. Errors of `brittle_path`.
    """
    last = next(i for i, at in enumerate(other.path) if at.load >= other.first_failure_load)
    path, failing = raised(searches, [*other.path[: last + 1]], other.refinement)
    found, end = _after_first_failure(searches, path, failing, other.refinement, other)
    return _with_motion(solver, replace(found, first_failure_load=other.first_failure_load), end)


def _with_motion(solver: Solver, found: StaticSolution, last: Equilibrium) -> StaticSolution:
    """The path with the motion of the pieces from its ``last`` equilibrium, unless bonds fail."""
    return found if found.mode is Mode.BONDS else replace(found, mode=_motion(solver, last))


def brittle_path(solver: Solver) -> tuple[StaticSolution, Equilibrium]:
    """Raise the load of ``solver`` from 0 until no equilibrium follows.

    Returns the path to the peak, and the last equilibrium, at that load with more bonds broken.
    Unless bonds fail, the mode says no more than that pieces move. Increments are halved until the
    first failure converges. Errors of ``solver``, and `UnboundedError` if the assembly carries any
    load.
    """
    return _after_first_failure(solver, *_to_first_failure(solver))


def _after_first_failure(
    solver: Solver,
    path: list[Equilibrium],
    failing: Flags,
    refinement: float,
    other: StaticSolution | None = None,
) -> tuple[StaticSolution, Equilibrium]:
    """``path`` to the first failure, where nodes are ``failing``, and what follows.

    ``other``: another path of the same assembly, if it is known.
    """
    first_failure, mode = path[-1].load, Mode.MECHANISM
    near = _small_motions(solver, path[-1])
    while failing.any():
        thorough = other is None or path[-1].load < other.peak.load * (1.0 - HISTORY)
        after = redistributed(near, path[-1], failing, thorough=thorough)
        if after is None:
            mode = Mode.BONDS
            break
        path, failing = raised(near, [*path, after], refinement)
    to_peak = path[: int(np.argmax([point.load for point in path])) + 1]
    turns = near.exceeded and mode is not Mode.BONDS
    return StaticSolution(first_failure, tuple(to_peak), mode, refinement, turns=turns), path[-1]


def _small_motions(solver: Solver, first_failure: Equilibrium) -> SmallMotions:
    return SmallMotions(solver, max(MOST_ROTATION, TURNED * first_failure.rotation))


def _softened(solver: Solver, assembly: Assembly, loads: Loads) -> StaticSolution:
    """`static_peak` with softening or ductile bonds: the increment is halved if a load fails."""
    softening, scale = Softening.of(assembly), loads.scale
    path, failing, _ = _to_first_failure(solver)
    first_failure = path[-1].load
    if not failing.any():
        return StaticSolution(first_failure, tuple(path), _motion(solver, path[-1]))
    near = _small_motions(solver, path[-1])
    increment, halved = SOFTENING_INCREMENT * (first_failure or scale), False
    # Bonds with next to no tensile strength fail before the load is raised, or soon after.
    moved = abs(path[-1].displacement)
    per_newton = moved / first_failure if first_failure else compliance(assembly, loads)
    while increment > LEAST_SOFTENING_INCREMENT * path[-1].load:
        low = path[-1]
        if low.load > MOST_LOAD * scale:
            raise UnboundedError(
                f"no peak up to {four_digits(low.load)} N: the load can grow without limit"
            )
        load = low.load + increment
        try:
            point = softened_equilibrium(
                near, softening, load, guess_at(load, path, None), low.state
            )
        except NoEquilibriumError:
            increment, halved = increment / 2, True
            continue
        if abs(point.displacement) > MOST_DISPLACEMENT * load * per_newton:
            increment, halved = increment / 2, True
        else:
            path.append(point)
            if not halved:  # far above the first failure, too small an increment ends the path
                increment = max(increment, SOFTENING_GROWTH * load)
    mode = _motion(solver, path[-1]) if near.exceeded else Mode.BONDS
    return StaticSolution(first_failure, tuple(path), mode, turns=near.exceeded)


def _motion(solver: Solver, point: Equilibrium) -> Mode:
    """How pieces move away beyond the peak ``point``, where no bond is at its strength."""
    whole = np.array_equal(point.state.whole, solver.contact_law.cohesive)
    if whole and point.opening > NEARLY * solver.most_opening:
        return Mode.APART
    if solver.finite and point.closing >= DEEP * solver.size:
        return Mode.PRESSED
    if solver.finite and point.rotation >= FARTHEST_TURN:
        return Mode.TURNED
    load = point.load + BEYOND * max(point.load, LEAST_LOAD * solver.scale)
    return Mode.ROCKING if solver.lift(point, load) > LIFT else Mode.MECHANISM


def _to_first_failure(solver: Solver) -> tuple[list[Equilibrium], Flags, float]:
    """The path to the first failure, the nodes that fail there, and the refinement of increments.

    Friction depends on its history, which increments follow to first order. So if contacts have
    slipped on the path, it is compared with one of twice the increments, and these are halved until
    the first failure no longer changes and the path has at least `FEWEST` of them. The loads at the
    ends of two paths may agree by chance while both step over a failure, where the utilisation
    stays near 1 over a range of loads. So their utilisations are compared as well, see `_doubted`.
    A path on which the solver gives up before a bond fails is not used. No face opens by more
    than is allowed.
    """
    start, refinement = solver.start(), 1.0
    solver = SmallMotions(solver, opening=solver.most_opening)
    path, failing = raised(solver, [start])
    if not any(point.state.slip.any() for point in path):
        return path, failing, refinement
    coarser: list[Equilibrium] = []
    while refinement > LEAST_REFINEMENT:
        with_fewest = path[-1].load / (INCREMENT * solver.scale * FEWEST)
        if with_fewest >= refinement:
            coarser = coarser or raised(solver, [start], 2.0 * refinement)[0]
            if not _doubted(solver, coarser, path, bonds=bool(failing.any())):
                break
        with_fewest = max(min(with_fewest, refinement / 2), LEAST_REFINEMENT)
        next_one = 2.0 ** math.floor(math.log2(with_fewest))
        finer, finer_failing = raised(solver, [start], next_one)
        if failing.any() and not finer_failing.any():
            break
        coarser = path if next_one == refinement / 2 else []
        path, failing, refinement = finer, finer_failing, next_one
    return path, failing, refinement


def _doubted(
    solver: Solver, coarser: list[Equilibrium], path: list[Equilibrium], *, bonds: bool
) -> bool:
    """Whether ``path`` may not end where it would with infinitely small increments.

    Increments of half the size halve the error of utilisations, so that the error left on ``path``
    is its difference from a ``coarser`` one. It is added to the utilisation of every equilibrium:
    a failure that this puts before the end of the path was perhaps stepped over. ``bonds``: whether
    the path ends as a bond fails.
    """
    if abs(coarser[-1].load - path[-1].load) > (HISTORY if bonds else MOTION) * path[-1].load:
        return True
    loads, used = _profile(solver, path)
    coarser_loads, coarser_used = _profile(solver, coarser)
    both = coarser_loads <= loads[-1]
    change = np.abs(np.interp(coarser_loads, loads, used) - coarser_used)[both].max()
    return bool((used[loads < (1.0 - HISTORY) * loads[-1]] + change > 1.0).any())


def _profile(solver: Solver, path: list[Equilibrium]) -> tuple[Floats, Floats]:
    """Loads (N) along ``path``, and the largest utilisation at each, both (P,)."""
    used = [utilisation(solver.contact_law, point.state, point.force).max() for point in path]
    return np.array([point.load for point in path]), np.array(used)
