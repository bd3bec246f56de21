"""Whether a brittle peak can be trusted: its spread under changes far below any tolerance.

The first failure moves by no more than the change itself. After it nodes fail one after the other,
and friction may leave more than one equilibrium: which one is found may depend on the last digits,
and after a long cascade the peak then jumps. So the peak is computed again on a few copies of the
assembly, with the stiffnesses and strengths of each node changed by up to 1e-9, from the first
failure on. If the peaks lie too far apart, none of them is the capacity; the first failure is.
"""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.solution import (
    LEAST_INCREMENT,
    SPREAD_LIMIT,
    Equilibrium,
    StaticSolution,
)
from sidmacib.mechanics.static.model import path_like, solver_of, static_peak

CHANGE = 1e-9  # largest relative change of a node's area, and so of its stiffness and strengths
COPIES = 8  # at most; the first jump ends the search
COPIES_ELASTIC = 3  # for elastic pieces, which take a thousand times as long
DIGITS = 4  # after the decimal point: peaks are known to 1e-5


@dataclass(frozen=True)
class StaticCapacity:
    """The path of an assembly, and the ``spread`` of its peak, see `peak_spread`."""

    solution: StaticSolution
    spread: float

    @property
    def is_peak(self) -> bool:
        """Whether the peak is the capacity; else the first failure is."""
        return self.spread <= SPREAD_LIMIT

    @property
    def path(self) -> tuple[Equilibrium, ...]:
        """The equilibria on the way; the last is the capacity."""
        path, first = self.solution.path, self.solution.first_failure_load
        if self.is_peak:
            return path
        last = next(place for place, point in enumerate(path) if point.load >= first)
        return path[: last + 1]

    @property
    def load(self) -> float:
        """The capacity along the direction of loading, in N."""
        return self.path[-1].load


def static_capacity(assembly: Assembly, loads: Loads) -> StaticCapacity:
    """Raise ``loads`` from 0 to the peak of ``assembly``, and find the spread of that peak.

    Errors as in `sidmacib.mechanics.static.model.static_peak`.
    """
    solution = static_peak(assembly, loads)
    return StaticCapacity(solution, peak_spread(assembly, loads, solution))


def peak_spread(assembly: Assembly, loads: Loads, solution: StaticSolution) -> float:
    """Range of the peaks of ``solution`` and of copies of ``assembly``, over the peak.

    The copies are changed by up to `CHANGE` at random, with fixed seeds. The spread is 0 if the
    peak is the first failure, which such changes do not move, and for bonds that are not brittle,
    where none was ever found. The search ends once the range exceeds `SPREAD_LIMIT`: the spread may
    then be larger. Rounded to `DIGITS`, so that it is the same on every processor.
    """
    peak = solution.peak.load
    if assembly.failure is not Failure.BRITTLE:
        return 0.0
    if peak <= solution.first_failure_load * (1.0 + 2.0 * LEAST_INCREMENT):
        return 0.0
    elastic = any(piece.elastic and not piece.fixed for piece in assembly.pieces)
    least = most = peak
    for seed in range(COPIES_ELASTIC if elastic else COPIES):
        other = _peak(changed(assembly, seed), loads, solution)
        least, most = min(least, other), max(most, other)
        if (most - least) / peak > SPREAD_LIMIT:
            break
    return round((most - least) / peak, DIGITS)


def changed(assembly: Assembly, seed: int) -> Assembly:
    """``assembly`` with the area of each node changed by a random fraction of at most `CHANGE`."""
    nodes = assembly.nodes
    change = CHANGE * np.random.default_rng(seed).uniform(-1.0, 1.0, len(nodes.area))
    return replace(assembly, nodes=replace(nodes, area=nodes.area * (1.0 + change)))


def _peak(assembly: Assembly, loads: Loads, solution: StaticSolution) -> float:
    """The peak in N, 0 where there is none; ``solution``: of the assembly that was changed."""
    try:
        found = path_like(solver_of(assembly, loads), loads.scale, solution)
        return found.path[found.peak].load
    except CapacityError:
        return 0.0
