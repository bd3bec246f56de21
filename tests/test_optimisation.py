"""Solvers' verdicts: taken only where they hold."""

from types import SimpleNamespace

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sidmacib.errors import InfeasibleError, SolverError, UnboundedError
from sidmacib.mechanics import optimisation
from sidmacib.mechanics.optimisation import (
    _Answer,
    _answer,
    _infeasible,
    _projected,
    _unbounded,
    solve,
)

DIMS = SimpleNamespace(zero=2, nonneg=3, soc=[3, 3, 4, 1, 3])
values = arrays(float, 2 + 3 + sum(DIMS.soc), elements=st.floats(-10, 10))


def linear(*more: cp.Constraint) -> tuple[cp.Problem, cp.Variable]:
    x = cp.Variable(2)
    return cp.Problem(cp.Maximize(x[0] + 2 * x[1]), [x >= 0, x[0] <= 3, cp.sum(x) <= 4, *more]), x


def conic() -> tuple[cp.Problem, cp.Variable]:
    x = cp.Variable(2)
    return cp.Problem(cp.Maximize(x[0] + x[1]), [cp.norm(x) <= 1.0]), x


def quadratic() -> tuple[cp.Problem, cp.Variable]:
    x = cp.Variable(2)
    return cp.Problem(cp.Minimize(cp.sum_squares(x)), [x[0] + x[1] == 2, x[0] >= 1.5]), x


@pytest.mark.parametrize(
    ("made", "expected"),
    [(linear, [0.0, 4.0]), (conic, [0.5**0.5, 0.5**0.5]), (quadratic, [1.5, 0.5])],
)
def test_an_optimum_is_found(made, expected: list[float]) -> None:
    problem, x = made()
    solve(problem, "here")
    assert x.value == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("made", [linear, conic, quadratic])
@pytest.mark.parametrize("wrong", ["x", "z"])
def test_a_wrong_optimum_is_not_believed(made, wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def off(solver: str, raw: object) -> _Answer:
        answer = _answer(solver, raw)
        moved = {"x": answer.x, "z": answer.z, wrong: getattr(answer, wrong) * (1 + 1e-6)}
        return _Answer("optimal", **moved)

    monkeypatch.setattr(optimisation, "_answer", off)
    words = r"^here: no solver's verdict passes its check \(\w+: optimal"
    with pytest.raises(SolverError, match=words):
        solve(made()[0], "here")


@pytest.mark.parametrize("cone", [False, True])
def test_a_contradiction_is_infeasible_and_an_aim_without_limit_unbounded(cone: bool) -> None:
    x = cp.Variable(2)
    smaller = cp.norm(x) <= 1 if cone else cp.sum(x) <= 1
    with pytest.raises(InfeasibleError, match=r"^here: no forces balance"):
        solve(cp.Problem(cp.Maximize(x[0]), [smaller, x >= 2]), "here")
    wider = cp.norm(x[:1]) <= x[1] if cone else x[0] <= x[1]
    with pytest.raises(UnboundedError, match=r"^here: the load can grow without limit"):
        solve(cp.Problem(cp.Maximize(x[0]), [wider, x[0] >= -1]), "here")


@pytest.mark.parametrize("verdict", ["infeasible", "unbounded"])
def test_refusals_without_proof_do_not_count(verdict: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given = _Answer(verdict, np.zeros(0), np.zeros(0))
    monkeypatch.setattr(optimisation, "_answer", lambda solver, raw: given)
    with pytest.raises(SolverError, match=f"HIGHS: {verdict}"):
        solve(linear()[0], "here")


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(
    ("b", "ray", "proves"),
    [
        ([1.0, -2.0], [1.0, 1.0], True),  # x <= 1 and x >= 2
        ([1.0, -2.0], [1.0, 1.0 + 1e-9], True),
        ([1.0, -2.0], [1.0, 1.0 + 1e-5], False),
        ([1.0, -2.0], [1.0, 2.0], False),
        ([1.0, -2.0], [-1.0, -1.0], False),
        ([1.0, 2.0], [1.0, 1.0], False),  # x <= 1 and x >= -2
        ([1.0, -2.0], [0.0, 0.0], False),
    ],
)
def test_multipliers_prove_a_contradiction_only_where_they_do(
    b: list[float], ray: list[float], proves: bool, scale: float
) -> None:
    dims = SimpleNamespace(zero=0, nonneg=2, soc=[])
    data = {"A": np.array([[1.0], [-1.0]]), "b": np.array(b), "dims": dims}
    assert _infeasible(data, scale * np.array(ray)) is proves


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(
    ("sign", "curved", "ray", "proves"),
    [
        (-1.0, 0.0, 1.0, True),  # the largest x of x >= 0
        (-1.0, 0.0, -1.0, False),
        (-1.0, 0.0, 0.0, False),
        (1.0, 0.0, 1.0, False),  # of x <= 0
        (-1.0, 1.0, 1.0, False),  # less x squared
        (-1.0, 1e-9, 1.0, True),
    ],
)
def test_a_direction_proves_that_there_is_no_limit_only_where_it_does(
    sign: float, curved: float, ray: float, proves: bool, scale: float
) -> None:
    dims = SimpleNamespace(zero=0, nonneg=1, soc=[])
    data = {"A": np.array([[sign]]), "b": np.zeros(1), "c": np.array([-1.0]), "dims": dims}
    data |= {"P": np.array([[curved]])} if curved else {}
    assert _unbounded(data, np.array([scale * ray])) is proves


def test_where_one_solver_breaks_down_the_next_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(solver: str, raw: object) -> _Answer:
        if solver == cp.HIGHS:
            return _Answer("solveerror", np.zeros(0), np.zeros(0))
        return _answer(solver, raw)

    monkeypatch.setattr(optimisation, "_answer", breaks)
    problem, x = linear()
    solve(problem, "here")
    assert x.value == pytest.approx([0.0, 4.0])


@given(values)
def test_the_projections_on_a_cone_and_its_dual_make_up_any_point(point: np.ndarray) -> None:
    """Moreau: s = P(s) - P*(-s), the two at right angles."""
    cone, dual = _projected(point, DIMS, dual=False), _projected(-point, DIMS, dual=True)
    assert cone - dual == pytest.approx(point, abs=1e-12)
    assert cone @ dual == pytest.approx(0.0, abs=1e-9)


@given(values)
def test_a_projection_lies_in_its_cone(point: np.ndarray) -> None:
    found = _projected(point, DIMS, dual=False)
    assert (found[:2] == 0.0).all()
    assert (found[2:5] >= 0.0).all()
    start = 5
    for size in DIMS.soc:
        first, *others = found[start : start + size]
        assert np.linalg.norm(others) <= first * (1 + 1e-12) + 1e-12
        start += size
