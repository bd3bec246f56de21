"""First failures where the utilisation stays near 1 over a range of loads, and the safe load there.

Coarse increments passed through such a range without seeing the failure, and agreed with increments
of twice the size.
"""

from dataclasses import fields, replace

import numpy as np
import pytest

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, HoldDown, Joint, Side, UpperBody
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import Elastic, FaceMaterial
from sidmacib.mechanics.solution import Mode
from sidmacib.mechanics.static import static_first_failure
from sidmacib.rule import law, safe
from sidmacib.rule.reliability import scatter
from studies.attack.search import DIMENSIONS, SPACES, Space, target_at

BY_WEIGHT = Joint(
    *(4, 0.03664, 0.05, 0.0115, 0.015),
    density=307728,
    inner=FaceMaterial(1e10, 3e10, 0, 8e4, 2.2219e5),
    dry=FaceMaterial(3e11, 1.5576e12, 0.28547, 0, 0),
    first=Side.LOWER,
    hold_down=HoldDown.weight(),
)
BY_FORCE = Joint(
    *(8, 0.0709, 0.05, 0.00722, 0.0205),
    density=210,
    inner=FaceMaterial(1e10, 3e10, 0, 8e4, 2.37e5),
    dry=FaceMaterial(3e11, 1.665e12, 0.3727, 0, 0),
    first=Side.LOWER,
    hold_down=HoldDown.force(2453),
)
FOUND = [(BY_WEIGHT, 2.2374), (BY_FORCE, 5.268)]


def first_failures(joint: Joint, loading: Loading, cells: int) -> tuple[float, float]:
    """As the model chooses its increments, and with increments of 0.002 T0, in N."""
    problem = posed(joint, loading, joint.least_side / cells)
    found = static_first_failure(*problem), static_first_failure(*problem, increment=0.002)
    return found[0].point.load, found[1].point.load


@pytest.mark.parametrize(("joint", "eccentricity"), FOUND)
@pytest.mark.parametrize("cells", [2, 3])
def test_no_first_failure_is_stepped_over(joint: Joint, eccentricity: float, cells: int) -> None:
    load, fine = first_failures(joint, Loading(Direction(eccentricity)), cells)
    assert load == pytest.approx(fine, rel=5e-3)


@pytest.mark.parametrize("space", SPACES[1:4], ids=lambda space: space.name)
def test_first_failures_of_random_joints_do_not_depend_on_increments(space: Space) -> None:
    random, answered = np.random.default_rng(20), 0
    while answered < 6:
        target = target_at(space, list(random.random(DIMENSIONS)))
        if target.joint.locks > 10:
            continue
        try:
            load, fine = first_failures(target.joint, target.loading, 2)
        except CapacityError:
            continue
        answered += 1
        assert load == pytest.approx(fine, rel=5e-3)


@pytest.mark.parametrize(("joint", "eccentricity"), FOUND)
def test_the_safe_load_is_below_the_first_failure_on_a_plateau(
    joint: Joint, eccentricity: float
) -> None:
    """A margin on the load alone made it 41.2 for 29.5 N, and 105.8 for 98.4 N."""
    direction = Direction(eccentricity)
    load, fine = first_failures(joint, Loading(direction), 5)
    assert safe(joint, direction).load < min(load, fine)


def test_a_joint_that_rocks_first_has_the_load_at_which_it_does_and_no_scatter() -> None:
    """Two strong, smooth locks held down by their weight: strengths do not decide."""
    inner, dry = FaceMaterial(1e10, 1e10, 0, 1e7, 1e8), FaceMaterial(1e10, 1e10, 0, 0, 0)
    joint = Joint(2, H=0.1, density=200, inner=inner, dry=dry, hold_down=HoldDown.weight())
    direction = Direction(0.0)
    found = law(joint, direction)
    assert found.mode is Mode.ROCKING
    assert found.moves == "rocks before a bond fails"
    stronger = replace(joint, inner=replace(inner, cohesion=2e7, tensile_strength=2e8))
    assert law(stronger, direction).load == pytest.approx(found.load, rel=1e-3)
    with pytest.raises(CapacityError, match="before a bond fails; their strengths do not decide"):
        scatter(joint, direction, 0.2)


def test_every_number_of_a_joint_is_in_a_range_of_the_rule_or_refused_or_without_influence() -> (
    None
):
    """A new field must join one of these: the rule was not attacked with it."""
    ranges = {"locks", "a", "b", "h", "H", "density", "inner", "dry", "hold_down", "elastic"}
    refused = {"different", "upper_body"}  # the latter only where columns are joined
    varied = {"first"}  # by the attack, as the body is
    without = {"failure"}  # on first failures
    assert {each.name for each in fields(Joint)} == ranges | refused | varied | without
    of_faces = {"normal_stiffness", "shear_stiffness", "friction", "cohesion", "tensile_strength"}
    softening = {"residual", "fracture_energy"}  # behind the first failure
    assert {each.name for each in fields(FaceMaterial)} == of_faces | softening | {"bond_friction"}
    assert {each.name for each in fields(Elastic)} == {"young", "poisson"}
    assert {each.name for each in fields(HoldDown)} == {"kind", "amount"}


def test_a_path_of_two_increments_does_not_agree_with_itself_by_chance() -> None:
    """A search found it: 168.5 N on the coarsest two paths, 160.2 N on fine ones."""
    joint = Joint(
        2,
        a=0.242729,
        b=0.05,
        h=0.0391252,
        H=0.159497,
        density=3830.22,
        inner=FaceMaterial(1e10, 4.31253e8, 0.0, 8e4 / 1.06, 48381.5 / 1.06),
        dry=FaceMaterial(5.20322e7, 1.85253e8, 0.305595, 0.0, 0.0),
        upper_body=UpperBody.MONOLITHIC,
        hold_down=HoldDown.pressure(4439.52),
    )
    problem = posed(joint, Loading(Direction(0.696345)), joint.least_side / 4)
    assert static_first_failure(*problem).point.load == pytest.approx(160.2, rel=5e-3)
