"""How many specimens a laboratory needs to decide between two models."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from studies.measured.specimens import LEAST, POWER, SIGNIFICANCE, specimens


def test_so_many_specimens_find_a_difference_as_often_as_asked() -> None:
    """By simulation: samples of the difference, tested with its known deviation."""
    difference, deviation = 0.1, 0.2
    count = specimens(difference, deviation)
    means = np.random.default_rng(3).normal(difference, deviation / math.sqrt(count), 20_000)
    found = np.abs(means) > norm.isf(SIGNIFICANCE / 2) * deviation / math.sqrt(count)
    assert found.mean() == pytest.approx(POWER, abs=0.015)


def test_a_large_difference_still_takes_a_few() -> None:
    assert specimens(1.0, 0.1) == LEAST


def test_no_difference_is_refused() -> None:
    with pytest.raises(ValueError, match="no number of them"):
        specimens(0.0, 0.2)
