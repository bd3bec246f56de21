"""Errors of a model's loads: unsafe where it promises too much, safe where too little."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.tables import misfit

REFERENCE = np.array([100.0, 200.0, 400.0])


def test_loads_that_are_all_below_the_reference_have_no_unsafe_error() -> None:
    found = misfit(REFERENCE * [0.9, 0.7, 1.0], REFERENCE)
    assert found.largest_unsafe_error == 0.0
    assert found.largest_safe_error == pytest.approx(0.3)


def test_loads_that_are_all_above_the_reference_have_no_safe_error() -> None:
    found = misfit(REFERENCE * [1.1, 1.4, 1.0], REFERENCE)
    assert found.largest_unsafe_error == pytest.approx(0.4)
    assert found.largest_safe_error == 0.0


def test_the_larger_of_the_two_errors_does_not_hide_the_other() -> None:
    found = misfit(REFERENCE * [1.1, 0.6, 1.0], REFERENCE)
    assert found.largest_unsafe_error == pytest.approx(0.1)
    assert found.largest_safe_error == pytest.approx(0.4)


@given(st.floats(-0.9, 3.0))
def test_the_same_relative_error_everywhere_is_the_misfit(error: float) -> None:
    assert misfit(REFERENCE * (1 + error), REFERENCE).misfit == pytest.approx(abs(error), abs=1e-12)
