"""The chain of bearing pairs, in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from joints import sawn

from sidmacib.joint import UpperBody
from sidmacib.joint.loading import Push
from sidmacib.rule.pairs import Pairs, bearing_pairs, pairs_of

LAGS = st.floats(1e-6, 1e3)
COUNTS = st.integers(1, 40)


@given(COUNTS, st.floats(1e-3, 1e3), st.floats(0.0, 1.0))
def test_the_closed_form_solves_the_row_of_springs(count: int, lag: float, direct: float) -> None:
    """Pairs of stiffness 1, links of 1 / lag."""
    matrix, load = np.eye(count), np.zeros(count)
    for j in range(count - 1):
        matrix[j : j + 2, j : j + 2] += np.array([[1, -1], [-1, 1]]) / lag
    load[0] = 1.0 - direct
    forces = np.linalg.solve(matrix, load)
    forces[0] += direct
    assert Pairs(count, lag, direct).working == pytest.approx(1.0 / forces.max(), rel=1e-6)


@given(COUNTS, LAGS, st.floats(0.0, 0.99))
def test_more_pairs_never_carry_less_up_to_a_limit(count: int, lag: float, direct: float) -> None:
    here, more = Pairs(count, lag, direct), Pairs(count + 1, lag, direct)
    assert here.working <= more.working * (1 + 1e-12) <= here.most * (1 + 1e-9)


def test_one_rigid_piece_has_as_many_working_locks_as_pairs() -> None:
    assert Pairs(7, 0.0).working == pytest.approx(7.0)
    assert math.isinf(Pairs(7, 0.0).most)
    row = Pairs(1, 0.3)  # forces fall by e over the transfer length
    assert math.exp(-1.0 / row.transfer_length) == pytest.approx(math.exp(-row.decay))
    assert 2.0 * math.cosh(row.decay) == pytest.approx(2.3)


def test_the_published_samples_have_the_working_locks_of_the_chain() -> None:
    """1.66 of two for five locks; the paper has W_sum rounded down, 2."""
    assert pairs_of(sawn(3)).working == 1.0
    assert pairs_of(sawn(5)).working == pytest.approx(1.658, abs=1e-3)
    assert pairs_of(sawn(15)).working == pytest.approx(2.014, abs=1e-3)
    assert pairs_of(sawn(15, upper_body=UpperBody.MONOLITHIC)).lag == 0.0


@pytest.mark.parametrize(("locks", "there", "back"), [(2, 1, 0), (3, 1, 1), (6, 3, 2), (9, 4, 4)])
def test_an_even_joint_has_one_pair_less_pushed_back(locks: int, there: int, back: int) -> None:
    joint = sawn(locks)
    assert [bearing_pairs(joint, push) for push in Push] == [there, back]
    assert pairs_of(joint, Push.MINUS_Y).working <= back


@pytest.mark.parametrize("values", [(-1, 1.0, 0.0), (1.5, 1.0, 0.0), (2, -1.0, 0.0), (2, 1.0, 1.1)])
def test_what_is_no_row_is_refused(values: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"count|lag|direct"):
        Pairs(*values)  # type: ignore[arg-type]
