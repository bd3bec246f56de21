"""The checked result of a case, in the same form for all models.

Engines, models solved in this process and programs run elsewhere all give an `Outcome`.
`record_of` checks it against its case and turns it into a `CaseRecord`; nothing else reaches a
table.
"""

import dataclasses
import json
import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from sidmacib.joint.weights import LockWeight, lock_weights
from sidmacib.mechanics.assembly import Loads
from sidmacib.mechanics.equilibrium import unbalanced_share
from sidmacib.mesh_error import cells_of
from sidmacib.outcome import Outcome
from sidmacib.problem import Problem
from workflow.joints.case import Case, CaseId

DIGITS = 10  # significant digits that are kept; the rest is rounding noise
MOST_UNBALANCED = 0.05  # of the load, on a piece; found up to 0.007
LEAST_OF_FIRST_FAILURE = 0.8  # peak of an engine over the first failure of the static model
SLACK = 1e-6  # of a tolerance: rounding
NOISE = 1e-9  # of a weight or a share: less counts as 0


class ResultError(ValueError):
    """A result that is not accepted; the message is one line."""


@dataclass(frozen=True)
class CaseRecord:
    """The result of a case.

    Loads are along the case's direction, in N: ``load_N`` the one that counts, ``peak_N`` the
    largest at equilibrium, ``failed_load_N`` the smallest known not to be carried,
    ``first_failure_load_N`` where the first node fails. ``mode``: how the joint gives way.
    ``peak_spread``: of the static model's peaks, the lowest of which is ``peak_N``.
    ``unbalanced_share``: largest force (or moment over a) left on a piece, over the load. ``path``:
    loads (N) and displacements (m, the one that the load does work on). What a model does not give
    is None or empty. ``error``: why there is no result, in one line; all numbers are None then.
    """

    model: str
    variant: str
    sample: str
    case: str  # identity apart from model and variant; tables join on it
    name: str
    locks: int
    mesh_m: float
    cells: float  # along a side of the locks' horizontal faces, see `sidmacib.mesh_error`
    nodes: str
    eccentricity_over_a: float
    eccentricity_m: float
    case_digest: str
    physics: str  # digest of joint, nodes and loads: the same for all models of a case
    series: str  # digest of the same but for the mesh
    load_N: float | None = None
    peak_N: float | None = None
    shear_N: float | None = None
    torque_Nm: float | None = None
    failed_load_N: float | None = None
    first_failure_load_N: float | None = None
    mode: str | None = None
    peak_spread: float | None = None
    unbalanced_share: float | None = None
    weights: tuple[LockWeight, ...] = ()
    path: tuple[tuple[float, float | None], ...] = ()
    versions: dict[str, str] = dataclasses.field(default_factory=dict)
    error: str | None = None

    @property
    def id(self) -> CaseId:
        """The identity of the case."""
        return CaseId(self.model, self.name)

    def to_json(self) -> str:
        """One line of JSON; infinity is written as Python's json does."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> "CaseRecord":
        """The record that `to_json` wrote; `ResultError` if ``text`` is anything else."""
        try:
            data = json.loads(text)
            data["weights"] = tuple(LockWeight(**each) for each in data["weights"])
            data["path"] = tuple((load, moved) for load, moved in data["path"])
            return cls(**data)
        except (ValueError, TypeError, KeyError, RecursionError) as error:
            raise ResultError(f"not a case's record: {error}") from None


def failed_record(case: Case, error: str) -> CaseRecord:
    """The record of a case that ended without a result, for the reason ``error``."""
    return CaseRecord(**_identity(case), error=" ".join(error.split()))


def record_of(
    case: Case, problem: Problem, outcome: Outcome, versions: dict[str, str]
) -> CaseRecord:
    """The record of ``outcome``; raises `ResultError` where it cannot be the result of ``case``."""
    assembly, loads = problem
    peak = outcome.path[-1]
    check_loads(outcome)
    weights: tuple[LockWeight, ...] = ()
    balance = None
    if peak.force is not None:
        if peak.force.shape != (len(assembly.nodes.area), 3):
            raise ResultError(
                f"{len(peak.force)} nodes have stresses, but the case has "
                f"{len(assembly.nodes.area)}"
            )
        if not np.isfinite(peak.force).all():
            raise ResultError("a stress is not a finite number")
        balance = unbalanced_share(assembly, loads, peak.load, peak.force)
        check_balance(balance, peak.load, loads)
        balance = _clean(balance, 1e-12)
        weights = tuple(
            _rounded_weight(each, case.joint.T0)
            for each in lock_weights(case.joint, assembly, peak.force)
        )
    load = rounded(peak.load)
    first = outcome.first_failure_load
    return CaseRecord(
        **_identity(case),
        load_N=load,
        peak_N=None if outcome.peak_load is None else rounded(outcome.peak_load),
        shear_N=rounded(peak.load * case.direction.shear),
        torque_Nm=rounded(peak.load * case.direction.torque * case.joint.a),
        failed_load_N=rounded(outcome.failed_load),
        first_failure_load_N=None if first is None else rounded(first),
        mode=outcome.mode,
        peak_spread=outcome.peak_spread,
        unbalanced_share=balance,
        weights=weights,
        path=tuple(
            (rounded(s.load), None if s.displacement is None else rounded(s.displacement))
            for s in outcome.path
        ),
        versions=versions,
    )


def check_bracket(outcome: Outcome, tolerance: float, least: float) -> None:
    """Raise `ResultError` where the failed load is further above the peak than ``tolerance``.

    ``least``: load (N) that the tolerance refers to where the peak is smaller.
    """
    peak, failed = outcome.path[-1].load, outcome.failed_load
    allowed = tolerance * max(peak, least)
    if not failed - peak <= allowed * (1.0 + SLACK):
        raise ResultError(
            f"failed load {failed:g} N is not allowed; it must be at most {allowed:g} N, the "
            f"tolerance, above the peak of {peak:g} N"
        )


def check_first_failure(outcome: Outcome, expected: float) -> None:
    """Raise `ResultError` where the peak is far below the load at which a node should fail first.

    ``expected``: that load in the static model, in N. First failures agree within 1 % where both
    models see the same, so an engine that gives way at much less has seen something else.
    """
    peak = outcome.path[-1].load
    if peak < LEAST_OF_FIRST_FAILURE * expected:
        raise ResultError(
            f"peak of {peak:g} N contradicts the static model, in which nothing fails up to "
            f"{expected:g} N; it must be at least {LEAST_OF_FIRST_FAILURE:g} of that"
        )


def _identity(case: Case) -> dict[str, Any]:
    return {
        "model": case.model,
        "variant": case.variant,
        "sample": case.sample,
        "case": case.key,
        "name": case.name,
        "locks": case.joint.locks,
        "mesh_m": case.mesh,
        "cells": rounded(cells_of(case.joint, case.mesh)),
        "nodes": str(case.nodes),
        "eccentricity_over_a": case.direction.eccentricity,
        "eccentricity_m": case.eccentricity_m,
        "case_digest": case.digest(),
        "physics": case.physics(),
        "series": case.series(),
    }


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


def _rounded_weight(each: LockWeight, strength: float) -> LockWeight:
    return dataclasses.replace(
        each,
        weight=_clean(each.weight),
        mean_shear_ratio=_clean(each.mean_shear_ratio),
        max_shear_ratio=_clean(each.max_shear_ratio),
        shear_x_N=_clean(each.shear_x_N, NOISE * strength),
        shear_y_N=_clean(each.shear_y_N, NOISE * strength),
    )


def _clean(value: float, noise: float = NOISE) -> float:
    """``value`` in multiples of ``noise``: the same on every machine."""
    return rounded(round(value / noise) * noise)


def rounded(value: float) -> float:
    """``value`` to `DIGITS` significant digits; never -0."""
    return float(f"{value:.{DIGITS}g}") + 0.0
