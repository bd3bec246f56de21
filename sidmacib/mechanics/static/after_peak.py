"""Loads that brittle bonds still carry behind the peak, if the load is let down as they fail.

Under a load that stays, a joint at its peak fails as a whole. Here the load goes down, or up, to
the one at which the next node reaches its strength, once the nodes before it have lost theirs.
Each such point is an equilibrium, reached from no load with the bonds that are left, as in
sequentially linear analysis (Rots, J.G., 2001, Heron 46(2), 69-90). The displacement may decrease
from one point to the next: a test that holds the displacement would jump over such points. Friction
has no history here.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.contact_law import Flags, NodeState
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.solution import Equilibrium, Solver
from sidmacib.mechanics.static.model import solver_of

AT_STRENGTH = 1e-2  # nodes whose utilisations differ by less fail together
PRECISION = 1e-4  # of the loads, over the peak
LEAST_LOAD_LEFT = 0.02  # of the peak: less counts as nothing
HIGHEST = 1.5  # of the peak: the bonds that are left never carry more than whole ones do


def after_peak(assembly: Assembly, loads: Loads, peak: Equilibrium) -> Iterator[Equilibrium]:
    """The points behind ``peak``, until a failure leaves less than `LEAST_LOAD_LEFT` of it.

    ``assembly``: with brittle bonds; others give nothing. ``peak``: of its path under ``loads``.
    Every point has at least one bonded node less than the one before.
    """
    if assembly.failure is not Failure.BRITTLE:
        return
    solver = solver_of(assembly, loads)
    start = solver.start()
    bonded = peak.state.bonded & ~_failing(solver, peak)
    while bonded.any():
        state = replace(start.state, whole=np.where(bonded, start.state.whole, 0.0))
        point = _next_failure(solver, start, state, peak.load)
        if point is None or point.load < LEAST_LOAD_LEFT * peak.load:
            return
        yield point
        bonded &= ~_failing(solver, point)


def _failing(solver: Solver, point: Equilibrium) -> Flags:
    """The bonded nodes that reach their strength at ``point``."""
    used = np.where(
        point.state.bonded, utilisation(solver.contact_law, point.state, point.force), 0
    )
    return np.asarray(used >= used.max() * (1.0 - AT_STRENGTH))


def _next_failure(
    solver: Solver, start: Equilibrium, state: NodeState, peak: float
) -> Equilibrium | None:
    """The equilibrium at the load at which a bond reaches its strength; None if there is none."""

    def excess(load: float) -> float:
        point = solver.solve(load, start.unknowns, state, thorough=True)
        return float(utilisation(solver.contact_law, state, point.force).max()) - 1.0

    low, high = LEAST_LOAD_LEFT * peak / 2.0, peak
    try:
        if excess(low) >= 0.0:
            return None
        while excess(high) <= 0.0:
            if high >= HIGHEST * peak:
                return None
            high *= 1.1
        load = float(brentq(excess, low, high, xtol=PRECISION * peak))
        return solver.solve(load, start.unknowns, state, thorough=True)
    except CapacityError:
        return None
