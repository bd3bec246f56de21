"""Static brittle model of an assembly: equilibrium of rigid pieces on springs that can fail.

The unknowns are the six displacements of every free piece. A node's force follows from the relative
displacement of its two pieces by `sidmacib.mechanics.contact_law`, so Newton's method needs
matrices of the size of the pieces, however fine the mesh. The load rises in increments, which gives friction its
history. When the first node fails, all of its strength goes at once (those that fail together go
together) and a new equilibrium is sought at the same load; where none exists is the peak.
"""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Failure, Floats, Loads
from sidmacib.mechanics.contact_law import (
    Flags,
    NodeState,
    Response,
    advanced,
    respond,
    tangent,
    utilisation,
)
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.springs import Springs

INCREMENT = 0.1  # load increment over the loads' scale
LEAST_INCREMENT = 1e-5  # over the load: where the search for a failure or for the peak ends
RESIDUAL = 1e-10  # unbalanced force over the loads, at equilibrium
NEWTON_STEPS = 60
LEAST_SHARES = 0.1, 0.01  # of a step; the first is quicker, the second more patient


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium of the joint.

    ``load``: along the direction of loading, in N. ``displacement``: of the free pieces, (6 F,), in
    m and rad. ``force``: (N, 3) in N, what the piece below each node exerts on the piece above in
    the frame of the face: normal (compression positive) and two tangents. ``state``: of the nodes.
    """

    load: float
    displacement: Floats
    force: Floats
    state: NodeState


@dataclass(frozen=True)
class StaticSolution:
    """The path of the joint to its peak.

    ``first_failure_load`` in N: where the first node fails. ``path``: the equilibria on the way;
    the last is the peak.
    """

    first_failure_load: float
    path: tuple[Equilibrium, ...]

    @property
    def peak(self) -> Equilibrium:
        """The equilibrium at the largest load."""
        return self.path[-1]

    @property
    def failed_load(self) -> float:
        """Just above the peak, where bonds fail and no equilibrium follows, in N."""
        return self.peak.load * (1.0 + LEAST_INCREMENT)


class Solver:
    """Newton's method on ``assembly`` under ``loads``."""

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        rows = free_rows(assembly)
        self.load, self.weight = loads.variable.ravel()[rows], loads.permanent.ravel()[rows]
        self.springs = Springs.of(assembly)
        self.law = self.springs.law
        self.elastic = self.springs.elastic_stiffness()
        # Keeps pieces that nothing holds for a moment from flying off.
        self.floor = 1e-10 * np.diag(np.diag(self.elastic))
        self._split(NodeState.initial(self.law).bonded)

    def start(self) -> Equilibrium:
        """Equilibrium under self-weight alone."""
        guess = np.asarray(np.linalg.solve(self.elastic, self.weight), dtype=float)
        return self.solve(0.0, guess, NodeState.initial(self.law))

    def solve(self, load: float, guess: Floats, state: NodeState) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the displacements and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method ends nowhere.
        """
        if self.bonded is not state.bonded:
            self._split(state.bonded)
        for least_share in LEAST_SHARES:
            displacement = self._newton(load, guess, state, least_share)
            if displacement is not None:
                return self._equilibrium(load, displacement, state)
        raise NoEquilibriumError(f"no equilibrium at {load:g} N")

    def _newton(
        self, load: float, guess: Floats, state: NodeState, least_share: float
    ) -> Floats | None:
        """Displacements at equilibrium, None if not found.

        Where a whole step would not bring equilibrium closer it is halved, down to ``least_share``.
        """
        target = load * self.load + self.weight
        allowed = RESIDUAL * float(np.abs(target).max())
        loose, own = self.loose, state.part(~state.bonded)

        def at(displacement: Floats) -> tuple[Floats, Response, Floats, float]:
            response = respond(loose.law, own, loose.node_displacements(displacement))
            inside = self.bonds @ displacement + loose.piece_forces(response.force)
            residual = target - inside
            return displacement, response, residual, float(np.linalg.norm(residual))

        now = at(guess)
        for _ in range(NEWTON_STEPS):
            displacement, response, residual, size = now
            if size <= allowed:
                return displacement
            stiffness = self.bonds + loose.stiffness(tangent(loose.law, response)) + self.floor
            step = np.linalg.solve(stiffness, residual)
            if not np.abs(step).max() < 1.0:
                break
            whole = now = at(displacement + step)
            share = 1.0
            while now[3] > size and share > least_share:
                share /= 2
                now = at(displacement + share * step)
            if now[3] > size:
                now = whole
        return None

    def _split(self, bonded: Flags) -> None:
        """Take bonded nodes, which are linear, together; Newton's steps look at the others only."""
        self.bonded = bonded
        self.bonds = self.springs.part(bonded).elastic_stiffness()
        self.loose = self.springs.part(~bonded)

    def _equilibrium(self, load: float, displacement: Floats, state: NodeState) -> Equilibrium:
        delta = self.springs.node_displacements(displacement)
        force = respond(self.law, state, delta).force
        return Equilibrium(load, displacement, force, advanced(self.law, state, delta, force))


