"""The path of an assembly as its load is raised, up to its top, or to where a bond fails.

The load rises in increments. Where no equilibrium is found above, displacements are given instead,
through the top of the path. Beyond it pieces may come to rest elsewhere, and the path goes on.
"""

import math
from dataclasses import replace

import numpy as np

from sidmacib.errors import NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.solution import LEAST_INCREMENT, Equilibrium, Solver
from sidmacib.quantities import four_digits

INCREMENT = 0.1  # largest load increment over the loads' scale,
GROWTH = 0.01  # or over the load where that is more
PATIENCE = 1 / 16  # of the largest increment: below it the solver is thorough
MOST_TO_THE_TOP = 100  # steps in which a displacement is given
AT_THE_TOP = 1e-6  # of the load: how far it may fall in a step from the top, which is then found
# Of the load: so far above it, pieces that drift may come to rest elsewhere, or rounds of friction
# settle that did not just below, which is tried so many times on a path.
OVER_THE_TOP, MOST_OVER = 1e-3, 10
LEAST_LOAD = 1e-3  # over the loads' scale: tolerances are relative to this load or a larger one
MOST_LOAD = 1e9  # over the loads' scale: an assembly that carries this carries any load
DEEP = 0.1  # of the assembly's length: faces pressed in by so much are no joints any more
FARTHEST_TURN = 0.05  # rad: a piece that has turned so far is not where it was built any more
TOGETHER = 1e-5  # nodes whose utilisations differ by less fail together
SAME_TOP = 1e-2  # of the load: a top this near to another is it, with other increments


def raised(
    solver: Solver, path: list[Equilibrium], refinement: float = 1.0
) -> tuple[list[Equilibrium], Flags]:
    """Raise the load from the last equilibrium of ``path`` until nodes are about to fail.

    Increments are fractions of the scale of the loads; ``refinement``: a factor on them. Returns
    the path to there and the nodes that fail: none if the load cannot rise further. Where the path
    would end at an equilibrium that is not stable, it is followed again on stable ones only.
    """
    found = _Rise(solver, path, refinement).to_its_end()
    if solver.stable(found[0][-1]):
        return found
    solver.stable_only()
    return _Rise(solver, path, refinement).to_its_end()


