"""The first failure of a joint by the law: statics, symmetry, scaling, history."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import scaled
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib import pairs_of, static_first_failure
from sidmacib.joint import DRY, INNER, Direction, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.mechanics.assembly import Elastic, Failure
from sidmacib.rule import JointFailure, first_failure

SMOOTH = replace(DRY, friction=0.0)
DIRECTIONS = (0.0, 0.1, 0.5, 2.0, math.inf)
BODIES = (UpperBody.COLUMNS, UpperBody.MONOLITHIC)


def joint_of(locks: int, **others: Any) -> Joint:
    """A joint without friction and weight: it is linear but for the contacts."""
    return Joint(locks, **({"dry": SMOOTH, "density": 0.0} | others))


def failure(joint: Joint, eccentricity: float = 0.0, push: Push = Push.PLUS_Y) -> JointFailure:
    return first_failure(joint, Loading(Direction(eccentricity), push=push))


def on_mesh(joint: Joint, loading: Loading, cells: int) -> float:
    """The static model's first failure (N) on so many cells along a lock's shorter side."""
    return static_first_failure(*posed(joint, loading, joint.least_side / cells)).point.load


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("eccentricity", DIRECTIONS)
@pytest.mark.parametrize("locks", [3, 8])
def test_the_lower_locks_carry_the_load(locks: int, eccentricity: float, body: UpperBody) -> None:
    """Shear and, about the origin of x, torque: forces along y have no arm along y."""
    joint = joint_of(locks, upper_body=body)
    state = failure(joint, eccentricity)
    lower = np.array([not joint.is_upper(lock) for lock in joint.numbers])
    direction = Direction(eccentricity)
    shear = state.load * direction.shear
    assert -state.force_y[lower].sum() == pytest.approx(shear, abs=1e-6 * joint.T0)
    assert -state.torque[lower].sum() == pytest.approx(
        state.load * direction.torque * joint.a, abs=1e-6 * joint.T0 * joint.a
    )


def test_three_locks_carry_what_one_does() -> None:
    """In torsion T0 sqrt(a2 + b2) / 6: the elastic torque of a rectangle, at its corner."""
    for body in BODIES:
        joint = joint_of(3, upper_body=body)
        assert failure(joint).load == pytest.approx(joint.T0, rel=1e-6)
    joint = joint_of(3)
    lock = joint.T0 * math.hypot(joint.a, joint.b) / 6.0
    assert failure(joint, math.inf).load * joint.a == pytest.approx(lock, rel=1e-6)


@pytest.mark.parametrize("locks", [4, 6, 9, 15])
def test_where_nothing_can_tilt_the_load_is_the_closed_form(locks: int) -> None:
    """Locks and columns so low that only their shifts count, between stiff horizontal faces."""
    low = {"h": 1e-5, "H": 1e-4}
    dry = replace(SMOOTH, normal_stiffness=2e13)
    joint = joint_of(locks, **low, dry=dry, inner=replace(INNER, normal_stiffness=2e12))
    assert 0.1 < pairs_of(joint).lag < 10.0
    assert failure(joint).load / joint.T0 == pytest.approx(pairs_of(joint).working, rel=1e-3)


@settings(max_examples=10, deadline=None)
@given(st.floats(-3, 3), st.floats(-4, 4), st.sampled_from(DIRECTIONS))
def test_strength_and_area_scale_loads(size: float, strength: float, eccentricity: float) -> None:
    plain = joint_of(5)
    larger = scaled(plain, 10.0**size, 10.0**strength)
    loads = [failure(each, eccentricity).load / each.T0 for each in (plain, larger)]
    assert loads[1] == pytest.approx(loads[0], rel=1e-4)


def test_mirrored_torques_and_pushes_are_alike() -> None:
    for eccentricity in (0.5, math.inf):
        one, other = (failure(joint_of(4), sign * eccentricity).load for sign in (-1, 1))
        assert one == pytest.approx(other, rel=1e-4)
    back = failure(joint_of(6), 0.2, Push.MINUS_Y)
    other = failure(joint_of(6, first=Side.LOWER), 0.2)
    assert back.load == pytest.approx(other.load, rel=1e-9)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("eccentricity", [0.0, 0.3, math.inf])
@pytest.mark.parametrize(
    ("locks", "others", "cells", "within"),
    [
        (5, {}, 4, 0.02),
        (8, {"H": 0.06, "h": 0.02}, 4, 0.02),
        (11, {"a": 0.1, "H": 0.1, "inner": replace(INNER, shear_stiffness=3e9)}, 4, 0.02),
        (3, {"elastic": Elastic(1e10)}, 2, 0.03),
    ],
)
def test_first_failures_are_those_of_the_static_model(
    locks: int,
    others: dict[str, Any],
    cells: int,
    within: float,
    eccentricity: float,
    body: UpperBody,
) -> None:
    joint, loading = joint_of(locks, upper_body=body, **others), Loading(Direction(eccentricity))
    expected = on_mesh(joint, loading, cells)
    assert first_failure(joint, loading).load == pytest.approx(expected, rel=within)


def test_a_weak_cut_fails_before_the_locks_under_torque() -> None:
    joint = joint_of(9, H=0.012, dry=replace(SMOOTH, normal_stiffness=3e8))
    assert failure(joint, math.inf).utilisation.max() < 0.99
    assert failure(joint, 0.0).utilisation.max() == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("how", list(Failure))
def test_the_first_failure_is_the_same_however_bonds_fail(how: Failure) -> None:
    inner = replace(INNER, fracture_energy=20.0)
    joint = joint_of(5, inner=inner)
    assert failure(replace(joint, failure=how), 0.2).load == failure(joint, 0.2).load


@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"locks": 1}, r"locks: must be at least 2 for the law \(got 1\)"),
        ({"different": {2: OwnLock(width=0.03)}}, "different: must be none"),
        ({"upper_body": UpperBody.JOINED}, "upper_body: must be columns or monolithic"),
        ({"inner": replace(INNER, friction=0.2)}, "inner.friction: must be 0"),
        ({"inner": replace(INNER, cohesion=0.0)}, "inner.cohesion: must be more than 0"),
        ({"inner": replace(INNER, tensile_strength=0.0)}, "inner.tensile_strength: must be more"),
    ],
)
def test_what_the_law_is_not_made_for_is_refused(others: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        failure(Joint(**({"locks": 3} | others)))
