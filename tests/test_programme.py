"""SiDMACIB as a linear programme."""

import math
from dataclasses import replace
from itertools import count as count_from

import cvxpy as cp
import numpy as np
import pytest
from conftest import scaled
from hypothesis import given, settings
from hypothesis import strategies as st

import sidmacib.contact_points.programme as programme_module
from sidmacib import Direction, InfeasibleError, Joint
from sidmacib.contact_points import OPTIONS, READY_OPTIONS, ContactOption, contact_points
from sidmacib.contact_points.programme import Sidmacib, capacities, capacity, programme
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.mechanics.optimisation import solve

PURE_SHEAR, TORSION = Direction(0.0), Direction(math.inf)


@pytest.mark.parametrize(("locks", "published"), [(3, 720.0), (5, 1200.0)])
@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("friction", [False, True])
def test_pure_shear_is_published(locks: int, published: float, option: str, friction: bool) -> None:
    model = Sidmacib(Joint(locks), OPTIONS[option], friction=friction)
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(published, rel=1e-9)


@settings(max_examples=20)
@given(
    st.integers(2, 7),
    st.floats(0.05, 0.5),
    st.one_of(st.floats(0.0, 1.0), st.just(math.inf)),
)
def test_torque_falls_linearly_with_shear(locks: int, distance: float, eccentricity: float) -> None:
    joint = Joint(locks)
    model = Sidmacib(joint, ContactOption.pair(distance), friction=False)
    point = capacity(model, Direction(eccentricity))
    expected = distance * joint.a * (locks * joint.T0 - point.shear)
    assert point.torque == pytest.approx(expected, abs=1e-6 * joint.T0 * joint.a)


def raised_step_by_step(model: Sidmacib, direction: Direction, step: float) -> float:
    """The paper's procedure: raise the load until no forces balance it."""
    admissible = programme(model)
    load = cp.Parameter()
    each = np.array([direction.shear, direction.torque * model.joint.a]) / admissible.units.plane
    carried = [*admissible.constraints, admissible.loads == each * load]
    problem = cp.Problem(cp.Minimize(0), carried)
    for count in count_from(1):
        load.value = count * step
        try:
            solve(problem, "step")
        except InfeasibleError:
            break
    return (count - 1) * step


