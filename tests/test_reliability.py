"""Locks whose strengths scatter; characteristic and design resistance of a joint."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, lognorm

import sidmacib
from sidmacib import Reliability, characteristic, design_resistance
from sidmacib.joint import Direction, Hold, HoldDown, Joint, OwnLock
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.solution import Mode
from sidmacib.mechanics.static import first_failure_of, solver_of
from sidmacib.rule import COARSE, first_failure, weakened
from sidmacib.rule.reliability import Scatter, at_most_resists, scatter

PURE_SHEAR = Direction(0.0)


def strengths(variation: float, shape: tuple[int, ...]) -> np.ndarray:
    """Lognormal strengths of mean 1."""
    deviation = math.sqrt(math.log1p(variation**2))
    random = np.random.default_rng(7)
    return random.lognormal(-(deviation**2) / 2.0, deviation, shape)


@pytest.mark.parametrize("share", [0.001, 0.05, 0.5, 0.99])
@pytest.mark.parametrize("variation", [0.05, 0.3])
def test_one_lock_has_the_quantiles_of_its_strength(variation: float, share: float) -> None:
    scattered = Scatter(100.0, np.array([1.0]), variation)
    deviation = math.sqrt(math.log1p(variation**2))
    expected = 100.0 * lognorm.ppf(share, deviation, scale=math.exp(-(deviation**2) / 2.0))
    assert scattered.quantile(share) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("share", [0.05, 0.5])
def test_quantiles_are_those_of_many_joints(share: float) -> None:
    scattered = scatter(Joint(7), Direction(0.2), 0.2)
    drawn = (strengths(0.2, (40_000, 7)) / scattered.utilisation).min(axis=1) * scattered.load
    assert scattered.quantile(share) == pytest.approx(np.quantile(drawn, share), rel=5e-3)


@pytest.mark.parametrize(
    ("variation", "share", "name"),
    [*((0.2, share, "share") for share in (0.0, 1.0, -1.0)), (0.0, 0.5, "variation")],
)
def test_quantiles_of_nothing_are_refused(variation: float, share: float, name: str) -> None:
    with pytest.raises(ValueError, match=name):
        scatter(Joint(3), PURE_SHEAR, variation).quantile(share)


ECCENTRIC = Direction(0.3)
JOINT = Joint(5, a=0.08, H=0.06)
PRESSED = replace(JOINT, hold_down=HoldDown(Hold.PRESSURE, 4e4))


@pytest.mark.parametrize("joint", [JOINT, PRESSED], ids=["plate", "pressure"])
def test_five_of_a_hundred_drawn_joints_fail_below_the_characteristic_value(joint: Joint) -> None:
    """By the static model, of joints whose locks differ in strength."""
    count, failed, bond = 120, 0, joint.inner
    load = characteristic(joint, ECCENTRIC, 0.2).capacity.load
    for factors in strengths(0.2, (count, joint.locks)).tolist():
        own = {}
        for lock, factor in zip(joint.numbers, factors, strict=True):
            cohesion, tension = bond.cohesion * factor, bond.tensile_strength * factor
            own[lock] = OwnLock(inner=replace(bond, cohesion=cohesion, tensile_strength=tension))
        drawn = replace(joint, different=own)
        assembly, loads = posed(drawn, Loading(ECCENTRIC), joint.least_side / COARSE)
        failed += first_failure_of(solver_of(assembly, loads), loads.scale).point.load < load
    least, most = binom.interval(0.99, count, 0.05)
    assert least <= failed <= most


def test_with_forces_in_proportion_it_is_the_quantile_of_the_weakest_lock() -> None:
    weightless = replace(JOINT, density=0.0)
    found, whole = (f(weightless, ECCENTRIC, 0.2) for f in (characteristic, scatter))
    assert found.capacity.load == pytest.approx(whole.quantile(), rel=1e-3)
    weak = first_failure(weakened(weightless, found.margin), Loading(ECCENTRIC))
    assert found.capacity.load == weak.load


def test_more_scatter_gives_less() -> None:
    loads = [characteristic(JOINT, ECCENTRIC, v).capacity.load for v in (0.01, 0.1, 0.2, 0.4)]
    assert loads == sorted(loads, reverse=True)
    assert loads[0] == pytest.approx(sidmacib.law(JOINT, ECCENTRIC).load, rel=0.03)


def test_where_the_joint_slides_first_strengths_do_not_decide() -> None:
    smooth = replace(JOINT.dry, friction=0.0)
    loose = Joint(2, h=0.004, dry=smooth, hold_down=HoldDown(Hold.WEIGHT))
    law = sidmacib.law(loose, Direction(0.0))
    assert law.mode is Mode.ROCKING
    assert characteristic(loose, Direction(0.0), 0.05).capacity == law


def test_strengths_that_are_design_values_leave_the_safe_load() -> None:
    safe = sidmacib.safe(JOINT, ECCENTRIC)
    assert design_resistance(JOINT, ECCENTRIC, Reliability()) == safe


@pytest.mark.parametrize("joint", [JOINT, PRESSED], ids=["plate", "pressure"])
def test_the_factor_divides_resistance_or_strengths_whichever_gives_less(joint: Joint) -> None:
    found = design_resistance(joint, ECCENTRIC, Reliability(partial_factor=1.5)).load
    of_resistance = sidmacib.safe(joint, ECCENTRIC).load / 1.5
    of_strengths = sidmacib.safe(weakened(joint, 1.5), ECCENTRIC).load
    assert found == min(of_resistance, of_strengths)


def test_the_design_resistance_is_below_the_characteristic_value_over_the_factor() -> None:
    reliability = Reliability(0.2, 1.5)
    found = design_resistance(JOINT, ECCENTRIC, reliability).load
    whole = characteristic(JOINT, ECCENTRIC, 0.2).capacity.load
    assert 0.85 * whole / 1.5 < found <= whole / 1.5 / 1.05
    assert found <= at_most_resists(JOINT, ECCENTRIC, reliability)


@pytest.mark.parametrize("given", [(20.0, 1.0), (-0.1, 1.0), (float("nan"), 1.0), (0.2, 0.9)])
def test_what_is_no_scatter_or_no_partial_factor_is_refused(given: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="is not allowed; it must be"):
        Reliability(*given)
