"""The influence of jumps while gaps open and close: the same as solved anew."""

import numpy as np
import pytest

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.elastic.jumps import OpenGaps

SIZE = 24


def influence(size: int = SIZE) -> Floats:
    factor = np.random.default_rng(1).normal(size=(size, size))
    return np.asarray(factor @ factor.T) + np.eye(size)


def anew(matrix: Floats, gaps: Flags) -> Floats:
    """The transform by its definition: R, P and -H."""
    own = np.linalg.inv(matrix[np.ix_(gaps, gaps)])
    whole = np.empty_like(matrix)
    across = matrix[np.ix_(~gaps, gaps)]
    whole[np.ix_(gaps, gaps)] = -own
    whole[np.ix_(~gaps, gaps)] = across @ own
    whole[np.ix_(gaps, ~gaps)] = whole[np.ix_(~gaps, gaps)].T
    whole[np.ix_(~gaps, ~gaps)] = matrix[np.ix_(~gaps, ~gaps)] - across @ own @ across.T
    return whole


def test_gaps_that_open_and_close_are_as_solved_anew() -> None:
    matrix, random = influence(), np.random.default_rng(2)
    gaps = OpenGaps(matrix, np.zeros(SIZE))
    for share in (0.5, 0.6, 0.6, 0.4, 0.0, 0.7):
        which = random.random(SIZE) < share
        assert np.abs(gaps.opened(which) - anew(matrix, which)).max() < 1e-9


def test_more_components_come_last_and_closed() -> None:
    matrix, old = influence(), SIZE - 6
    which = np.arange(SIZE) % 3 == 0
    which[old:] = False
    gaps = OpenGaps(matrix[:old, :old], np.zeros(old))
    gaps.opened(which[:old])
    more = gaps.extended(matrix, np.zeros(SIZE))
    assert np.abs(more.opened(which) - anew(matrix, which)).max() < 1e-9
    which[-2:] = True
    assert np.abs(more.opened(which) - anew(matrix, which)).max() < 1e-9


def test_digits_that_a_loose_piece_costs_are_won_back() -> None:
    """Two components that only the floor holds together: open, then closed again."""
    matrix = np.array([[1.0, 1.0, 0.5], [1.0, 1.0, 0.5], [0.5, 0.5, 2.0]])
    gaps = OpenGaps(matrix, np.full(3, 1e-12))
    one, both = np.array([True, False, False]), np.array([True, True, False])
    gaps.opened(one)
    gaps.opened(both)
    found = gaps.opened(one)
    assert np.abs(found - anew(matrix + 1e-12 * np.eye(3), one)).max() < 1e-11


def test_no_gap_and_nothing_but_gaps_are_no_error_of_the_linear_algebra(
    capfd: pytest.CaptureFixture[str],
) -> None:
    """LAPACK prints its errors itself, about a matrix of no rows too."""
    matrix = influence()
    for first, then in ((True, False), (False, True)):
        gaps = OpenGaps(matrix, np.zeros(SIZE))
        for whole in (first, then):
            which = np.full(SIZE, whole)
            gaps.accurate = False  # so that it is computed from the start
            assert np.abs(gaps.opened(which) - anew(matrix, which)).max() < 1e-9
    assert capfd.readouterr() == ("", "")
