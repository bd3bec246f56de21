"""Locks whose strengths scatter."""

import math

import numpy as np
import pytest
from scipy.stats import lognorm

from sidmacib.joint import Direction, Joint
from sidmacib.rule.reliability import Scatter, scatter

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


def test_survival_falls_from_certain_to_none() -> None:
    scattered = scatter(Joint(5), PURE_SHEAR, 0.15)
    chances = [scattered.survival(scattered.load * factor) for factor in (0.0, 0.4, 0.8, 1.0, 3.0)]
    assert chances[0] == 1.0
    assert chances == sorted(chances, reverse=True)
    assert chances[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("share", [0.0, 1.0, -1.0])
def test_shares_that_are_none_are_refused(share: float) -> None:
    with pytest.raises(ValueError, match="share"):
        scatter(Joint(3), PURE_SHEAR, 0.2).quantile(share)


def test_a_variation_must_be_positive() -> None:
    with pytest.raises(ValueError, match="variation"):
        scatter(Joint(3), PURE_SHEAR, 0.0)
