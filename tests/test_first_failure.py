"""The first failure of a joint by the law: statics, symmetry, scaling, history."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import scaled
from hypothesis import given, settings
from hypothesis import strategies as st
from joints import sawn

from sidmacib import CapacityError, Effect, Sensitivity, pairs_of, sensitivity, static_first_failure
from sidmacib.joint import DRY, INNER, Direction, HoldDown, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Loading, Push, posed
from sidmacib.joint.parameters import PARAMETERS, with_parameters
from sidmacib.mechanics.assembly import Elastic
from sidmacib.rule import JointFailure, first_failure

SMOOTH = replace(DRY, friction=0.0)
DIRECTIONS = (0.0, 0.1, 0.5, 2.0, math.inf)
BODIES = (UpperBody.COLUMNS, UpperBody.MONOLITHIC)


FAINT = replace(INNER, cohesion=0.08, tensile_strength=0.37)  # Pa: bonds that fail where they are


def joint_of(locks: int, **others: Any) -> Joint:
    """A joint without friction and weight, hardly displaced: it is linear but for the contacts."""
    return sawn(locks, **({"dry": SMOOTH, "inner": FAINT, "density": 0.0} | others))


def failure(joint: Joint, eccentricity: float = 0.0, push: Push = Push.PLUS_Y) -> JointFailure:
    return first_failure(joint, Loading(Direction(eccentricity), push=push))


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


def test_a_weak_cut_fails_before_the_locks_under_torque() -> None:
    stiff = replace(INNER, normal_stiffness=1e13, shear_stiffness=1e13)
    joint = joint_of(9, H=0.012, inner=stiff, dry=replace(SMOOTH, normal_stiffness=3e11))
    assert failure(joint, math.inf).utilisation.max() < 0.99
    assert failure(joint, 0.0).utilisation.max() == pytest.approx(1.0, abs=1e-4)


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
        failure(sawn(**({"locks": 3} | others)))


# --- effects: against the joint with 1 % more or less, and by scaling ----------------------------
WEAK = replace(INNER, tensile_strength=0.0)
ODD = {  # stiffnesses and sizes of which no two are the same
    "a": 0.07,
    "b": 0.045,
    "h": 0.011,
    "H": 0.031,
    "inner": replace(INNER, normal_stiffness=7e9, shear_stiffness=1.3e10),
    "dry": replace(DRY, normal_stiffness=1.2e10, shear_stiffness=8e9),
}
IN_ONE_PIECE = {"upper_body": UpperBody.MONOLITHIC, "hold_down": HoldDown.force(150.0)}
HEAVY = {"density": 4e4, "hold_down": HoldDown.weight(), "first": Side.LOWER}
ROUGH_BOND = replace(INNER, bond_friction=0.4, shear_stiffness=6e9)
OTHER = OwnLock(width=0.06, density=900.0)
JOINTS = {
    "as published": (sawn(3), Direction(0.3)),
    "rough": (sawn(4, **ODD), Direction(0.2)),
    "smooth, in one piece": (sawn(7, **ODD | {"dry": SMOOTH} | IN_ONE_PIECE), Direction(1.65)),
    "pressed": (sawn(5, **ODD, hold_down=HoldDown.pressure(4e4)), Direction(0.5)),
    "heavy": (sawn(3, **ODD, **HEAVY), Direction(0.2)),
    "rough bonds": (sawn(4, **ODD | {"inner": ROUGH_BOND}), Direction(0.3)),
    "other locks": (sawn(3, **ODD, different={2: OTHER}), Direction(0.3)),
}


def per_cent(found: Sensitivity, *names: str) -> float:
    """The effect of 1 % more of all these."""
    return sum(each.more or 0.0 for each in found.effects if each.name in names)


def effect_of(found: Sensitivity, name: str) -> Effect:
    (effect,) = (each for each in found.effects if each.name == name)
    return effect


# --- what the columns say ------------------------------------------------------------------------
MESH = 0.0131  # m: no size of the joints below changes its number of cells by 1 %
TORSION = Direction(math.inf)
ONE_PIECE = sawn(5, upper_body=UpperBody.MONOLITHIC, hold_down=HoldDown.pressure(2e4))


def carried(joint: Joint, direction: Direction, increment: float | None = None) -> float:
    """V in N, in torsion M in N m, at the first failure of a joint that is assembled anew."""
    problem = posed(joint, Loading(direction), MESH)
    load = static_first_failure(*problem, increment=increment).point.load
    return load * (direction.torque * joint.a if direction is TORSION else direction.shear)


@pytest.mark.long
@pytest.mark.parametrize("name", ["a", "b", "h", "cohesion", "friction"])
@pytest.mark.parametrize("direction", [Direction(0.3), TORSION], ids=["eccentric", "torsion"])
@pytest.mark.parametrize("joint", [sawn(5), ONE_PIECE], ids=["columns", "one piece"])
def test_effects_are_those_of_1_per_cent(joint: Joint, direction: Direction, name: str) -> None:
    effect = effect_of(sensitivity(joint, Loading(direction), MESH), name)
    base = carried(joint, direction)
    for part, mine in ((1.01, effect.more), (0.99, effect.less)):
        changed = with_parameters(joint, {name: part * PARAMETERS[name].of(joint)})
        theirs = 100.0 * (carried(changed, direction) / base - 1.0)
        assert mine == pytest.approx(theirs, abs=4e-3)


@pytest.mark.long
@pytest.mark.parametrize(
    ("joint", "name"),
    [
        (sawn(3, hold_down=HoldDown.force(2000.0)), "H"),
        (sawn(3, hold_down=HoldDown.force(2000.0)), "shear_stiffness"),
        (sawn(2, hold_down=HoldDown.pressure(5e4)), "cohesion"),
        (sawn(2, hold_down=HoldDown.pressure(5e4)), "friction"),
    ],
)
def test_where_contacts_slide_effects_do_not_depend_on_the_increments(
    joint: Joint, name: str
) -> None:
    """With as many as each of the joints needed there was no derivative, and a sign was wrong."""
    effect = effect_of(sensitivity(joint, Loading(Direction(1.0)), MESH), name)
    base = carried(joint, Direction(1.0), 0.002)
    assert effect.derivative is not None
    for part, mine in ((1.01, effect.more), (0.99, effect.less)):
        changed = with_parameters(joint, {name: part * PARAMETERS[name].of(joint)})
        theirs = 100.0 * (carried(changed, Direction(1.0), 0.002) / base - 1.0)
        assert mine == pytest.approx(theirs, rel=0.05)


@pytest.mark.long
def test_where_another_node_fails_first_within_1_per_cent_there_is_no_derivative() -> None:
    """The slope of the load promises 0.77 % for 1 % less height, and 0.34 % are carried."""
    found = sensitivity(ONE_PIECE, Loading(TORSION), 0.24975 * ONE_PIECE.least_side)
    height = effect_of(found, "h")
    assert height.less == pytest.approx(0.335, abs=2e-3)
    assert height.more == pytest.approx(-0.754, abs=2e-3)
    note = "slopes for +1 % and -1 % differ; no derivative"
    assert (height.derivative, height.note) == (None, note)


def test_in_torsion_effects_are_of_the_torque() -> None:
    joint = sawn(5)
    found = sensitivity(joint, Loading(TORSION), MESH)
    assert (found.unit, found.shear) == ("N m", 0.0)
    assert found.amount == found.torque == pytest.approx(carried(joint, TORSION))
    slope = effect_of(found, "cohesion").derivative
    assert slope == pytest.approx(found.torque / joint.inner.cohesion, rel=1e-2)


# --- by scaling, to second order -----------------------------------------------------------------
STRENGTHS = ("cohesion", "tensile_strength")
STIFFNESSES = [f"{face}{way}_stiffness" for face in ("", "dry_") for way in ("normal", "shear")]
SECOND_ORDER = 0.02  # per cent


@pytest.mark.parametrize("name", JOINTS)
def test_stiffnesses_that_all_rise_change_nothing_and_strengths_and_loads_scale(name: str) -> None:
    """A larger joint of a lighter material carries the same stresses."""
    joint, direction = JOINTS[name]
    loading = Loading(direction, push=Push.MINUS_Y if name == "rough" else Push.PLUS_Y)
    found = sensitivity(joint, loading, joint.least_side)
    assert per_cent(found, *STIFFNESSES) == pytest.approx(0.0, abs=SECOND_ORDER)
    if name == "other locks":  # which stay as they are
        return
    together = per_cent(found, *STRENGTHS, "density", "pressure", "force")
    assert together == pytest.approx(1.0, abs=SECOND_ORDER)
    lengths, force = per_cent(found, "a", "b", "h", "H"), per_cent(found, "force")
    power = 3.0 if found.unit == "N m" else 2.0
    scaled = lengths - per_cent(found, "density") + 2.0 * force
    assert scaled == pytest.approx(power, abs=SECOND_ORDER)


# --- values of 0, and what is refused ------------------------------------------------------------
@pytest.mark.parametrize("name", ["bond_friction", "friction"])
def test_at_a_value_of_0_the_derivative_is_that_of_more(name: str) -> None:
    joint, loading = sawn(5, dry=SMOOTH), Loading(Direction(0.3))
    effect = effect_of(sensitivity(joint, loading, MESH), name)
    assert (effect.more, effect.less, effect.note) == (None, None, "for more")
    part = "inner" if name == "bond_friction" else "dry"
    rougher = replace(joint, **{part: replace(getattr(joint, part), **{name: 0.01})})
    rise = (carried(rougher, Direction(0.3)) - carried(joint, Direction(0.3))) / 0.01
    assert effect.derivative == pytest.approx(rise, rel=0.02)


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (sawn(1, hold_down=HoldDown.weight()), "slide or rock before a bond fails"),
        (sawn(3, elastic=Elastic(1e10)), "rigid pieces only"),
        (sawn(3, inner=WEAK), "before the load is raised"),
    ],
)
def test_what_has_no_first_failure_of_a_bond_is_refused(joint: Joint, words: str) -> None:
    with pytest.raises(CapacityError, match=words):
        sensitivity(joint, Loading(Direction(0.3)), joint.least_side)
