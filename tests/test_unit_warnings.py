"""Numbers that look as if they were in another unit."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.joint import Joint
from sidmacib.joint.parameters import unit_warnings
from sidmacib.mechanics.assembly import Elastic
from workflow.configuration import read_study
from workflow.consistency import notes


def test_the_published_joint_raises_no_doubt() -> None:
    assert list(unit_warnings(Joint(5, elastic=Elastic(1e10)))) == []


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (Joint(5, H=60.0), "H: 60 m is very large; is it in m?"),
        (Joint(5, elastic=Elastic(10.0)), "young: 10 Pa is very small; is it in Pa?"),
        (
            Joint(5, inner=replace(Joint(5).inner, cohesion=0.08)),
            "cohesion: 0.08 Pa is very small; is it in Pa?",
        ),
        (
            Joint(5, dry=replace(Joint(5).dry, friction=30.0)),
            "friction: 30 is very large; is it an angle in degrees? tan(30°) = 0.577",
        ),
        (
            Joint(5, dry=replace(Joint(5).dry, friction=3.0)),
            "friction: 3 is very large; is it an angle in degrees? tan(3°) = 0.0524",
        ),
        (
            Joint(5, dry=replace(Joint(5).dry, friction=90.0)),
            "friction: 90 is very large; a coefficient of friction is hardly ever above 1.2",
        ),
        (
            Joint(5, inner=replace(Joint(5).inner, friction=35.0)),
            "inner faces: friction: 35 is very large; is it an angle in degrees? tan(35°) = 0.7",
        ),
        (Joint(5, density=1.4), "density: 1.4 kg/m3 is very small; is it in kg/m3?"),
    ],
)
def test_another_unit_is_doubted(joint: Joint, words: str) -> None:
    assert list(unit_warnings(joint)) == [words]


@given(st.floats(0.0, 1.2))
def test_a_friction_that_masonry_may_have_is_not_doubted(friction: float) -> None:
    assert list(unit_warnings(Joint(5, dry=replace(Joint(5).dry, friction=friction)))) == []


def test_a_study_says_which_sample_is_doubted() -> None:
    study = read_study(
        {
            "samples": {"mine": {"locks": 3, "inner": {"cohesion": 0.08}}},
            "dem": {"engines": []},
            "models": ["static"],
        }
    )
    assert notes(study) == ["mine: cohesion: 0.08 Pa is very small; is it in Pa?"]
