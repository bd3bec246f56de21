"""The spread of a peak: how far it moves where inputs change by one part in a thousand million."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis.report.joints import verdict_of_spread
from analysis.summary.summary import spread_lines
from analysis.tables.collect import compared_loads
from sidmacib.joint.joint import INNER, Direction, Joint, UpperBody
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Floats, Loads, NodeLayout
from sidmacib.mechanics.contact_law import NodeState
from sidmacib.mechanics.rigid.solver import RigidSolver
from sidmacib.mechanics.solution import SPREAD_LIMIT, Equilibrium
from sidmacib.mechanics.static import peak_spread as module
from sidmacib.mechanics.static.model import path_like, solver_of, static_peak
from sidmacib.mechanics.static.peak_spread import (
    StaticCapacity,
    changed,
    peak_spread,
    static_capacity,
)
from sidmacib.problem import Problem
from workflow.joints.case import Case
from workflow.results.record import CaseRecord
from workflow.solvers.static import solve, solve_once
from workflow.steps.solve import solved

NODES, FINE = NodeLayout.LOBATTO, 0.0125


def loaded(locks: int, ratio: float, mesh: float = 0.02) -> tuple[Assembly, Loads]:
    joint = Joint(locks)
    assembly = assemble(joint, mesh, NODES)
    return assembly, lateral_load(joint, assembly, Loading(Direction(ratio)))


@pytest.fixture(scope="module")
def far() -> StaticCapacity:
    """Of 13 locks at e = a on a fine mesh: a long cascade."""
    return static_capacity(*loaded(13, 1.0, FINE))


def record(locks: int, ratio: float, mesh: float = 0.02) -> CaseRecord:
    loading = Loading(Direction(ratio))
    case = Case("n", "static", "reference", "n", Joint(locks), mesh, NODES, loading, None)
    return solved(case, solve)[0]


class Recording(RigidSolver):
    """A solver that keeps what it solved: load, state before, and the equilibrium."""

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        super().__init__(assembly, loads)
        self.solved: list[tuple[float, NodeState, Equilibrium]] = []

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        found = super().solve(load, guess, state, thorough=thorough)
        self.solved.append((load, state, found))
        return found


# --- what it is ----------------------------------------------------------------------------------
def test_the_peak_spreads_as_friction_leaves_more_than_one_equilibrium(
    far: StaticCapacity,
) -> None:
    """Copies part where one of them finds another equilibrium of the same problem."""
    assembly, loads = loaded(13, 1.0, FINE)
    copies = [Recording(changed(assembly, seed), loads) for seed in range(4)]
    peaks = [path_like(copy, loads.scale, far.solution).path[-1].load for copy in copies]
    low, high = copies[int(np.argmin(peaks))], copies[int(np.argmax(peaks))]
    for (load, state, mine), (its_load, its_state, its) in zip(
        low.solved, high.solved, strict=False
    ):
        assert its_load == pytest.approx(load, rel=1e-8)
        assert np.array_equal(its_state.whole, state.whole)  # no tie in the order of failure
        apart = float(np.abs(its.force - mine.force).max() / np.abs(mine.force).max())
        if apart > 1e-3:
            break
    found = [low.solve(load, each.unknowns, state).force for each in (mine, its)]
    for force, expected in zip(found, (mine.force, its.force), strict=True):
        assert np.allclose(force, expected, rtol=0.0, atol=1e-7 * np.abs(expected).max())
    assert apart > 0.1


def test_the_peak_after_a_long_cascade_spreads_and_its_first_failure_does_not() -> None:
    assembly, loads = loaded(13, 1.0, FINE)
    whole = static_peak(assembly, loads)
    assert peak_spread(assembly, loads, whole) > 0.04
    for seed in range(3):
        first = static_peak(changed(assembly, seed), loads).first_failure_load
        assert first == pytest.approx(whole.first_failure_load, rel=1e-7)


def test_a_peak_that_newtons_method_alone_misses_is_found_and_does_not_spread() -> None:
    """Nine tall locks in one piece: another solver has 512.6 N, Newton's method alone 421 N."""
    joint = Joint(
        9,
        a=0.1119038,
        h=0.0291186,
        H=0.0236134,
        inner=replace(INNER, shear_stiffness=1.40776e10),
        dry=FaceMaterial(1.539137e9, 1.539137e9, 0.256094, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
    )
    assembly = assemble(joint, 0.04995, NODES)
    found = static_capacity(assembly, lateral_load(joint, assembly, Loading(Direction(0.3))))
    assert found.load == pytest.approx(512.6, rel=0.02)
    assert found.spread < SPREAD_LIMIT


def test_the_peak_after_a_short_cascade_does_not_spread() -> None:
    found = static_capacity(*loaded(5, 0.5))
    assert found.load > 1.05 * found.solution.first_failure_load
    assert found.spread == 0.0


def test_a_peak_that_is_the_first_failure_is_not_sought_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assembly, loads = loaded(5, 0.0)
    whole = static_peak(assembly, loads)
    monkeypatch.setattr(module, "path_like", None)
    assert peak_spread(assembly, loads, whole) == 0.0


@pytest.mark.parametrize("e_over_a", [0.3, 0.5])
def test_a_path_like_another_of_the_same_joint_is_the_rest_of_it(e_over_a: float) -> None:
    assembly, loads = loaded(5, e_over_a)
    found = static_peak(assembly, loads)
    again = path_like(solver_of(assembly, loads), loads.scale, found)
    rest = [point.load for point in found.path if point.load >= found.first_failure_load]
    assert [point.load for point in again.path] == pytest.approx(rest, rel=2e-5)
    assert found.collapsed is not None and again.collapsed is not None
    assert np.array_equal(again.collapsed, found.collapsed)
    assert again.collapsed.sum() < found.peak.state.whole.sum()


def test_copies_differ_by_the_change_and_are_the_same_each_time() -> None:
    assembly, _ = loaded(3, 0.0)
    ratio = changed(assembly, 1).nodes.area / assembly.nodes.area - 1.0
    assert 0.5 * module.CHANGE < np.abs(ratio).max() <= 1.01 * module.CHANGE
    assert np.array_equal(changed(assembly, 1).nodes.area, changed(assembly, 1).nodes.area)
    assert not np.array_equal(changed(assembly, 1).nodes.area, changed(assembly, 2).nodes.area)


# --- reported peaks ------------------------------------------------------------------------------
def test_the_capacity_is_the_first_failure_where_the_peak_spreads(far: StaticCapacity) -> None:
    assert far.spread > SPREAD_LIMIT and not far.is_peak
    assert far.load == far.solution.first_failure_load < far.solution.peak.load
    assert far.path[-1].state.bonded.sum() == far.path[0].state.bonded.sum()
    near = StaticCapacity(far.solution, SPREAD_LIMIT)
    assert near.path == far.solution.path


def test_a_record_has_the_spread_and_all_of_it_belongs_to_the_reported_load() -> None:
    found = record(13, 1.0, FINE)
    assert found.peak_spread is not None and found.peak_spread > SPREAD_LIMIT and not found.is_peak
    assert found.load_N == found.first_failure_load_N == found.path[-1][0]
    assert found.failed_load_N is not None and found.failed_load_N > 1.1 * found.load_N
    assert found.unbalanced_share is not None and found.unbalanced_share < 1e-6
    assert CaseRecord.from_json(found.to_json()) == found
    assert record(5, 0.5).peak_spread == 0.0


def test_samplings_leave_the_spread_out() -> None:
    found = solve_once(Problem(*loaded(15, 1.0)))
    assert found.peak_spread is None
    assert found.first_failure_load is not None
    assert found.path[-1].load > 1.1 * found.first_failure_load


def test_first_failures_are_held_against_each_other_where_peaks_spread() -> None:
    static = record(13, 1.0, FINE)
    other = replace(static, model="yade", load_N=200.0, first_failure_load_N=143.0)
    assert compared_loads(other, static) == (static.first_failure_load_N, 143.0)
    steady = replace(static, peak_spread=0.01)
    assert compared_loads(other, steady) == (static.load_N, 200.0)


def rows(*spreads: float) -> pd.DataFrame:
    names = [f"n{place}-mesh0.02-e1a" for place in range(len(spreads))]
    return pd.DataFrame({"case": names, "variant": "reference", "peak_spread": spreads})


def test_the_summary_names_the_capacities_that_are_first_failures() -> None:
    text = "\n".join(spread_lines(rows(0.004, 0.2, math.nan)))
    assert "1 of 2 above 2 %, the others at most 0.40 %" in text
    assert "n1-mesh0.02-e1a: peaks spread by 20.0 % or more; the capacity is the first" in text
    assert "n0-mesh" not in text
    assert not list(spread_lines(rows(math.nan)))


def test_the_report_says_whether_peaks_spread() -> None:
    (good,), (bad,) = verdict_of_spread(rows(0.004)), verdict_of_spread(rows(0.004, 0.2))
    assert (good["kind"], bad["kind"]) == ("good", "bad")
    assert "At most 0.40 %" in good["text"]
    assert "in 1 of 2 capacities" in bad["text"] and "are first failures" in bad["text"]