class _Rise:
    """A path on which the load rises.

    The increment is halved where no equilibrium is found, as Newton's method may fail from afar and
    converge from nearby, and doubled again where one is. If it becomes too small, the path goes to
    its top by displacements that are given; there, or if that fails, the solver is thorough.
    ``above``: an equilibrium at which a bond is overstressed. ``used``, ``used_above``: how far
    strengths are used at the end of the path and there. ``lost``: the least load at which the
    thorough solver found none.
    """

    def __init__(self, solver: Solver, path: list[Equilibrium], refinement: float) -> None:
        self.solver, self.path, self.refinement = solver, list(path), refinement
        self.increment = self.largest = refinement * INCREMENT * solver.scale
        self.thorough = self.top = False
        self.over = 0
        self.used = self.used_above = self._used(self.path[-1])
        self.above: Equilibrium | None = None
        self.lost = math.inf

    def to_its_end(self) -> tuple[list[Equilibrium], Flags]:
        """The path, and the nodes that fail at its end; `UnboundedError` if it has none."""
        path, failing = self.path, self._failing()
        while failing is None:
            if path[-1].load > MOST_LOAD * self.solver.scale:
                last = four_digits(path[-1].load)
                raise UnboundedError(f"no failure up to {last} N: the load can grow without limit")
            failing = self._failing() if self._goes_on() else np.zeros(len(path[-1].force), bool)
        return path, failing

    def _used(self, point: Equilibrium) -> Floats:
        return utilisation(self.solver.contact_law, point.state, point.force)

    def _least(self, load: float) -> float:
        return self.solver.precision * max(load, LEAST_LOAD * self.solver.scale)

    def _failing(self) -> Flags | None:
        """The nodes that fail at the end of the path; None if it goes on."""
        low, used = self.path[-1], self.used
        deep = low.closing >= DEEP * self.solver.size
        if self.solver.finite and (deep or low.rotation >= FARTHEST_TURN):
            return np.zeros(len(low.force), bool)
        if (most := used.max()) >= 1.0 - LEAST_INCREMENT:
            return np.asarray(used >= most * (1.0 - TOGETHER))
        if self.above and self.above.load - low.load <= self._least(self.above.load):
            return np.asarray(self.used_above >= 1.0)
        return None

    def _add(self, point: Equilibrium) -> bool:
        """Add ``point`` to the path; if a bond is overstressed, it is `above` that."""
        used = self._used(point)
        if used.max() > 1.0:
            self.above, self.used_above = point, used
            return False
        self.path.append(point)
        self.used = used
        return True

    def _goes_on(self) -> bool:
        """Add an equilibrium at a higher load, or shorten the increment; whether that is left."""
        low = self.path[-1]
        increment = min(self.increment, (self.lost - low.load) / 2)
        if self.thorough and increment <= self._least(low.load + increment):
            return self._steps_over()
        patience = self.largest if self.solver.drifts else 0.0
        least = max(PATIENCE * patience, self._least(low.load + increment))
        if not self.thorough and increment <= least:
            self.thorough = True
            self.top = self.solver.drifts and _to_the_top(self.solver, self.path)
            low, self.used = self.path[-1], self._used(self.path[-1])
            ends = self._failing() is not None
            again = self.top and abs(low.load - self.solver.fell) <= SAME_TOP * self.solver.fell
            if ends or again:
                return ends
            if self.top:
                increment = OVER_THE_TOP * low.load
        load = self._below_failure(low.load + increment)
        onward = not (self.thorough and self.solver.drifts)
        guess = guess_at(load, self.path, self.above) if onward else low.unknowns
        try:
            point = self.solver.solve(load, guess, low.state, thorough=self.thorough)
        except NoEquilibriumError:
            if self.top:
                self.solver.fell = low.load
                return False
            self.increment = (load - low.load) / 2
            self.lost = load if self.thorough else self.lost
            return True
        if not self._add(point):
            return True
        largest = self.refinement * max(INCREMENT * self.solver.scale, GROWTH * load)
        self.increment = min(2 * increment, largest)
        if self.top:  # pieces have come to rest elsewhere: the path goes on from there
            self.top, self.thorough, self.increment = False, False, self.largest
        return True

    def _steps_over(self) -> bool:
        """Whether there is an equilibrium a little above that at the end of the path after all."""
        low, solver = self.path[-1], self.solver
        load, self.over = (1.0 + OVER_THE_TOP) * low.load, self.over + 1
        nothing = low.load <= LEAST_LOAD * solver.scale
        if nothing or not solver.finite or solver.drifts or self.over > MOST_OVER:
            return False
        try:
            point = solver.solve(load, low.unknowns, low.state, thorough=True)
        except NoEquilibriumError:
            return False
        self.lost, self.increment = math.inf, load - low.load
        if self._add(point):
            self.thorough, self.increment = False, self.largest
        return True

    def _below_failure(self, load: float) -> float:
        """``load``, or one where the utilisation, which is almost linear, is just below 1."""
        if self.above is None:
            return load
        low, above = self.path[-1], self.above
        most, most_above = self.used.max(), self.used_above.max()
        share = (1.0 - most) / (most_above - most) if np.isfinite(most_above) else 0.5
        near = low.load + (above.load - low.load) * min(share, 0.99) * (1.0 - 1e-7)
        return min(load, max(near, low.load + self._least(above.load) / 2))


def _to_the_top(solver: Solver, path: list[Equilibrium]) -> bool:
    """Add equilibria at larger displacements to a ``path``, as far as the load rises.

    Whether it falls beyond the last one, or equilibria are not stable. Steps are halved there, and
    where none is found; the path ends where a bond is overstressed.
    """
    if len(path) < 2:
        return False
    falls, step = False, path[-1].displacement - path[-2].displacement
    for _ in range(MOST_TO_THE_TOP):
        low = path[-1]
        if low.rotation >= FARTHEST_TURN or not step > LEAST_INCREMENT * abs(low.displacement):
            break
        try:
            point = solver.at_displacement(low.displacement + step, low, low.state)
        except NoEquilibriumError:
            step /= 4
            continue
        if utilisation(solver.contact_law, point.state, point.force).max() > 1.0:
            return False
        if point.load > low.load and solver.stable(point):
            path.append(point)
            step *= 1.0 if falls else 2.0
            continue
        falls = True
        if abs(low.load - point.load) <= AT_THE_TOP * low.load:
            break
        step /= 2
    return falls


def guess_at(load: float, path: list[Equilibrium], above: Equilibrium | None) -> Floats:
    """Unknowns at ``load``, on a line through the two nearest equilibria."""
    low = path[-1]
    other = above or (path[-2] if len(path) > 1 else low)
    if other.load == low.load:
        return low.unknowns
    onward = (load - low.load) / (other.load - low.load)
    return low.unknowns + onward * (other.unknowns - low.unknowns)


def redistributed(
    solver: Solver, point: Equilibrium, failing: Flags, *, thorough: bool
) -> Equilibrium | None:
    """The equilibrium at the same load after ``failing`` nodes, and any that follow, failed.

    None if there is none.
    """
    state = point.state
    while failing.any():
        state = replace(state, whole=np.where(failing, 0.0, state.whole))
        try:
            after = solver.solve(point.load, point.unknowns, state, thorough=thorough)
        except NoEquilibriumError:
            return None
        failing = utilisation(solver.contact_law, state, after.force) > 1.0
    return after
