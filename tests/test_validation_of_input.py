"""What the library is given: one line for what is impossible, before anything is computed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sidmacib.contact_points.options import OPTIONS, ContactOption
from sidmacib.contact_points.programme import Sidmacib
from sidmacib.hold_down import Hold, HoldDown
from sidmacib.joint import DRY, INNER, Direction, Joint, OwnLock
from sidmacib.loading import Loading
from sidmacib.mechanics.assembly import Elastic
from sidmacib.pieces import assemble

NO_NUMBERS = [math.nan, math.inf, -math.inf, "1", None, True]


@pytest.mark.parametrize("name", ["a", "b", "h", "H"])
@pytest.mark.parametrize("value", [0.0, -0.06, *NO_NUMBERS])
def test_a_size_is_above_0(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* must be a finite number above 0$"):
        Joint(3, **{name: value})


@pytest.mark.parametrize("value", [-1.0, *NO_NUMBERS])
def test_a_density_is_not_negative(value: object) -> None:
    with pytest.raises(ValueError, match=r"^density: .* must be 0 or a finite number above it$"):
        Joint(3, density=value)


@pytest.mark.parametrize("value", [0, -3, 3.0, "3", True, math.nan])
def test_there_is_at_least_one_lock(value: object) -> None:
    with pytest.raises(ValueError, match=r"^locks: .* must be a whole number of at least 1$"):
        Joint(value)


@pytest.mark.parametrize("name", ["normal_stiffness", "shear_stiffness"])
@pytest.mark.parametrize("value", [0.0, -1.0, *NO_NUMBERS])
def test_a_stiffness_is_above_0(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* must be a finite number above 0$"):
        replace(INNER, **{name: value})


@pytest.mark.parametrize("name", ["friction", "cohesion", "tensile_strength"])
@pytest.mark.parametrize("value", [-1e-9, *NO_NUMBERS])
def test_friction_and_strengths_are_not_negative(name: str, value: object) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* must be 0 or a finite number above it$"):
        replace(DRY, **{name: value})


@pytest.mark.parametrize("value", [1.0000001, 2.0])
def test_what_is_left_of_a_strength_is_a_part_of_it(value: float) -> None:
    assert replace(INNER, residual=1.0).residual == 1.0
    with pytest.raises(ValueError, match=r"^residual: .* must be from 0 to 1$"):
        replace(INNER, residual=value)


@pytest.mark.parametrize("value", [0.5, 0.7])
def test_a_piece_can_be_compressed(value: float) -> None:
    assert Elastic(1e10, 0.4999).poisson == 0.4999
    with pytest.raises(ValueError, match=r"^poisson: .* must be from 0 to less than 0.5$"):
        Elastic(1e10, value)


@pytest.mark.parametrize("value", [0.0, -0.01, math.nan])
def test_a_mesh_is_above_0(value: float) -> None:
    assembly = assemble(Joint(2), 0.03)
    with pytest.raises(ValueError, match=r"^mesh: .* must be more than 0$"):
        replace(assembly, mesh=value)


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("inner", None, "a FaceMaterial"),
        ("failure", "brittle", "Failure: BRITTLE, SOFTENING, DUCTILE"),
        ("upper_body", "monolithic", "UpperBody: COLUMNS, JOINED, MONOLITHIC"),
        ("first", "lower", "Block: UPPER, LOWER"),
        ("hold_down", "plate", "a HoldDown"),
        ("elastic", 1e10, "an Elastic, or None for rigid pieces"),
        ("different", {4: OwnLock()}, "the number of a lock, 1 to 3"),
        ("different", {True: OwnLock()}, "the number of a lock, 1 to 3"),
        ("different", {2: 0.06}, "an OwnLock"),
        ("different", ((2, OwnLock()), (2, OwnLock())), "one entry for each lock"),
    ],
)
def test_anything_else_of_a_joint_is_of_its_kind(name: str, value: object, allowed: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: .* must be {allowed}$"):
        Joint(3, **{name: value})


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"width": 0.0}, "width: 0.0 is not possible; it must be a finite number above 0"),
        ({"density": -1.0}, "density: -1.0 is not possible; it must be 0 or a finite number .*"),
        ({"inner": 8e4}, "inner: 80000.0 is not possible; it must be a FaceMaterial"),
    ],
)
def test_what_a_lock_has_of_its_own_is_of_its_kind(given: dict, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        OwnLock(**given)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("plate",), "hold_down: 'plate' .* must be Hold: PLATE, FORCE, PRESSURE, WEIGHT"),
        ((Hold.FORCE, -1.0), "hold_down force: -1.0 .* must be 0 or a finite number above it"),
        ((Hold.WEIGHT, 5.0), "hold_down weight: 5.0 .* must be 0: it has no amount"),
    ],
)
def test_a_hold_down_is_of_its_kind(given: tuple, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        HoldDown(*given)


@pytest.mark.parametrize("value", [math.nan, "0.5", None, True])
def test_an_eccentricity_is_a_number(value: object) -> None:
    with pytest.raises(ValueError, match=r"^eccentricity: .* must be a number"):
        Direction(value)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"direction": 0.5}, "direction: 0.5 is not possible; it must be a Direction"),
        ({"direction": Direction(0.5), "push": "+y"}, "push: .* must be Push: PLUS_Y, MINUS_Y"),
        ({"direction": Direction(0.5), "share": None}, "share: .* must be LoadShare: FACE, BODY"),
    ],
)
def test_anything_of_a_loading_is_of_its_kind(given: dict, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        Loading(**given)


@pytest.mark.parametrize("value", [-1000.0, *NO_NUMBERS])
def test_an_overload_is_not_negative(joint: Joint, value: object) -> None:
    with pytest.raises(ValueError, match=r"^overload: .* must be 0 or a finite number above it$"):
        Sidmacib(joint, OPTIONS["option1"], overload=value)


@pytest.mark.parametrize("value", [-0.1, *NO_NUMBERS])
def test_a_factor_on_a_strength_is_not_negative(joint: Joint, value: object) -> None:
    with pytest.raises(ValueError, match=r"^strength of lock 2: .* must be 0 or a finite number"):
        Sidmacib(joint, OPTIONS["option1"], strength=(1.0, value, 1.0))


def test_there_is_one_factor_on_the_strength_of_each_lock(joint: Joint) -> None:
    with pytest.raises(ValueError, match=r"^strength: 2 factors .* each of the 3 locks$"):
        Sidmacib(joint, OPTIONS["option1"], strength=(1.0, 1.0))


def test_friction_in_sidmacib_is_a_choice_and_no_coefficient(joint: Joint) -> None:
    with pytest.raises(ValueError, match=r"^friction: 0.3 is not possible; .* true or false$"):
        Sidmacib(joint, OPTIONS["option1"], friction=0.3)


@pytest.mark.parametrize(
    ("positions", "portions", "message"),
    [
        ((0.1,), (0.4, 0.6), "positions: must be one for each of the 2 portions"),
        ((), (), r"portions: \(\) is not possible"),
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
    joint = Joint(np.int64(3), a=1, b=np.float64(0.5), density=0, inner=inner)
    model = Sidmacib(joint, OPTIONS["option1"], strength=(1, np.float64(0.5), 0), overload=1000)
    assert pytest.approx(40_000.0) == model.joint.T0
    assert Direction(1).shear == pytest.approx(0.5**0.5)


def test_a_message_shows_a_numpy_number_as_a_number() -> None:
    with pytest.raises(ValueError, match=r"^a: -0.5 is not possible"):
        Joint(3, a=np.float64(-0.5))