def test_a_programme_is_made_once_for_a_joint(
    joint: Joint, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = Sidmacib(joint, ContactOption.pair(0.123), overload=777.0)
    directions = [Direction(e) for e in (0.0, 0.3, -2.0)]
    made = []
    monkeypatch.setattr(
        programme_module, "programme", lambda asked: made.append(asked) or programme(asked)
    )
    singly = [capacity(model, direction) for direction in directions]
    assert made == [model]
    for one, other in zip(singly, capacities(model, directions), strict=True):
        assert one.load == other.load
        assert (one.forces == other.forces).all()


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("eccentricity", [0.0, 0.5])
def test_steps_end_at_the_same_load(joint: Joint, friction: bool, eccentricity: float) -> None:
    direction = Direction(eccentricity)
    model = Sidmacib(joint, OPTIONS["option4"], friction=friction)
    step = 2.0
    reached = raised_step_by_step(model, direction, step)
    assert reached <= capacity(model, direction).load + 1e-6
    assert reached > capacity(model, direction).load - step - 1e-6


def test_forces_at_the_peak_balance_the_upper_block_and_keep_their_bounds(joint: Joint) -> None:
    model = Sidmacib(joint, OPTIONS["option2"])
    point = capacity(model, Direction(1 / 3))
    along, across, normal = point.forces.T
    positions = contact_points(joint, model.option)
    assert across.sum() == pytest.approx(-point.shear)
    assert along.sum() == pytest.approx(0.0, abs=1e-6)
    torque = positions[:, 0] @ across - positions[:, 1] @ along
    assert torque == pytest.approx(-point.torque)
    assert normal.sum() == pytest.approx(1000.0 + upper_block_weight(joint))
    assert (np.abs(along) <= joint.dry.friction * normal + 1e-6).all()
    assert (np.abs(across) <= joint.T0 / 2 + 1e-6).all()


@settings(max_examples=15)
@given(
    st.floats(-6, 6).map(lambda power: 10**power),
    st.floats(-6, 6).map(lambda power: 10**power),
    st.one_of(st.floats(0.0, 5.0), st.just(math.inf)),
    st.integers(2, 7),
)
def test_the_load_scales_with_lengths_and_stresses_over_twelve_orders_of_magnitude(
    length: float, stress: float, eccentricity: float, locks: int
) -> None:
    joint, direction, factor = Joint(locks), Direction(eccentricity), stress * length**2
    one = capacity(Sidmacib(joint, OPTIONS["option3"]), direction)
    larger, overload = scaled(joint, length, stress), factor * Sidmacib.overload
    model = Sidmacib(larger, OPTIONS["option3"], overload=overload)
    other = capacity(model, direction)
    assert other.load == pytest.approx(factor * one.load, rel=1e-9)
    assert other.torque == pytest.approx(factor * length * one.torque, rel=1e-9)


@pytest.mark.parametrize("power", [-6, -1, 1, 6])
@pytest.mark.parametrize("friction", [False, True])
def test_strength_far_from_what_presses_gives_the_load_by_hand(power: int, friction: bool) -> None:
    """Rocking about the last lock, or the locks' strength, decides pure shear."""
    joint = Joint(3)
    joint = replace(joint, inner=replace(joint.inner, cohesion=10.0**power * 8e4))
    model = Sidmacib(joint, OPTIONS["option4"], friction=friction)
    upper_locks, body = 2 * joint.h, 3 * joint.H  # volumes over a b
    centre = (upper_locks * joint.h / 2 + body * (joint.h + joint.H / 2)) / (upper_locks + body)
    pressure = 1000.0 + upper_block_weight(joint)
    rocking = pressure * joint.b / (centre - joint.h / 2)
    expected = min(3 * joint.T0, rocking)
    assert capacity(model, PURE_SHEAR).load == pytest.approx(expected, rel=1e-8)
    if not friction:
        torque = 3 * joint.T0 * joint.a / 4
        assert capacity(model, TORSION).torque == pytest.approx(torque, rel=1e-8)


def upper_block_weight(joint: Joint) -> float:
    """Self-weight in N, by hand."""
    volume = joint.a * joint.b * (joint.locks * joint.H + (joint.locks + 1) // 2 * joint.h)
    return joint.density * GRAVITY * volume


def test_three_points_with_unequal_portions_are_possible(joint: Joint) -> None:
    option = ContactOption((-0.4, 0.0, 0.4), (0.25, 0.5, 0.25))
    model = Sidmacib(joint, option, friction=False)
    assert capacity(model, PURE_SHEAR).shear == pytest.approx(720.0)
    torque = 3 * joint.T0 * 2 * 0.25 * 0.4 * joint.a
    assert capacity(model, TORSION).torque == pytest.approx(torque)


def test_three_points_give_a_curve_of_two_straight_parts(joint: Joint) -> None:
    model = Sidmacib(joint, READY_OPTIONS["bilinear"], friction=False)
    strength, most = 3 * joint.T0, 3 * joint.T0 * joint.a / 4
    for share in (0.0, 0.25, 0.5, 0.75, 0.9):
        torque = most * min(1.0, 2.0 * (1.0 - share))
        direction = Direction(torque / (share * strength * joint.a) if share else math.inf)
        point = capacity(model, direction)
        assert point.shear == pytest.approx(share * strength, abs=1e-6)
        assert point.torque == pytest.approx(torque, rel=1e-7)


def test_the_ready_options_are_the_papers_four_and_more() -> None:
    assert {name: READY_OPTIONS[name] for name in OPTIONS} == OPTIONS
    assert [*READY_OPTIONS] == [*OPTIONS, "bilinear"]
