"""Mesh errors: what two meshes tell of the capacity at an ever finer one."""

import math
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from joints import sawn

from analysis.tables.collect import errors_of
from sidmacib import Elastic, FaceMaterial, NodeLayout, lowest_peak, static_peak
from sidmacib.answers.joint import joint_answer, joint_mesh_error
from sidmacib.joint import INNER, Direction, HoldDown, Joint, UpperBody
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.solution import Mode
from sidmacib.mesh_error import LoadKind, cells_of, kind_of, mesh_errors
from sidmacib.problem import MeshErrors
from workflow.case import Case, JointSubject
from workflow.cases import second_mesh
from workflow.results import record_without_result
from workflow.results.joint_part import JointRecord

LIMIT = 100.0  # N, made-up capacity at an ever finer mesh


def made_up(mesh: float, model: str = "static", load: float = LIMIT, **names: Any) -> JointRecord:
    subject = JointSubject("n", sawn(3), mesh, NodeLayout.VERTICES, Loading(Direction(0.0)))
    known = {"name": f"n-mesh{mesh:g}", "variant": "reference", **names}
    case = Case(**known, model=model, subject=subject, numerics=None)
    return replace(record_without_result(case, error="made up"), error=None, load_N=load)


# --- of loads ------------------------------------------------------------------------------------
LAYOUTS, KINDS = st.sampled_from(NodeLayout), st.sampled_from(LoadKind)


@given(slope=st.floats(-1.0, 1.0), order=st.floats(1.0, 4.0), layout=LAYOUTS, kind=KINDS)
def test_the_error_of_loads_that_converge_faster_is_on_the_safe_side(
    slope: float, order: float, layout: NodeLayout, kind: LoadKind
) -> None:
    loads = {cells: LIMIT * (1.0 + slope * cells**-order) for cells in (3.0, 6.0, 12.0)}
    for cells, error in mesh_errors(loads, layout, kind).items():
        assert error >= abs(loads[cells] - LIMIT) / loads[12.0] - 2e-9


def test_one_mesh_or_close_ones_tell_nothing() -> None:
    estimates = partial(mesh_errors, layout=NodeLayout.LOBATTO, kind=LoadKind.PEAK)
    assert estimates({3.0: 1.0}) == {}
    assert estimates({3.0: 1.0, 4.0: 1.0}) == {}
    assert set(estimates({3.0: 1.0, 5.0: 1.0})) == {3.0, 5.0}


def test_the_error_goes_by_the_cells_that_there_are_not_by_the_mesh_asked_for() -> None:
    assert cells_of(sawn(3), 0.04) == 2.0  # both sides, 0.06 and 0.05 m
    assert cells_of(sawn(3), 0.02) == 3.0  # not twice as many
    assert cells_of(sawn(3, a=0.04, b=0.05), 0.0125) == pytest.approx(4.0)


def test_a_peak_counts_as_late_where_it_is_behind_the_first_failure_on_one_mesh() -> None:
    assert kind_of([(100.1, 100.0), (101.0, 100.9)]) is LoadKind.PEAK
    assert kind_of([(100.0, 100.0), (101.0, 100.0)]) is LoadKind.LATE_PEAK
    assert kind_of([(100.0, None)]) is LoadKind.PEAK
    assert kind_of([(100.0, 100.0)], moves=True) is LoadKind.LATE_PEAK


# --- the second mesh -----------------------------------------------------------------------------
def test_the_second_mesh_is_the_finer_one_of_rigid_pieces() -> None:
    assert second_mesh(sawn(3), [0.02, 0.018], NodeLayout.LOBATTO) == 0.009
    assert second_mesh(sawn(3), [0.02, 0.01], NodeLayout.LOBATTO) is None


@pytest.mark.parametrize("nodes", NodeLayout)
def test_the_second_mesh_is_coarser_where_the_finer_is_ten_times_as_dear(nodes: NodeLayout) -> None:
    bends = sawn(5, elastic=Elastic(1e10))
    assert second_mesh(bends, [0.01], nodes) == 0.02
    assert second_mesh(replace(bends, elastic=None), [0.01], nodes) == 0.005


# --- of cases ------------------------------------------------------------------------------------
def test_a_model_at_one_mesh_takes_the_error_of_the_static_model_on_the_same_nodes() -> None:
    soft = made_up(0.02, "yade", 100.5, name="soft", variant="soft")
    static = (made_up(0.02, load=101.0), made_up(0.01, load=100.0))
    found = errors_of([*static, made_up(0.02, "limit", 120.0), soft])
    cells = math.sqrt(30.0)  # at 0.01 m; 3 at 0.02 m
    expected = 0.01 + 0.01 / (cells / 3.0 - 1.0) + 0.02 / cells
    assert found["cases/static/n-mesh0.02"] == MeshErrors(None, pytest.approx(expected))
    assert (
        found["cases/yade/soft"]
        == found["cases/limit/n-mesh0.02"]
        == found["cases/static/n-mesh0.02"]
    )


