"""How far a brittle peak can be trusted: its spread under changes that are far below any tolerance.

The first failure moves by no more than what is changed. Behind it nodes fail one after the other,
and which is the next may hang on the last digits: after a long cascade the peak then jumps. So the
peak is sought again on a few copies of the assembly whose nodes differ by one part in a thousand
million, in stiffness and strengths alike. Where the peaks lie too far apart, none of them is the
capacity: the first failure is.
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
from sidmacib.mechanics.static.model import static_peak

CHANGE = 1e-9  # of each node's area, so of its stiffness and strengths, at most
COPIES = 8  # at most: a jump that is found ends the search
COPIES_ELASTIC = 3  # of elastic pieces, which take a thousand times as long
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
        whole = next(place for place, point in enumerate(path) if point.load >= first)
        return path[: whole + 1]

    @property
    def load(self) -> float:
        """The capacity along the direction of loading, in N."""
        return self.path[-1].load


def static_capacity(assembly: Assembly, loads: Loads) -> StaticCapacity:
    """Raise ``loads`` from 0 to the peak of ``assembly``, and tell how far that can be trusted.

    Raises what `sidmacib.mechanics.static.model.static_peak` does.
    """
    solution = static_peak(assembly, loads)
    return StaticCapacity(solution, peak_spread(assembly, loads, solution))


def peak_spread(assembly: Assembly, loads: Loads, solution: StaticSolution) -> float:
    """Range of the peaks of ``solution`` and of copies of ``assembly``, over the peak.

    Copies differ by `CHANGE` at random, the same ones each time. None is made where the peak is the
    first failure, which no such change moves, or where bonds fade, as then none fails at once (no
    spread was found there), and no more where the range is above `SPREAD_LIMIT`:
    it may be larger than told then. Rounded to `DIGITS`, the same on every processor.
    """
    peak = solution.peak.load
    if assembly.failure is not Failure.BRITTLE:
        return 0.0
    if peak <= solution.first_failure_load * (1.0 + 2.0 * LEAST_INCREMENT):
        return 0.0
    elastic = any(piece.elastic and not piece.fixed for piece in assembly.pieces)
    least = most = peak
    for seed in range(COPIES_ELASTIC if elastic else COPIES):
        found = _peak(changed(assembly, seed), loads)
        least, most = min(least, found), max(most, found)
        if (most - least) / peak > SPREAD_LIMIT:
            break
    return round((most - least) / peak, DIGITS)


def changed(assembly: Assembly, seed: int) -> Assembly:
    """``assembly`` with the area of each node changed by `CHANGE` of it at most, at random."""
    nodes = assembly.nodes
    change = CHANGE * np.random.default_rng(seed).uniform(-1.0, 1.0, len(nodes.area))
    return replace(assembly, nodes=replace(nodes, area=nodes.area * (1.0 + change)))


def _peak(assembly: Assembly, loads: Loads) -> float:
    """The peak in N, 0 where there is none."""
    try:
        return static_peak(assembly, loads).peak.load
    except CapacityError:
        return 0.0
