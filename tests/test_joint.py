"""The joint and the directions of loading."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.joint import Direction, Joint, Side


def test_strength_of_a_lock_is_the_published_240_N(joint: Joint) -> None:
    assert pytest.approx(240.0) == joint.T0


def test_locks_belong_to_the_blocks_in_turn_from_the_first_on() -> None:
    joint, other = Joint(locks=5), Joint(locks=5, first=Side.LOWER)
    assert joint.upper_locks == other.lower_locks == (1, 3, 5)
    assert joint.lower_locks == other.upper_locks == (2, 4)


@given(st.floats(-100, 100))
def test_direction_keeps_its_eccentricity(eccentricity: float) -> None:
    direction = Direction(eccentricity)
    assert direction.torque / direction.shear == pytest.approx(eccentricity)
    assert math.hypot(direction.shear, direction.torque) == pytest.approx(1.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_pure_torsion_has_no_shear(sign: float) -> None:
    direction = Direction(sign * math.inf)
    assert (direction.shear, direction.torque) == (0.0, sign)
