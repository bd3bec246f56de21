"""Law and safe rule: where they hold, and what they refuse."""

import math
from dataclasses import replace
from typing import Any

import pytest

from sidmacib.chain.rule import RULES, SAFETY, law, safe
from sidmacib.errors import CapacityError
from sidmacib.hold_down import HoldDown
from sidmacib.joint import DRY, INNER, Direction, Joint, UpperBody
from sidmacib.loading import Loading, Push, lateral_load
from sidmacib.mechanics.assembly import Elastic
from sidmacib.mechanics.static import static_peak
from sidmacib.pieces import assemble

BODIES = (UpperBody.COLUMNS, UpperBody.MONOLITHIC)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("eccentricity", [0.0, 0.1, 1.0, math.inf])
@pytest.mark.parametrize("locks", [3, 5, 8])
def test_the_joint_carries_what_is_safe_and_fails_where_the_law_says(
    locks: int, eccentricity: float, body: UpperBody
) -> None:
    joint, direction = Joint(locks, upper_body=body), Direction(eccentricity)
    assembly = assemble(joint, 0.02)
    static = static_peak(assembly, lateral_load(joint, assembly, Loading(direction)))
    assert safe(joint, direction).load < static.peak.load
    assert law(joint, direction).load == pytest.approx(static.first_failure_load, rel=0.05)


def test_shear_and_torque_are_those_of_the_load() -> None:
    joint = Joint(5)
    found = law(joint, Direction(0.5))
    assert found.torque == pytest.approx(0.5 * joint.a * found.shear)
    assert found.load == pytest.approx(math.hypot(found.shear, found.torque / joint.a))


def test_the_safe_rule_is_the_law_of_smooth_joints_with_a_margin() -> None:
    joint = Joint(5, dry=replace(DRY, friction=0.0), density=0.0)
    direction = Direction(0.3)
    expected = law(joint, direction).load / SAFETY
    assert safe(joint, direction).load == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("locks", "body", "friction", "eccentricity", "load"),
    [
        (3, UpperBody.COLUMNS, 0.3, 0.0, 248.143951),
        (5, UpperBody.COLUMNS, 0.3, 0.5, 162.643598),
        (9, UpperBody.COLUMNS, 0.0, math.inf, 103.623556),
        (7, UpperBody.MONOLITHIC, 0.3, 0.2, 518.440257),
        (9, UpperBody.MONOLITHIC, 0.0, 2.0, 206.692483),
    ],
)
def test_the_law_is_the_one_that_was_held_against_the_static_model(
    locks: int, body: UpperBody, friction: float, eccentricity: float, load: float
) -> None:
    """Its margin and its fitted numbers hold for these loads (N), however they are computed."""
    joint = Joint(locks, upper_body=body, dry=replace(DRY, friction=friction))
    assert law(joint, Direction(eccentricity)).load == pytest.approx(load, rel=1e-6)


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
@pytest.mark.parametrize(
    ("others", "words"),
    [
        ({"locks": 32}, "locks: 32 is not possible; it must be from 2 to 31"),
        ({"a": 0.2}, "a / b: 4 is not possible"),
        ({"h": 0.04}, "h / b: 0.8 is not possible"),
        ({"H": 0.01}, "H / b: 0.2 is not possible"),
        ({"dry": replace(DRY, friction=0.9)}, "friction: 0.9 is not possible"),
        ({"dry": replace(DRY, normal_stiffness=1e12)}, "dry over inner faces: 100"),
        ({"inner": replace(INNER, shear_stiffness=1e6)}, "shear over normal stiffness"),
        ({"inner": replace(INNER, tensile_strength=1e5)}, "tensile strength over cohesion"),
        ({"elastic": Elastic(1e9)}, r"E / \(Kn b\): 2 is not possible"),
    ],
)
def test_what_lies_outside_the_study_is_refused(
    rule: Any, others: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        rule(Joint(**({"locks": 5} | others)), Direction(0.0))


def test_the_ends_of_the_spans_are_inside() -> None:
    low = Joint(2, a=0.025, h=0.003, H=0.015, dry=replace(DRY, normal_stiffness=3e8))
    assert law(low, Direction(0.0)).load > 0.0


def test_two_locks_carry_no_eccentricity_beyond_their_only_face() -> None:
    with pytest.raises(CapacityError, match=r"two locks do not carry an eccentricity of 0\.6 a"):
        law(Joint(2), Direction(0.6))


@pytest.mark.parametrize("rule", RULES.values(), ids=list(RULES))
def test_a_joint_without_a_pair_that_bears_carries_nothing(rule: Any) -> None:
    with pytest.raises(CapacityError, match="no pair of 2 locks bears"):
        rule(Joint(2), Direction(0.0), Push.MINUS_Y)


@pytest.mark.parametrize("eccentricity", [0.0, 0.3])
def test_a_joint_that_nothing_but_pressure_holds_down_may_rock(eccentricity: float) -> None:
    """It fails where the static model says, far below one under a plate or well pressed."""
    direction = Direction(eccentricity)
    plate, light, heavy = (
        Joint(3, H=0.08, hold_down=hold)
        for hold in (HoldDown.plate(), HoldDown.pressure(2e4), HoldDown.pressure(2e5))
    )
    assembly = assemble(light, 0.02)
    static = static_peak(assembly, lateral_load(light, assembly, Loading(direction)))
    assert law(light, direction).load == pytest.approx(static.first_failure_load, rel=0.05)
    assert law(light, direction).load < 0.95 * law(heavy, direction).load
    assert safe(light, direction).load < static.peak.load
    assert plate.pressing_force is None


def test_there_is_no_safe_load_where_a_joint_may_tip() -> None:
    light = Joint(3, H=0.08, hold_down=HoldDown.pressure(5e3))
    with pytest.raises(CapacityError, match=r"(safe: V of .* may tip the joint|nothing holds)"):
        safe(light, Direction(0.0))


def test_friction_above_and_below_counts_with_limits() -> None:
    """Under a plate for half as much as all else, under a given pressure not at all."""
    rough = replace(DRY, friction=0.5)
    tall = Joint(3, a=0.05, H=0.15, dry=rough)
    smooth = replace(tall, dry=replace(DRY, friction=0.0))
    direction = Direction(0.0)
    assert law(tall, direction).load > 1.2 * law(smooth, direction).load
    assert safe(tall, direction).load <= 1.5 * tall.T0 / SAFETY * (1 + 1e-3)
    pressed = Joint(3, dry=rough, hold_down=HoldDown.pressure(8e4))
    assert law(pressed, direction).load > 1.5 * law(smooth, direction).load
    assert safe(pressed, direction).load < 1.05 * pressed.T0 / SAFETY


def test_the_safe_rule_refuses_what_may_slide_before_a_bond_fails() -> None:
    rough = Joint(5, dry=replace(DRY, friction=0.6))
    assert law(rough, Direction(0.0)).load > 0.0
    with pytest.raises(
        ValueError, match=r"friction: 0\.6 is not possible; it must be at most 0\.5"
    ):
        safe(rough, Direction(0.0))