def static_peak(assembly: Assembly, loads: Loads) -> StaticSolution:
    """Raise ``loads`` from 0 to the peak of ``assembly``.

    Raises `NoEquilibriumError` if it does not stand under its permanent loads, ValueError if its
    failure is not brittle.
    """
    if assembly.failure is not Failure.BRITTLE:
        raise ValueError(f"failure: got {assembly.failure}, allowed is {Failure.BRITTLE}")
    solver = Solver(assembly, loads)
    path = [solver.start()]
    first_failure: float | None = None
    while True:
        path, failing = _raised(solver, path, INCREMENT * loads.scale)
        first_failure = path[-1].load if first_failure is None else first_failure
        if not failing.any():
            break
        try:
            path.append(_redistributed(solver, path[-1], failing))
        except NoEquilibriumError:
            break
    peak = int(np.argmax([point.load for point in path]))  # bonds fail at the peak, at that load
    return StaticSolution(first_failure, tuple(path[: peak + 1]))


def _raised(
    solver: Solver, path: list[Equilibrium], largest: float
) -> tuple[list[Equilibrium], Flags]:
    """Raise the load by at most ``largest`` (N) at a time until nodes are about to fail.

    Returns the path to there and which nodes fail: none where the load cannot rise any more. Where
    no equilibrium is found the increment is halved, and doubled again where one is: Newton's method
    may fail from afar and arrive from nearby.
    """

    def used(point: Equilibrium) -> Floats:
        return utilisation(solver.law, point.state, point.force)

    path, increment = list(path), largest
    above: Equilibrium | None = None  # at a load that is too high: a bond is overstressed
    while True:
        low = path[-1]
        own = used(low)
        most = own.max()
        if most >= 1.0 - LEAST_INCREMENT:
            return path, own >= most * (1.0 - 1e-5)
        if above and above.load - low.load <= LEAST_INCREMENT * above.load:
            return path, used(above) >= 1.0
        if increment <= LEAST_INCREMENT * (low.load + increment):
            return path, np.zeros(len(low.force), bool)
        load = low.load + increment
        if above:  # where the utilisation, all but linear, comes just below 1
            over = used(above).max()
            share = (1.0 - most) / (over - most) if np.isfinite(over) else 0.5
            near = low.load + (above.load - low.load) * min(share, 0.99) * (1.0 - 1e-7)
            load = min(load, max(near, low.load + LEAST_INCREMENT * above.load / 2))
        try:
            point = solver.solve(load, _guess(load, path, above), low.state)
        except NoEquilibriumError:
            increment = (load - low.load) / 2
            continue
        if used(point).max() > 1.0:
            above = point
        else:
            path.append(point)
            increment = min(2 * increment, largest)


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
