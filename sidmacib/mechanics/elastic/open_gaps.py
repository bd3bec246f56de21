"""Effect of jumps on node forces while some components are gaps, which carry no force.

Forces change by W times the jumps, with W symmetric and positive definite. If the jumps of the gaps
adapt, so that no force acts there, W is replaced by its principal pivot transform (Tucker, 1960):
with gaps g and the rest r

    R = W_rr - W_rg W_gg^-1 W_gr,    P = W_rg W_gg^-1,    H = W_gg^-1

From one step of Newton's method to the next, few gaps open or close. Then these matrices change by
products of narrow ones, which takes far less than to factorise W_gg anew. Where many do, it does
not, and they are computed from W.
"""

from copy import copy

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.linalg.blas import dgemm, dtrsm

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.elastic.symmetric import cholesky_factor, inverse_by

MOST_GROWTH = 1e4  # of P by new gaps: above it digits are lost, and the next update starts from W


class OpenGaps:
    """The transform of ``influence``, W in N/m, (M, M), with ``floor``, (M,), on its diagonal.

    The floor keeps W positive definite where gaps let pieces fly off.
    """

    def __init__(self, influence: Floats, floor: Floats) -> None:
        self.influence, self.floor = influence, floor
        self.gaps = np.zeros(len(floor), bool)
        self.matrix, self.accurate = np.array(influence, order="F"), True
        self.matrix[np.diag_indices_from(self.matrix)] += floor

    def opened(self, gaps: Flags) -> Floats:
        """R, P and -H in one symmetric matrix, (M, M), for these ``gaps``, (M,)."""
        which = np.flatnonzero(gaps != self.gaps)
        if not self.accurate or self._exchange_work(len(which)) > self._factorise_work(gaps):
            self._factorise(gaps)
        elif len(which):
            self._exchange(which, gaps)
        self.gaps = gaps.copy()
        return self.matrix

    def _exchange_work(self, count: int) -> int:
        """Approximate number of multiplications in `_exchange` of so many components."""
        size = len(self.floor)
        return size * count * (size + count)

    def _factorise_work(self, gaps: Flags) -> int:
        """The same of `_factorise`."""
        count = int(np.count_nonzero(gaps))
        rest = len(gaps) - count
        return count * (rest**2 // 2 + rest * count + count**2 // 2)

    def extended(self, influence: Floats, floor: Floats) -> "OpenGaps":
        """The same gaps among more components, which come last: all are closed."""
        old, gaps = len(self.floor), self.gaps
        across = influence[old:, :old]
        by_gaps = across[:, gaps] @ self.matrix[:, gaps].T  # symmetric, and columns are together
        matrix = np.empty(influence.shape, order="F")
        matrix[:old, :old] = self.matrix
        matrix[old:, :old] = np.where(gaps, 0.0, across) - by_gaps
        matrix[:old, old:] = matrix[old:, :old].T
        own = influence[old:, old:] + by_gaps[:, gaps] @ across[:, gaps].T
        own[np.diag_indices_from(own)] += floor[old:]
        matrix[old:, old:] = own
        other = copy(self)
        other.influence, other.floor, other.matrix = influence, floor, matrix
        other.gaps = np.concatenate([gaps, np.zeros(len(floor) - old, bool)])
        return other

    def _factorise(self, gaps: Flags) -> None:
        """Compute the matrices for these ``gaps`` from W, by Cholesky's method."""
        opened, rest = np.flatnonzero(gaps), np.flatnonzero(~gaps)
        own, kept = self._among(opened), self._among(rest)
        across = self.influence[np.ix_(rest, opened)].T
        factor = cholesky_factor(own)
        half = dtrsm(1.0, factor, across, lower=1, overwrite_b=True)
        kept -= half.T @ half
        ratio = dtrsm(1.0, factor, half, lower=1, trans_a=1, overwrite_b=True)
        self.matrix[np.ix_(rest, rest)] = kept
        self.matrix[np.ix_(opened, opened)] = -inverse_by(factor)
        self.matrix[np.ix_(opened, rest)], self.matrix[np.ix_(rest, opened)] = ratio, ratio.T
        self.accurate = True

    def _among(self, which: Integers) -> Floats:
        """W of ``which`` components among themselves."""
        matrix = self.influence[np.ix_(which, which)]
        matrix[np.diag_indices_from(matrix)] += self.floor[which]
        return np.asarray(matrix)

    def _exchange(self, which: Integers, gaps: Flags) -> None:
        """Open or close ``which`` components, as ``gaps`` says."""
        sign = np.where(gaps[which], 1.0, -1.0)
        across = self.matrix[:, which]
        factor = lu_factor(across[which], check_finite=False)
        ratio = np.asfortranarray(lu_solve(factor, across.T, check_finite=False).T)
        dgemm(-1.0, ratio, across, 1.0, self.matrix, trans_b=True, overwrite_c=True)
        own = sign[:, None] * lu_solve(factor, np.diag(sign), check_finite=False)
        ratio *= sign
        self.matrix[:, which], self.matrix[which] = ratio, ratio.T
        self.matrix[np.ix_(which, which)] = -(own + own.T) / 2
        growth = float(np.abs(ratio[:, sign > 0.0]).max(initial=0.0))
        self.accurate = self.accurate and growth <= MOST_GROWTH