def test_a_first_failure_has_an_error_of_its_own() -> None:
    records = [
        replace(made_up(0.02, load=110.0), first_failure_load_N=101.0),
        replace(made_up(0.01, load=100.0), first_failure_load_N=100.0),
    ]
    found = errors_of(records)["cases/static/n-mesh0.02"]
    assert 0.01 < found.first < 0.03
    assert found.peak > 0.1


# --- of the static model -------------------------------------------------------------------------
def random_joint(rng: np.random.Generator) -> tuple[Joint, Direction]:
    """Any sizes, stiffnesses, friction and direction; ratios are spread in their logarithm."""

    def ratio(least: float, most: float) -> float:
        return float(np.exp(rng.uniform(np.log(least), np.log(most))))

    dry = 1e10 * ratio(0.2, 5.0)
    joint = sawn(
        int(rng.integers(3, 8)),
        a=0.05 * ratio(0.6, 2.5),
        h=0.05 * ratio(0.08, 0.6),
        H=0.05 * ratio(0.3, 1.5),
        inner=replace(INNER, shear_stiffness=1e10 * ratio(0.1, 1.5)),
        dry=FaceMaterial(dry, dry, ratio(0.02, 0.6), 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC if rng.uniform() < 0.4 else UpperBody.COLUMNS,
    )
    return joint, Direction([0.0, ratio(0.05, 1.5), ratio(0.05, 1.5), np.inf][rng.integers(4)])


@cache
def random_joints() -> tuple[tuple[Joint, Direction, tuple[float, float]], ...]:
    """Joints that no rule was made from, with first failure and peak (N) on a much finer mesh."""
    rng = np.random.default_rng(2024)
    drawn = [random_joint(rng) for _ in range(24)]
    return tuple((*one, loads_of(*one, 8, NodeLayout.LOBATTO)) for one in drawn)


def loads_of(
    joint: Joint, direction: Direction, parts: int, nodes: NodeLayout
) -> tuple[float, float]:
    """First failure and peak (N) on a mesh of the shorter side of a lock over ``parts``."""
    mesh = 0.999 * joint.least_side / parts
    found = static_peak(*posed(joint, Loading(direction), mesh, nodes))
    return found.first_failure_load, found.peak.load


SLOW = [pytest.param(n, marks=pytest.mark.study) for n in (NodeLayout.CENTRES, NodeLayout.VERTICES)]


@pytest.mark.long
@pytest.mark.parametrize("nodes", [NodeLayout.LOBATTO, *SLOW])
def test_mesh_errors_of_random_joints_are_upper_estimates(nodes: NodeLayout) -> None:
    missed = {"first failure": 0, "peak": 0}
    for joint, direction, (exact_first, exact_peak) in random_joints():
        coarse, fine = (loads_of(joint, direction, parts, nodes) for parts in (2, 4))
        cells = [cells_of(joint, 0.999 * joint.least_side / parts) for parts in (2, 4)]
        kind = kind_of([coarse[::-1], fine[::-1]])
        first = mesh_errors({cells[0]: coarse[0], cells[1]: fine[0]}, nodes, LoadKind.FIRST_FAILURE)
        peak = mesh_errors({cells[0]: coarse[1], cells[1]: fine[1]}, nodes, kind)
        missed["first failure"] += abs(fine[0] / exact_first - 1.0) > first[cells[1]]
        missed["peak"] += abs(fine[1] / exact_peak - 1.0) > peak[cells[1]]
    assert max(missed.values()) <= 0.05 * len(random_joints()), missed


def test_two_meshes_that_agree_by_chance_do_not_hide_where_a_joint_moves_away() -> None:
    """Stone whose friction moves on finer meshes as it does not on two coarse ones."""
    inner, dry = FaceMaterial(9e11, 4.5e11, 0.6, 2.2e6, 2.2e6), FaceMaterial(9e10, 9e10, 0.6, 0, 0)
    stone = {"density": 2500.0, "hold_down": HoldDown.force(5000.0), "inner": inner, "dry": dry}
    joint, loading = Joint(2, 0.155, 0.214, 0.0504, 0.115, **stone), Loading(Direction(2.0))
    found, error = joint_answer(joint, loading), joint_mesh_error(joint, loading)
    assert found.solution.mode is Mode.MECHANISM
    finest = lowest_peak(*posed(joint, loading, joint.least_side / 12.01)).peak.load
    assert error is not None
    assert 0.02 < abs(finest / found.load - 1.0) <= error < 0.2
