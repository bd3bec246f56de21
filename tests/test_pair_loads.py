"""SiDMACIB in closed form: the loads of the linear programme, for two points a lock."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.contact_points import READY_OPTIONS, ContactOption
from sidmacib.contact_points.programme import Sidmacib, capacities, pair_loads
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side

DIRECTIONS = [Direction(e) for e in (0.0, 0.2, -0.2, 1.0, -5.0, math.inf, -math.inf)]
DIFFERENT = {
    1: OwnLock(width=0.09, inner=replace(INNER, cohesion=2e5)),
    2: OwnLock(density=9e3),
}


@settings(max_examples=25)
@given(
    st.integers(2, 6),
    st.floats(0.0, 0.5),
    st.floats(0.0, 1.0),
    st.floats(0.0, 2.0),
    st.floats(0.01, 0.3),
    st.sampled_from([HoldDown.plate(), HoldDown.weight(), HoldDown.force(700.0)]),
    st.sampled_from([{}, DIFFERENT]),
    st.sampled_from(Side),
)
def test_loads_are_those_of_the_linear_programme(
    locks: int,
    distance: float,
    factor: float,
    friction: float,
    height: float,
    hold_down: HoldDown,
    different: dict[int, OwnLock],
    first: Side,
) -> None:
    dry = replace(DRY, friction=friction)
    joint = Joint(locks, H=height, dry=dry, hold_down=hold_down, different=different, first=first)
    strength = tuple(np.linspace(factor, 1.0, locks))
    model = Sidmacib(joint, ContactOption.pair(distance), strength)
    expected = [point.load for point in capacities(model, DIRECTIONS)]
    found = pair_loads(model, DIRECTIONS)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9 * joint.T0)


def test_the_friction_that_a_model_leaves_out_carries_nothing(joint: Joint) -> None:
    model = Sidmacib(joint, ContactOption.pair(0.25), friction=False)
    torsion = pair_loads(model, [Direction(math.inf)])
    assert torsion == pytest.approx(0.25 * joint.locks * joint.T0)


def test_without_any_pressure_no_shear_is_carried(joint: Joint) -> None:
    model = Sidmacib(replace(joint, density=0.0), ContactOption.pair(0.25), overload=0.0)
    assert pair_loads(model, [Direction(0.0)]) == 0.0


def test_other_contact_points_are_refused(joint: Joint) -> None:
    with pytest.raises(ValueError, match="must be a pair of contact points"):
        pair_loads(Sidmacib(joint, READY_OPTIONS["bilinear"]), DIRECTIONS)
