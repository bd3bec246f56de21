"""Dry faces that are far stiffer than the inner ones."""

import math
from pathlib import Path

import pytest
from conftest import DISTINCT, run_guided

from sidmacib import CapacityError, FaceMaterial, NodeLayout
from sidmacib.engines import Numerics
from sidmacib.engines.results import read_outcome
from sidmacib.joint import FIXED_PLATE, Direction, HoldDown, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.equilibrium import compliance
from sidmacib.mechanics.static import Mode, static_first_failure, static_peak
from sidmacib.problem import Problem

SOFT = 1e8  # Pa/m, of inner faces


def problem(
    ratio: float,
    e_over_a: float,
    locks: int = 9,
    friction: float = 0.3,
    hold_down: HoldDown = FIXED_PLATE,
) -> Problem:
    """A joint whose dry faces are ``ratio`` times as stiff as the inner ones."""
    inner = FaceMaterial(SOFT, SOFT, 0.0, 8e4, 3.7e5)
    dry = FaceMaterial(ratio * SOFT, ratio * SOFT, friction, 0.0, 0.0)
    joint = Joint(locks, inner=inner, dry=dry, hold_down=hold_down)
    return posed(joint, Loading(Direction(e_over_a)), 0.025)


@pytest.mark.parametrize("ratio", [1e5, 1e8])
def test_beyond_some_stiffness_dry_faces_are_rigid(ratio: float) -> None:
    found = static_peak(*problem(ratio, 0.0))
    assert found.mode is Mode.BONDS
    assert found.peak.load == pytest.approx(394.24, rel=1e-4)


@pytest.mark.parametrize(("locks", "e_over_a"), [(3, math.inf), (9, 0.3)])
def test_the_first_failure_no_longer_depends_on_the_stiffness(locks: int, e_over_a: float) -> None:
    problems = (problem(ratio, e_over_a, locks) for ratio in (1e6, 3e7))
    loads = [static_first_failure(*each).point.load for each in problems]
    assert loads[1] == pytest.approx(loads[0], rel=1e-3)


@pytest.mark.parametrize(
    ("hold_down", "friction"), [(HoldDown.weight(), 0.6), (HoldDown.force(300.0), 0.0)]
)
def test_stiff_dry_faces_move_as_little_as_rigid_ones(hold_down: HoldDown, friction: float) -> None:
    found = [static_peak(*problem(ratio, 1.0, 4, friction, hold_down)) for ratio in (1e5, 1e7)]
    assert found[1].mode is found[0].mode
    assert found[1].first_failure_load == pytest.approx(found[0].first_failure_load, rel=1e-2)


def test_a_stiffness_that_rounding_would_decide_on_is_refused() -> None:
    words = r"1e\+09 times as stiff as the softest; with more than"
    with pytest.raises(CapacityError, match=words):
        static_peak(*problem(1e9, 0.0))


@pytest.mark.parametrize("ratio", [1e2, 1e5])
def test_the_reference_displacement_does_not_shrink_with_stiff_dry_faces(ratio: float) -> None:
    assert compliance(*problem(ratio, math.inf)) == compliance(*problem(1.0, math.inf))


@pytest.mark.engine
@pytest.mark.parametrize("name", DISTINCT)
@pytest.mark.parametrize("e_over_a", [0.0, math.inf])
def test_stiff_dry_faces_are_no_collapse(name: str, e_over_a: float, tmp_path: Path) -> None:
    dry = FaceMaterial(1e12, 1e12, 0.3, 0.0, 0.0)
    given = posed(Joint(3, dry=dry), Loading(Direction(e_over_a)), 0.02, NodeLayout.VERTICES)
    run_guided(name, given, Numerics(), tmp_path, 300.0)
    found = read_outcome(tmp_path, given.assembly)
    assert found.path[-1].load == pytest.approx(static_peak(*given).peak.load, rel=0.01)
