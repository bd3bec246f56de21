"""Checks of an outcome: that its loads agree with each other, and that its forces balance them."""

import math

import numpy as np

from sidmacib.errors import ResultError
from sidmacib.mechanics.assembly import Loads
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.outcome import Outcome
from sidmacib.problem import Problem

MOST_UNBALANCED = 0.05  # of the load, on a piece; found up to 0.007


def checked_share(problem: Problem, outcome: Outcome) -> float | None:
    """The largest force (or moment over a length) left on a piece, over the load.

    None where the model gives no forces. `ResultError` where ``outcome`` cannot be of ``problem``.
    """
    assembly, state = outcome.cells or problem.assembly, outcome.state
    check_loads(outcome)
    if state.force is None:
        return None
    if state.force.shape != (len(assembly.nodes.area), 3):
        raise ResultError(
            f"{len(state.force)} nodes have stresses, but the case has {len(assembly.nodes.area)}"
        )
    if not np.isfinite(state.force).all():
        raise ResultError("a stress is not a finite number")
    share = unbalanced_share(assembly, problem.loads, state.load, state.force)
    check_balance(share, state.load, problem.loads)
    return share


def check_loads(outcome: Outcome) -> None:
    """Raise `ResultError` where loads of ``outcome`` contradict each other."""
    peak, failed, first = outcome.path[-1].load, outcome.failed_load, outcome.first_failure_load
    if not (math.isfinite(peak) and peak > 0.0):
        raise ResultError(f"peak load {peak:g} N is not allowed; it must be finite and above 0")
    if not (math.isfinite(failed) and failed >= peak * (1.0 - 1e-12)):
        raise ResultError(
            f"failed load {failed:g} N is not allowed; it must be finite and at least {peak:g} N"
        )
    if first is not None and not 0.0 <= first <= failed:
        raise ResultError(
            f"first failure at {first:g} N is not allowed; it must be from 0 to {failed:g} N"
        )
    for state in outcome.path:
        if not math.isfinite(state.load) or state.load > peak * (1.0 + 1e-12):
            raise ResultError(
                f"load {state.load:g} N is not allowed on the path to a peak of {peak:g} N"
            )
        if state.displacement is not None and not math.isfinite(state.displacement):
            raise ResultError(
                f"displacement {state.displacement:g} m at {state.load:g} N is not allowed; "
                "it must be finite"
            )


def check_balance(share: float, load: float, loads: Loads) -> None:
    """Raise `ResultError` where stresses do not balance the loads; ``share``: of ``load`` (N)."""
    always = float(np.linalg.norm(loads.permanent[:, :3], axis=1).sum())
    allowed = MOST_UNBALANCED * max(load, always)
    if not (math.isfinite(share) and share * load <= allowed):
        raise ResultError(
            f"stresses do not balance the loads: {share:.3g} times the load is left on a piece; it "
            f"must be {MOST_UNBALANCED:g} or less"
        )
