"""What brittle bonds carry behind the peak, against what is known of it."""

import numpy as np
import pytest

from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import FaceMaterial, Failure
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static import solver_of, static_peak
from sidmacib.mechanics.static.peaks import LEAST_LOAD_LEFT, after_peak
from sidmacib.problem import Problem

MESH = 0.03  # m
SMOOTH = FaceMaterial(1e10, 1e10, friction=0.0, cohesion=0.0, tensile_strength=0.0)


def smooth(locks: int, ratio: float = 0.0) -> Problem:
    return posed(Joint(locks, dry=SMOOTH), Loading(Direction(ratio)), MESH)


def followed(problem: Problem) -> tuple[Equilibrium, list[Equilibrium]]:
    peak = static_peak(*problem).peak
    return peak, [*after_peak(*problem, peak)]


def test_nothing_is_left_of_a_joint_with_one_lower_lock_in_pure_shear() -> None:
    _, points = followed(smooth(3))
    assert points == []


@pytest.mark.parametrize("locks", [5, 7])
def test_one_lower_lock_after_the_other_fails_in_pure_shear(locks: int) -> None:
    peak, points = followed(smooth(locks))
    assert len(points) == (locks - 1) / 2 - 1
    # The last one carries the whole load alone: its strength.
    assert points[-1].load == pytest.approx(Joint(locks).T0, rel=2e-3)
    assert peak.load > points[0].load


def test_each_point_is_at_the_strength_of_a_bond_and_has_fewer_of_them() -> None:
    problem = smooth(5, 0.5)
    law = solver_of(*problem).contact_law
    peak, points = followed(problem)
    assert len(points) > 3
    bonded = int(peak.state.bonded.sum())
    for point in points:
        assert utilisation(law, point.state, point.force).max() == pytest.approx(1.0, abs=1e-2)
        assert int(point.state.bonded.sum()) < bonded
        assert point.load >= LEAST_LOAD_LEFT * peak.load
        bonded = int(point.state.bonded.sum())


def test_ductile_bonds_are_not_followed() -> None:
    problem = posed(Joint(5, failure=Failure.DUCTILE), Loading(Direction(0.0)), MESH)
    assert followed(problem)[1] == []


def test_every_point_is_the_same_again() -> None:
    one, other = (np.array([point.load for point in followed(smooth(5, 0.5))[1]]) for _ in range(2))
    assert np.array_equal(one, other)
