"""The parameters of a joint: ranges, rows of their table, and what the library refuses."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from joints import sawn
from small import SMALL

from sidmacib import OPTIONS, ContactOption, Elastic, Sidmacib
from sidmacib.joint import INNER, Direction, HoldDown, Joint, OwnLock
from sidmacib.joint.parameters import PARAMETERS, SIZES, unit_warnings, with_parameters
from sidmacib.mechanics.assembly import FaceMaterial, Failure
from sidmacib.quantities import Length
from sidmacib.rule import law
from sidmacib.rule.spans import spans_of
from workflow.configuration import read_study
from workflow.consistency import notes

NO_NUMBERS = [math.nan, math.inf, -math.inf, "1", None, True]


BENDS = sawn(3, elastic=Elastic(1e10))
LENGTH, STIFFNESS, STRENGTH = "greater than 0 (m)", "greater than 0 (Pa/m)", "at least 0 (Pa)"
# The largest or smallest values of each parameter that are allowed, those that are not, and why.
RANGES = [
    ("locks", [1], [0, -3], "a whole number of at least 1"),
    *((name, [5e-324], [0.0, -0.06], LENGTH) for name in ("a", "b", "h", "H")),
    *((f"{face}_stiffness", [5e-324], [0.0, -1.0], STIFFNESS) for face in ("normal", "dry")),
    ("shear_stiffness", [5e-324], [0.0, -1.0], STIFFNESS),
    *((name, [0.0], [-1e-9], STRENGTH) for name in ("cohesion", "tensile_strength")),
    ("fracture_energy", [0.0], [-1e-9], "at least 0 (J/m2)"),
    *((name, [0.0], [-1e-9], "at least 0") for name in ("friction", "bond_friction")),
    ("density", [0.0], [-1.0], "at least 0 (kg/m3)"),
    ("young", [5e-324], [0.0], "greater than 0 (Pa)"),
    ("poisson", [0.0, 0.4999], [-0.1, 0.5, 0.7], "at least 0 and less than 0.5"),
]


# --- the parameters of a joint, in Python and as text --------------------------------------------
@pytest.mark.parametrize(("name", "inside", "outside", "allowed"), RANGES)
def test_a_number_is_held_to_its_range(
    name: str, inside: list[float], outside: list[float], allowed: str
) -> None:
    parameter = PARAMETERS[name]
    field = parameter.fields[0].rpartition(".")[2]
    for value in inside:
        assert parameter.of(with_parameters(BENDS, {name: value})) == value
        assert parameter.read(str(value)) == value
    for value in (*outside, *(NO_NUMBERS if name != "bond_friction" else NO_NUMBERS[:4])):
        with pytest.raises(ValueError, match=f"^{field}: .*; it must be .*{re.escape(allowed)}$"):
            with_parameters(BENDS, {name: value})
    for value in (*outside, "long", None, True, "nan", 10**400):
        with pytest.raises(ValueError, match=f"; it must be .*{re.escape(allowed)}$"):
            parameter.read(value)


def test_friction_of_bonds_is_that_of_the_face_unless_it_is_given() -> None:
    face = FaceMaterial(1e10, 1e10, 0.4, 8e4, 3.7e5)
    parameter = PARAMETERS["bond_friction"]
    assert parameter.of(Joint(3, inner=face)) == face.friction_in_bonds == 0.4
    assert parameter.of(Joint(3, inner=replace(face, bond_friction=0.1))) == 0.1
    assert replace(face, friction=0.2).friction_in_bonds == 0.2


def test_there_is_a_range_for_every_number_that_a_flag_sets() -> None:
    numbers = [name for name, parameter in PARAMETERS.items() if parameter.number]
    assert sorted(numbers) == sorted(name for name, *_ in RANGES)


@pytest.mark.parametrize("name", PARAMETERS)
def test_a_parameter_is_set_where_it_is_read_and_nothing_else_changes(name: str) -> None:
    other = {"upper_body": "monolithic", "failure": "ductile", "hold_down": {"force": 5.0}}
    value = PARAMETERS[name].read(other.get(name, 1 if name == "locks" else 0.25))
    joint = with_parameters(BENDS, {name: value})
    assert PARAMETERS[name].of(joint) == value
    assert with_parameters(joint, {name: PARAMETERS[name].of(BENDS)}) == BENDS
    every = PARAMETERS.values()
    changed = {each.name for each in every if each.of(joint) != each.of(BENDS)}
    assert changed == {name}


# --- anything else -------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("inner", None, "a FaceMaterial"),
        ("failure", "brittle", "Failure: BRITTLE, SOFTENING, DUCTILE"),
        ("upper_body", "monolithic", "UpperBody: COLUMNS, JOINED, MONOLITHIC"),
        ("first", "lower", "Side: UPPER, LOWER"),
        ("hold_down", "plate", "a HoldDown"),
        ("elastic", 1e10, "an Elastic or None"),
        ("different", {4: OwnLock()}, "the number of a lock, 1 to 3"),
        ("different", {True: OwnLock()}, "the number of a lock, 1 to 3"),
        ("different", {2: 0.06}, "an OwnLock"),
        ("different", ((2, OwnLock()), (2, OwnLock())), "one entry for each lock"),
    ],
)
def test_anything_else_of_a_joint_is_of_its_kind(name: str, value: object, allowed: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* must be {allowed}$"):
        sawn(3, **{name: value})


@pytest.mark.parametrize("value", [-0.1, *NO_NUMBERS])
def test_a_factor_on_a_strength_is_not_negative(joint: Joint, value: object) -> None:
    with pytest.raises(ValueError, match=r"^strength of lock 2: .* must be 0 or a finite number"):
        Sidmacib(joint, OPTIONS["option1"], strength=(1.0, value, 1.0))


@pytest.mark.parametrize(
    ("positions", "portions", "message"),
    [
        ((0.1,), (0.4, 0.6), "positions: must be one for each of the 2 portions"),
        ((), (), r"portions: \(\) is not allowed"),
        ((-0.6, 0.6), (0.5, 0.5), "positions: .* must be from -0.5 to 0.5"),
        ((math.nan, 0.1), (0.5, 0.5), "positions: .* must be from -0.5 to 0.5"),
        ((-0.1, 0.1), (0.5, 0.4), "portions: .* add up to 1"),
        ((-0.1, 0.1), (1.5, -0.5), "portions: .* add up to 1"),
        ((-0.1, 0.1), (math.nan, 0.5), "portions: .* add up to 1"),
    ],
)
def test_impossible_contact_points_are_refused(
    positions: tuple[float, ...], portions: tuple[float, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        ContactOption(positions, portions)


def test_whole_numbers_and_numpys_are_numbers() -> None:
    inner = replace(INNER, cohesion=80_000, tensile_strength=np.float32(4e5))
    joint = sawn(np.int64(3), a=1, b=np.float64(0.5), density=0, inner=inner)
    model = Sidmacib(joint, OPTIONS["option1"], strength=(1, np.float64(0.5), 0), overload=1000)
    assert pytest.approx(40_000.0) == model.joint.T0
    assert Direction(1).shear == pytest.approx(0.5**0.5)


PRESSED = with_parameters(sawn(5), {"young": 1e10, "hold_down": HoldDown.pressure(1e4)})
# The law has been tested with all of these words, and a first failure comes before any fracture
# energy is used up.
ALL_COVERED = {"upper_body", "failure", "fracture_energy"}


@pytest.mark.parametrize("name", sorted(PARAMETERS.keys() - ALL_COVERED - {"hold_down"}))
def test_a_parameter_is_in_a_span_of_the_rule_or_refused_by_it(name: str) -> None:
    before = PARAMETERS[name].of(PRESSED)
    other = with_parameters(PRESSED, {name: 2 * before if before else 0.1})
    if spans_of(other) == spans_of(PRESSED):
        with pytest.raises(ValueError, match=name):
            law(other, Direction(0.3))


def test_sizes_are_the_lengths_of_a_joint() -> None:
    assert [name for name, each in PARAMETERS.items() if each.kind == Length] == [*SIZES]


def test_a_slider_lies_within_the_range_of_its_parameter() -> None:
    for parameter in PARAMETERS.values():
        if parameter.slider and parameter.number:
            least, most, step, *unit = parameter.slider
            for value in (least or step, most):
                parameter.read(value * (unit[1] if unit else 1.0))


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("H", 60.0, "60 m is very large; is it in m?"),
        ("young", 10.0, "10 Pa is very small; is it in Pa?"),
        ("cohesion", 0.08, "0.08 Pa is very small; is it in Pa?"),
        ("friction", 30.0, "30 is very large; is it an angle in degrees? tan(30°) = 0.577"),
        ("friction", 3.0, "3 is very large; is it an angle in degrees? tan(3°) = 0.0524"),
        ("friction", 90.0, "90 is very large; a coefficient of friction is hardly ever above 1.2"),
        ("density", 1.4, "1.4 kg/m3 is very small; is it in kg/m3?"),
    ],
)
def test_another_unit_is_doubted(name: str, value: float, words: str) -> None:
    joint = with_parameters(BENDS, {name: value})
    assert list(unit_warnings(joint)) == [f"{name}: {words}"]


def test_friction_of_inner_faces_is_doubted_by_its_place() -> None:
    rough = sawn(5, inner=replace(INNER, friction=35.0))
    words = "inner faces: friction: 35 is very large; is it an angle in degrees? tan(35°) = 0.7"
    assert list(unit_warnings(rough)) == [words]


def test_what_has_an_effect_on_softening_bonds_only_is_doubted_of_others() -> None:
    def doubts(**values: object) -> list[str]:
        return [*unit_warnings(with_parameters(BENDS, values))]

    assert doubts(fracture_energy=50.0) == [
        "fracture_energy: no effect on brittle bonds; give failure: softening too"
    ]
    assert "without fracture_energy are brittle" in doubts(failure=Failure.SOFTENING)[0]
    assert not doubts(failure=Failure.SOFTENING, fracture_energy=50.0)


@given(st.floats(0.0, 1.2))
def test_a_friction_that_masonry_may_have_is_not_doubted(friction: float) -> None:
    assert list(unit_warnings(with_parameters(BENDS, {"friction": friction}))) == []


def test_a_study_says_which_sample_is_doubted() -> None:
    mine = {"locks": 3, "inner": {"cohesion": 0.08}}
    study = read_study(SMALL | {"samples": {"mine": mine}})
    assert notes(study) == ["mine: cohesion: 0.08 Pa is very small; is it in Pa?"]
