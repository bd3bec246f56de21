"""Weights of locks on faces whose nodes have unequal areas."""

from types import SimpleNamespace

import analysis.weights
import pandas as pd
import pytest
from analysis.weights import lock_weights

from sidmacib.joint import Joint


@pytest.fixture
def weight_of(monkeypatch: pytest.MonkeyPatch):
    """The row of lock 2, from the shares of its area and the shear stresses (over tau) there."""
    joint = Joint(3)
    monkeypatch.setattr(analysis.weights, "case_columns", lambda result: {})

    def of(shares: list[float], stress_x: list[float], stress_y: list[float]) -> pd.Series:
        nodes = pd.DataFrame(
            {
                "lock": 2,
                "area_m2": [share * joint.a * joint.b for share in shares],
                "shear_x_Pa": [joint.inner.cohesion * each for each in stress_x],
                "shear_y_Pa": [joint.inner.cohesion * each for each in stress_y],
            }
        )
        return lock_weights(SimpleNamespace(case=SimpleNamespace(joint=joint), nodes=nodes)).iloc[0]

    return of


def test_stress_on_the_larger_part_of_a_face_counts_for_more(weight_of) -> None:
    found = weight_of([0.75, 0.25], [0.0, 0.0], [1.0, 0.0])
    assert found["weight"] == pytest.approx(0.75)
    assert found["mean_shear_ratio"] == pytest.approx(0.75)
    assert found["max_shear_ratio"] == pytest.approx(1.0)


def test_opposite_stresses_cancel_in_the_resultant_and_not_in_the_mean(weight_of) -> None:
    found = weight_of([0.75, 0.25], [0.0, 0.0], [0.8, -0.8])
    assert found["weight"] == pytest.approx(0.4)
    assert found["mean_shear_ratio"] == pytest.approx(0.8)


def test_the_mean_is_of_the_stress_vectors_size(weight_of) -> None:
    found = weight_of([0.5, 0.3, 0.2], [0.3, 0.0, 0.6], [0.4, 1.0, 0.8])
    assert found["mean_shear_ratio"] == pytest.approx(0.5 * 0.5 + 0.3 * 1.0 + 0.2 * 1.0)
    assert found["shear_y_N"] == pytest.approx((0.5 * 0.4 + 0.3 * 1.0 + 0.2 * 0.8) * Joint(3).T0)
