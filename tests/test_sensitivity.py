"""Derivatives of a joint's first failure: against differences of the whole path, and by scaling."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import sidmacib.mechanics.rigid.solver as rigid
from sidmacib.errors import CapacityError
from sidmacib.joint.effects import Effect, Sensitivity, fields_of, sensitivity
from sidmacib.joint.hold_down import HoldDown
from sidmacib.joint.joint import DRY, INNER, Block, Direction, Joint, OwnLock, UpperBody
from sidmacib.joint.loading import Loading, Push, lateral_load, posed
from sidmacib.joint.pieces import assemble, reassemble
from sidmacib.mechanics.assembly import Assembly, Elastic, FaceMaterial, Floats, Loads
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static.model import path_to_first_failure
from sidmacib.mechanics.utilisation import utilisation

SMOOTH = replace(DRY, friction=0.0)
WEAK = replace(INNER, tensile_strength=0.0)
ODD = {  # stiffnesses and sizes of which no two are the same
    "a": 0.07,
    "b": 0.045,
    "h": 0.011,
    "H": 0.031,
    "inner": replace(INNER, normal_stiffness=7e9, shear_stiffness=1.3e10),
    "dry": replace(DRY, normal_stiffness=1.2e10, shear_stiffness=8e9),
}
JOINTS = {
    "as published": (Joint(3), Direction(0.3)),
    "smooth": (Joint(5, **ODD | {"dry": SMOOTH}), Direction(0.3)),
    "rough, in shear": (Joint(5, **ODD), Direction(0.0)),
    "rough": (Joint(4, **ODD), Direction(0.2)),
    "rough, in torsion": (Joint(3, **ODD), Direction(math.inf)),
    "one piece": (Joint(5, **ODD, upper_body=UpperBody.MONOLITHIC), Direction(0.4)),
    "smooth, in one piece": (
        Joint(
            7,
            **ODD | {"dry": SMOOTH},
            upper_body=UpperBody.MONOLITHIC,
            hold_down=HoldDown.force(150.0),
        ),
        Direction(1.65),
    ),
    "joined": (Joint(3, **ODD, upper_body=UpperBody.JOINED), Direction(0.1)),
    "pressed": (Joint(5, **ODD, hold_down=HoldDown.pressure(4e4)), Direction(0.5)),
    "under a force": (Joint(4, **ODD, hold_down=HoldDown.force(90.0)), Direction(0.1)),
    "heavy": (
        Joint(3, **ODD, density=4e4, hold_down=HoldDown.weight(), first=Block.LOWER),
        Direction(0.2),
    ),
    "weightless": (Joint(5, **ODD, density=0.0), Direction(0.3)),
    "rough bonds": (
        Joint(4, **ODD | {"inner": replace(INNER, bond_friction=0.4, shear_stiffness=6e9)}),
        Direction(0.3),
    ),
    "other locks": (
        Joint(3, **ODD, different={2: OwnLock(width=0.06, density=900.0)}),
        Direction(0.3),
    ),
}
CASES = pytest.mark.parametrize("name", JOINTS)


def solved(name: str) -> tuple[Joint, Loading, Sensitivity]:
    joint, direction = JOINTS[name]
    loading = Loading(direction, push=Push.MINUS_Y if name == "rough" else Push.PLUS_Y)
    return joint, loading, sensitivity(joint, loading, joint.least_side)


def per_cent(found: Sensitivity, *names: str) -> float:
    """The effect of 1 % more of all these."""
    return sum(each.more or 0.0 for each in found.effects if each.name in names)


# --- against differences -------------------------------------------------------------------------
def at_loads(solver: rigid.RigidSolver, loads: Sequence[float]) -> Equilibrium:
    """The last equilibrium of a path through ``loads`` (N), which begins without load."""
    point = solver.start()
    for load in loads[1:]:
        point = solver.solve(load, point.unknowns, point.state)
    return point


def first_failure(assembly: Assembly, loads: Loads, parts: Floats, guess: float) -> float:
    """The load (N) at which a node fails, on a path through ``parts`` of it: secant method."""
    solver = rigid.RigidSolver(assembly, loads)

    def excess(load: float) -> float:
        point = at_loads(solver, (parts * load).tolist())
        return float(utilisation(solver.contact_law, point.state, point.force).max()) - 1.0

    one, other = guess, guess * (1.0 - 1e-6)
    over, over_other = excess(one), excess(other)
    for _ in range(6):
        if over == over_other or abs(over) < 1e-14:
            break
        one, other = one - over * (one - other) / (over - over_other), one
        over, over_other = excess(one), over
    return one


def by_differences(
    joint: Joint, loading: Loading, found: Sensitivity, effect: Effect, side: float
) -> Iterator[float]:
    """Changes of the first failure in % for 1 % of a parameter, by differences of several steps."""
    assembly, loads = posed(joint, loading, joint.least_side)
    path, _ = path_to_first_failure(assembly, loads)
    parts = np.array([*(point.load / found.load for point in path[:-1]), 1.0])
    (field,) = (each for each in fields_of(joint) if each.name == effect.name)

    def at(change: float) -> float:
        other = field.put(joint, effect.value * (1.0 + side * change))
        again = reassemble(other, assembly)
        return first_failure(again, lateral_load(other, again, loading), parts, found.load)

    start = first_failure(assembly, loads, parts, found.load)
    assert start == pytest.approx(found.load, rel=1e-11)
    for step in (1e-4, 1e-5, 1e-6):
        one, two, three = (at(k * step) for k in (1, 2, 3))
        yield (-11.0 * start + 18.0 * one - 9.0 * two + 2.0 * three) / (6.0 * step * start)


@CASES
def test_effects_are_those_of_differences(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    joint, loading, found = solved(name)
    monkeypatch.setattr(rigid, "RESIDUAL", 1e-12)
    for effect in found.effects:
        for side, mine in ((1.0, effect.more), (-1.0, effect.less)):
            if effect.value:
                assert mine is not None
                theirs = by_differences(joint, loading, found, effect, side)
                # A larger step may let a contact open or slide; rounding spoils a smaller one.
                assert any(abs(each - mine) < 1e-6 for each in theirs), (effect, side)


# --- by scaling ----------------------------------------------------------------------------------
STRENGTHS = ("cohesion", "tensile_strength")
STIFFNESSES = (
    "normal_stiffness",
    "shear_stiffness",
    "dry_normal_stiffness",
    "dry_shear_stiffness",
)
KINKS = 1e-5  # per cent: by which effects for more and less differ where contacts only touch


SCALED = pytest.mark.parametrize(
    "name", [name for name in JOINTS if name != "other locks"]
)  # which stay as they are


@SCALED
def test_strengths_and_loads_that_all_rise_raise_the_failure_as_much(name: str) -> None:
    _, _, found = solved(name)
    together = per_cent(found, *STRENGTHS, "density", "pressure", "force")
    assert together == pytest.approx(1.0, abs=1e-9)


@CASES
def test_stiffnesses_that_all_rise_change_nothing(name: str) -> None:
    _, _, found = solved(name)
    assert per_cent(found, *STIFFNESSES) == pytest.approx(0.0, abs=KINKS)


@SCALED
def test_a_larger_joint_of_a_lighter_material_carries_the_same_stresses(name: str) -> None:
    _, _, found = solved(name)
    lengths, force = per_cent(found, "a", "b", "h", "H"), per_cent(found, "force")
    assert lengths - per_cent(found, "density") + 2.0 * force == pytest.approx(2.0, abs=1e-8)


RANDOM = st.builds(
    Joint,
    st.integers(2, 5),
    a=st.floats(0.04, 0.1),
    b=st.floats(0.03, 0.07),
    h=st.floats(0.005, 0.02),
    H=st.floats(0.02, 0.06),
    density=st.floats(0.0, 3e3),
    inner=st.builds(
        FaceMaterial,
        st.floats(5e9, 2e10),
        st.floats(5e9, 2e10),
        st.just(0.0),
        st.floats(4e4, 2e5),
        st.floats(2e5, 6e5),
        bond_friction=st.sampled_from([0.0, 0.3]),
    ),
    dry=st.builds(
        FaceMaterial,
        st.floats(5e9, 2e10),
        st.floats(5e9, 2e10),
        st.one_of(st.just(0.0), st.floats(0.1, 0.6)),
        st.just(0.0),
        st.just(0.0),
    ),
    upper_body=st.sampled_from([UpperBody.COLUMNS, UpperBody.MONOLITHIC]),
    first=st.sampled_from(Block),
    hold_down=st.one_of(
        st.just(HoldDown.plate()),
        st.floats(1e3, 1e5).map(HoldDown.pressure),
        st.floats(10.0, 300.0).map(HoldDown.force),
    ),
)
RATIOS = st.sampled_from([0.0, 0.1, 0.3, 1.0, math.inf])


@given(joint=RANDOM, ratio=RATIOS, push=st.sampled_from(Push))
@settings(max_examples=8)
def test_any_joint_scales_as_it_must(joint: Joint, ratio: float, push: Push) -> None:
    try:
        found = sensitivity(joint, Loading(Direction(ratio), push=push), joint.least_side)
    except CapacityError as error:
        assert "slide or rock" in str(error)
        return
    loads = per_cent(found, *STRENGTHS, "density", "pressure", "force")
    assert loads == pytest.approx(1.0, abs=KINKS)
    assert per_cent(found, *STIFFNESSES) == pytest.approx(0.0, abs=KINKS)
    lengths, force = per_cent(found, "a", "b", "h", "H"), per_cent(found, "force")
    assert lengths - per_cent(found, "density") + 2.0 * force == pytest.approx(2.0, abs=KINKS)


# --- kinks, and what has no derivative -----------------------------------------------------------
def test_nodes_that_fail_together_and_stay_together_have_one_derivative() -> None:
    joint = Joint(5)
    found = sensitivity(joint, Loading(Direction(0.0)), joint.least_side)
    assert found.faces == ("inner-lower-lock2",)  # all nine nodes of which carry the same shear
    by_name = {each.name: each for each in found.effects}
    assert by_name["a"].more == pytest.approx(1.0, abs=1e-9)
    assert by_name["a"].less == pytest.approx(-1.0, abs=1e-9)


def test_friction_of_bonds_from_0_is_that_of_the_node_with_least_compression() -> None:
    joint = Joint(4, **ODD)
    loading = Loading(Direction(0.0))
    smooth = sensitivity(joint, loading, joint.least_side)
    (effect,) = (each for each in smooth.effects if each.name == "bond_friction")
    assert effect.derivative is not None and effect.more is None
    little = 1e-5
    rough = replace(joint, inner=replace(joint.inner, bond_friction=little))
    after = sensitivity(rough, loading, joint.least_side)
    assert (after.load - smooth.load) / little == pytest.approx(effect.derivative, rel=1e-3)


def test_where_faces_only_touch_less_and_more_may_differ() -> None:
    """Under their weight the sides of published locks touch without a force."""
    joint = Joint(5)
    found = sensitivity(joint, Loading(Direction(0.3)), joint.least_side)
    kinked = [each.name for each in found.effects if each.derivative is None]
    assert kinked == ["normal_stiffness", "dry_normal_stiffness"]
    for each in found.effects:
        if each.name in kinked:
            assert each.more is not None and each.less is not None
            assert 1e-7 < abs(each.more + each.less) < 1e-4


def test_friction_from_0_has_no_effect_that_the_smooth_joint_knows() -> None:
    """Nothing holds a smooth joint along its locks, so a little friction decides how it moves."""
    joint = Joint(5, dry=SMOOTH)
    found = sensitivity(joint, Loading(Direction(0.3)), joint.least_side)
    (effect,) = (each for each in found.effects if each.name == "friction")
    assert (effect.derivative, effect.more, effect.less) == (None, None, None)


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (Joint(1, hold_down=HoldDown.weight()), "slide or rock before a bond fails"),
        (Joint(3, elastic=Elastic(1e10)), "rigid pieces only"),
        (Joint(3, inner=WEAK), "before the load is raised"),
        (Joint(3, inner=WEAK, hold_down=HoldDown.pressure(5e4)), "without strength"),
    ],
)
def test_what_has_no_first_failure_of_a_bond_is_refused(joint: Joint, words: str) -> None:
    with pytest.raises(CapacityError, match=words):
        sensitivity(joint, Loading(Direction(0.3)), joint.least_side)


def test_a_joint_with_the_nodes_of_another_has_each_at_the_same_part_of_its_face() -> None:
    joint = Joint(3, a=0.06, b=0.05)
    other = replace(joint, a=0.12, h=0.016)
    again = reassemble(other, assemble(joint, 0.02))
    fresh = assemble(other, 0.02)
    assert [face.area for face in again.faces] == [face.area for face in fresh.faces]
    assert len(again.nodes.area) == len(assemble(joint, 0.02).nodes.area)
    for number, face in enumerate(again.faces):
        here = again.nodes.face == number
        assert again.nodes.area[here].sum() == pytest.approx(face.area)
        assert again.nodes.position[here].min(axis=0) == pytest.approx(face.low)
        assert again.nodes.position[here].max(axis=0) == pytest.approx(face.high)
    with pytest.raises(ValueError, match="same pieces"):
        reassemble(replace(joint, locks=4), again)
