"""Mesh errors: what two meshes tell of the capacity at an ever finer one."""

from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.mesh_error import errors_of, mesh_errors
from sidmacib.joint import Direction, Joint
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import NodeLayout
from workflow.case import Case, missing_level
from workflow.results.record import CaseRecord, failed_record
from workflow.solvers.static import solve
from workflow.steps.solve import solved

SCATTER = 0.007  # of the peaks behind the first failure, from mesh to mesh
LIMIT = 100.0  # N, made-up capacity at an ever finer mesh


def made_up(mesh: float, model: str = "static", load: float = LIMIT, **names: Any) -> CaseRecord:
    case = Case(
        **{"name": f"n-mesh{mesh:g}", "variant": "reference", "sample": "n", **names},
        model=model,
        joint=Joint(3),
        mesh=mesh,
        nodes=NodeLayout.VERTICES,
        loading=Loading(Direction(0.0)),
        numerics=None,
    )
    return replace(failed_record(case, "made up"), error=None, load_N=load)


# --- of loads ------------------------------------------------------------------------------------
@given(
    slope=st.floats(-3.0, 3.0),
    meshes=st.lists(
        st.sampled_from([0.04, 0.02, 0.01, 0.005]), min_size=2, max_size=4, unique=True
    ),
)
def test_loads_of_first_order_give_back_the_true_error(slope: float, meshes: list[float]) -> None:
    loads = {mesh: LIMIT * (1.0 + slope * mesh) for mesh in meshes}
    finest = loads[min(loads)]
    expected = {mesh: abs(load - LIMIT) / finest for mesh, load in loads.items()}
    assert mesh_errors(loads) == pytest.approx(expected, abs=2e-9)


@given(slope=st.floats(-30.0, 30.0), order=st.floats(1.0, 4.0))
def test_the_error_of_loads_that_converge_faster_is_on_the_safe_side(
    slope: float, order: float
) -> None:
    loads = {mesh: LIMIT * (1.0 + slope * mesh**order) for mesh in (0.02, 0.01, 0.005)}
    for mesh, error in mesh_errors(loads).items():
        assert error >= abs(loads[mesh] - LIMIT) / loads[0.005] - 2e-9


def test_one_mesh_or_close_ones_tell_nothing() -> None:
    assert mesh_errors({0.02: 1.0}) == {}
    assert mesh_errors({0.02: 1.0, 0.018: 1.0}) == {}
    assert missing_level([0.02, 0.018]) == 0.009
    assert missing_level([0.02, 0.01]) is None


def test_loads_that_are_the_same_have_no_error() -> None:
    assert mesh_errors({0.02: 240.0, 0.005: 240.0}) == {0.02: 0.0, 0.005: 0.0}


# --- of cases ------------------------------------------------------------------------------------
def test_a_model_at_one_mesh_takes_the_error_of_the_static_model_on_the_same_nodes() -> None:
    records = [
        *(made_up(0.02, load=101.0), made_up(0.01, load=100.0)),
        made_up(0.02, "limit", 120.0),
        made_up(0.02, "yade", 100.5, name="soft", variant="soft"),
    ]
    found = errors_of(records)
    assert found["static", "n-mesh0.02"] == pytest.approx(0.02)
    assert found["yade", "soft"] == found["limit", "n-mesh0.02"] == found["static", "n-mesh0.02"]


def test_a_model_at_two_meshes_has_its_own_error() -> None:
    loads = {("static", 0.02): 100.0, ("static", 0.01): 100.0, ("yade", 0.02): 102.0}
    records = [made_up(mesh, model, load) for (model, mesh), load in loads.items()]
    found = errors_of([*records, made_up(0.01, "yade", 100.0)])
    assert found["yade", "n-mesh0.02"] == pytest.approx(0.04)
    assert found["static", "n-mesh0.02"] == 0.0


def test_the_error_of_another_joint_is_not_taken() -> None:
    records = [made_up(0.02), made_up(0.01)]
    other = replace(made_up(0.02, "yade"), series="other")
    assert ("yade", "n-mesh0.02") not in errors_of([*records, other])


def test_a_case_without_a_result_has_no_error_and_gives_none() -> None:
    failed = replace(made_up(0.01), load_N=None, error="no")
    assert errors_of([made_up(0.02), failed]) == {}


# --- of the static model -------------------------------------------------------------------------
@cache
def static_peak_of(locks: int, ratio: float, mesh: float, layout: NodeLayout) -> float:
    """In N."""
    loading = Loading(Direction(ratio))
    case = Case("n", "static", "reference", "n", Joint(locks), mesh, layout, loading, None)
    found = solved(case, solve)[0].load_N
    assert found is not None
    return found


@pytest.mark.parametrize("nodes", NodeLayout)
def test_errors_told_of_the_static_model_bound_its_true_ones_most_of_the_time(
    nodes: NodeLayout,
) -> None:
    held = []
    for locks, ratio in product((3, 5), (0.0, 0.1, 0.5, np.inf)):
        exact = static_peak_of(locks, ratio, 0.0025, NodeLayout.LOBATTO)
        loads = {mesh: static_peak_of(locks, ratio, mesh, nodes) for mesh in (0.02, 0.005)}
        held += [
            abs(loads[mesh] - exact) / loads[0.005] <= error + SCATTER
            for mesh, error in mesh_errors(loads).items()
        ]
    assert sum(held) >= 0.9 * len(held)
