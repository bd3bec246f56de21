"""Reductions, and SiDMACIB in closed form for two points a lock."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sidmacib.contact_points.options import (
    READY_OPTIONS,
    REDUCTIONS,
    ContactOption,
    active,
    half_rule,
)
from sidmacib.contact_points.programme import Sidmacib, capacities, pair_loads
from sidmacib.joint.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side

WEIGHTS = (0.6, 1.0, 0.67, 0.68, 0.01)


@pytest.mark.parametrize(
    ("reduction", "strength"),
    [
        ("none", (1, 1, 1, 1, 1)),
        ("floor_of_sum", (0, 1, 0, 1, 0)),  # 2.96, rounded down
        ("half", (0, 1, 0, 1, 0)),
        ("lower_sum", (0, 1.0, 0, 0.68, 0)),
        ("per_lock", WEIGHTS),
    ],
)
def test_reductions_of_five_locks(reduction: str, strength: tuple[float, ...]) -> None:
    assert REDUCTIONS[reduction](Joint(5), WEIGHTS) == pytest.approx(strength)


def test_upper_locks_count_only_when_all_lower_ones_do() -> None:
    assert active(Joint(5), 3) == (1, 1, 0, 1, 0)


def test_half_of_an_even_number_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^locks: 4 is not allowed .*; it must be odd$"):
        half_rule(Joint(4), ())


@pytest.mark.parametrize("rule", ["half", "floor_of_sum"])
def test_rules_that_count_locks_refuse_locks_that_differ_in_strength(rule: str) -> None:
    wide = Joint(3, different={2: OwnLock(width=0.06)})
    message = r"^different: a strength from 240 to 288 N is not allowed with .* the same for all$"
    with pytest.raises(ValueError, match=message):
        REDUCTIONS[rule](wide, (1.0, 1.0, 1.0))
    heavy = Joint(3, different={2: OwnLock(density=2000.0)})
    assert sum(REDUCTIONS[rule](heavy, (0.5, 0.5, 0.0))) == 1.0


def test_from_the_lower_block_on_lower_locks_count_first_too() -> None:
    joint = Joint(3, first=Side.LOWER)
    assert half_rule(joint, ()) == (1.0, 0.0, 0.0)
    assert REDUCTIONS["lower_sum"](joint, (0.1, 1.0, 0.9)) == (0.1, 0.0, 0.9)


@pytest.mark.parametrize("sum_", [0.0, 0.999, 1.0, 2.5, 5.0, 9.0])
def test_the_sum_of_weights_counts_rounded_down_and_at_most_all_locks(sum_: float) -> None:
    strength = REDUCTIONS["floor_of_sum"](Joint(5), (sum_ / 5,) * 5)
    assert sum(strength) == min(math.floor(sum_ + 1e-12), 5)


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
