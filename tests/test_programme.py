"""SiDMACIB as a linear programme."""

import math
from dataclasses import replace

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.contact_points import OPTIONS, ContactOption, contact_points
from sidmacib.joint import Direction, Joint
from sidmacib.programme import (
    InfeasibleError,
    Sidmacib,
    SolverError,
    UnboundedError,
    _programme,
    capacities,
    capacity,
    solve,
)

PURE_SHEAR = Direction(1.0, 0.0)


@pytest.mark.parametrize(("locks", "published"), [(3, 720.0), (5, 1200.0)])
@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("friction", [False, True])
def test_pure_shear_is_the_published_one(
    locks: int, published: float, option: str, friction: bool
) -> None:
    model = Sidmacib(Joint(locks), OPTIONS[option], friction=friction)
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(published, rel=1e-9)


@settings(max_examples=20)
@given(
    st.integers(2, 7),
    st.floats(0.05, 0.5),
    st.one_of(st.floats(0.0, 1.0), st.just(math.inf)),
)
def test_without_friction_torque_falls_linearly_with_shear(
    locks: int, distance: float, eccentricity: float
) -> None:
    joint = Joint(locks)
    model = Sidmacib(joint, ContactOption.pair(distance), friction=False)
    point = capacity(model, Direction.at_eccentricity(eccentricity, joint.a))
    expected = distance * joint.a * (locks * joint.T0 - point.shear)
    assert point.torque == pytest.approx(expected, abs=1e-6 * joint.T0 * joint.a)


def test_option_1_has_the_highest_and_option_4_the_lowest_pure_torsion(joint: Joint) -> None:
    torsion = Direction.at_eccentricity(math.inf, joint.a)
    found = [capacity(Sidmacib(joint, option), torsion).torque for option in OPTIONS.values()]
    assert found == sorted(found, reverse=True)
    assert found[0] > found[-1]


def raised_step_by_step(model: Sidmacib, direction: Direction, step: float) -> float:
    """The paper's procedure: raise the load until no forces balance it."""
    programme = _programme(model)
    load = cp.Parameter()
    problem = cp.Problem(
        cp.Minimize(0),
        [
            *programme.constraints,
            programme.shear == direction.shear * load,
            programme.torque == direction.torque * load,
        ],
    )
    count = 0
    while True:
        load.value = (count + 1) * step
        try:
            solve(problem, "step")
        except InfeasibleError:
            return count * step
        count += 1


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("eccentricity", [0.0, 0.03, math.inf])
def test_raising_the_load_step_by_step_ends_at_the_same_load(
    joint: Joint, friction: bool, eccentricity: float
) -> None:
    direction = Direction.at_eccentricity(eccentricity, joint.a)
    model = Sidmacib(joint, OPTIONS["option4"], friction=friction)
    step = 2.0
    reached = raised_step_by_step(model, direction, step)
    assert reached <= capacity(model, direction).load + 1e-6
    assert reached > capacity(model, direction).load - step - 1e-6


def test_forces_at_the_peak_balance_the_upper_block_and_keep_their_bounds(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option2"])
    point = capacity(model, Direction.at_eccentricity(0.02, joint.a))
    along, across, normal = point.forces.T
    positions = contact_points(joint, model.option).position
    assert across.sum() == pytest.approx(-point.shear)
    assert along.sum() == pytest.approx(0.0, abs=1e-6)
    torque = positions[:, 0] @ across - positions[:, 1] @ along
    assert torque == pytest.approx(-point.torque)
    assert (np.abs(along) <= joint.dry.friction * normal + 1e-6).all()
    assert (np.abs(across) <= joint.T0 / 2 + 1e-6).all()


@settings(max_examples=15)
@given(st.floats(0.1, 10.0), st.floats(0.0, 0.5))
def test_scaling_strength_and_weights_scales_the_load(factor: float, eccentricity: float) -> None:
    joint = Joint(locks=3)
    stronger = replace(
        joint,
        density=factor * joint.density,
        inner=replace(joint.inner, cohesion=factor * joint.inner.cohesion),
    )
    direction = Direction.at_eccentricity(eccentricity, joint.a)
    one = capacity(Sidmacib(joint, OPTIONS["option3"]), direction)
    other = capacity(Sidmacib(stronger, OPTIONS["option3"], overload=factor * 1000.0), direction)
    assert other.load == pytest.approx(factor * one.load, rel=1e-6)


def test_the_mirrored_torque_is_carried_alike(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option1"])
    one, other = capacities(model, [Direction(0.8, 0.02), Direction(0.8, -0.02)])
    assert one.load == pytest.approx(other.load)


def test_more_strength_never_carries_less(joint: Joint) -> None:
    direction = Direction.at_eccentricity(0.03, joint.a)
    loads = [
        capacity(Sidmacib(joint, OPTIONS["option2"], (0.2, w, 0.4)), direction).load
        for w in (0.0, 0.3, 0.6, 1.0)
    ]
    assert loads == sorted(loads)


def test_three_points_with_unequal_portions_are_possible(joint: Joint) -> None:
    option = ContactOption((-0.4, 0.0, 0.4), (0.25, 0.5, 0.25))
    model = Sidmacib(joint, option, friction=False)
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(720.0)
    torsion = capacity(model, Direction(0.0, joint.a))
    assert torsion.torque == pytest.approx(3 * joint.T0 * 2 * 0.25 * 0.4 * joint.a)


def test_a_lock_that_does_not_count_keeps_its_normal_force(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option4"], strength=(0.0, 1.0, 0.0))
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(joint.T0)


def test_an_upward_overload_is_infeasible_and_the_error_names_the_direction(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option1"], overload=-2000.0)
    with pytest.raises(InfeasibleError, match=r"V : M = 1 : 0 m"):
        capacity(model, PURE_SHEAR)


def test_a_load_of_nothing_is_unbounded_and_the_error_names_the_direction(joint: Joint) -> None:
    with pytest.raises(UnboundedError, match=r"V : M = 0 : 0 m"):
        capacity(Sidmacib(joint, OPTIONS["option1"]), Direction(0.0, 0.0))


def test_any_other_status_of_the_solver_is_an_error() -> None:
    x = cp.Variable()
    problem = cp.Problem(cp.Maximize(x), [x <= 1])
    problem.solve(solver=cp.HIGHS)
    problem._status = "user_limit"
    problem.solve = lambda **_: None
    with pytest.raises(SolverError, match="somewhere: solver status user_limit"):
        solve(problem, "somewhere")


def test_a_strength_for_the_wrong_number_of_locks_is_refused(joint: Joint) -> None:
    with pytest.raises(ValueError, match=r"strength: got .* each of 3 locks"):
        Sidmacib(joint, OPTIONS["option1"], strength=(1.0, 1.0))


@pytest.mark.parametrize(
    ("positions", "portions", "message"),
    [
        ((0.1,), (0.4, 0.6), "positions: got 1"),
        ((-0.6, 0.6), (0.5, 0.5), "positions: got"),
        ((-0.1, 0.1), (0.5, 0.4), "portions: got"),
    ],
)
def test_impossible_contact_points_are_refused(
    positions: tuple[float, ...], portions: tuple[float, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        ContactOption(positions, portions)
