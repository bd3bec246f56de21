"""Newton's steps of the jumps at nodes that are not wholly bonded: all that can open or slip.

At a wholly bonded node the contact law is linear, and there is no jump. The other nodes are open,
stick or slip, and a step treats them by that: the jumps of open ones, the gaps, which carry no
force, follow from all others; those of sticking ones are known; only slip is solved for.

Forces change by W times the jumps, with W symmetric and positive definite. If the jumps of the gaps
adapt, so that no force acts there, W is replaced by its principal pivot transform (Tucker, 1960):
with gaps g and the rest r

    R = W_rr - W_rg W_gg^-1 W_gr,    P = W_rg W_gg^-1,    H = W_gg^-1

From one step of Newton's method to the next, few gaps open or close. Then these matrices change by
products of narrow ones, which takes far less than to factorise W_gg anew. Where many do, it does
not, and they are computed from W.
"""

from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.linalg.blas import dgemm, dtrsm
from scipy.linalg.lapack import dpotrf, dpotri

from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.contact_law import Flags, NodeState
from sidmacib.mechanics.contact_law.kernels import NORMAL, SHEAR, forces_and_tangents

MOST_GROWTH = 1e4  # of P by new gaps: above it digits are lost, and the next update starts from W


def cholesky_factor(matrix: Floats) -> Floats:
    """Lower factor of a symmetric positive definite ``matrix``, which is overwritten.

    By LAPACK, without copies: matrices are large. About one of no rows, as where no gap is open,
    LAPACK prints an error of its own: it gets none.
    """
    if not len(matrix):
        return matrix
    # Its transpose is in LAPACK's order, so that nothing is copied.
    factor, failed = dpotrf(matrix.T, lower=1, overwrite_a=True)
    if failed:
        raise SolverError("stiffness of elastic blocks: not positive definite")
    return np.asarray(factor)


def inverse_by(factor: Floats) -> Floats:
    """Inverse of the matrix with this `cholesky_factor`, which is overwritten."""
    if not len(factor):
        return factor
    inverse, _ = dpotri(factor, lower=1, overwrite_c=True)
    for column in range(len(inverse)):
        inverse[column, column + 1 :] = inverse[column + 1 :, column]
    return np.asarray(inverse)


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
        size, count, opened = len(gaps), len(which), int(np.count_nonzero(gaps))
        rest = size - opened
        # Approximate numbers of multiplications of either way.
        by_exchange = size * count * (size + count)
        anew = opened * (rest**2 // 2 + rest * opened + opened**2 // 2)
        if not self.accurate or by_exchange > anew:
            self._factorise(gaps)
        elif len(which):
            self._exchange(which, gaps)
        self.gaps = gaps.copy()
        return self.matrix

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


@dataclass(frozen=True)
class LooseNodes:
    """Loose nodes and their components, (N,) and (M,), numbers in the solver's order.

    ``place``: of each component in an array of shape (N, 3), raveled. ``law``: see
    `sidmacib.mechanics.contact_law.kernels`, (4, N). ``rough``: whether a node has components of
    shear. ``open_gaps``: with the components' influence on each other.
    """

    nodes: Integers
    components: Integers
    place: Integers
    law: Floats
    rough: Flags
    state: NodeState
    open_gaps: OpenGaps

    def residual(self, elastic: Floats, jump: Floats) -> tuple[Floats, Floats, Floats]:
        """Forces by the contact law, their tangents, and balanced forces less those of the law.

        ``elastic``: forces (N) without jumps; ``jump`` in m; both of the components, (M,).
        """
        balanced = elastic - self.open_gaps.influence @ jump
        moved = np.zeros((len(self.nodes), 3))
        moved.ravel()[self.place] = balanced / self._springs() + jump
        force, tangent = forces_and_tangents(self.law, self.state.slip, self.state.whole, moved)
        return force, tangent, balanced - force.ravel()[self.place]

    def step(self, tangent: Floats, wrong: Floats, jump: Floats) -> Floats:
        """Newton step (m) of the jumps, (M,): wrong + J step = 0, J = -W - T (1 - W / k)."""
        normal, shear = self.law[NORMAL], self.law[SHEAR]
        opened, closed = tangent[:, 0, 0] == 0.0, tangent[:, 0, 0] == normal
        sticks = closed & ((tangent[:, 1, 1] == shear) | ~self.rough)
        node = self.place // 3
        gaps = opened[node]
        # Where the contact law has the full stiffness, the jump is that before.
        held = np.column_stack([closed, sticks, sticks]).ravel()[self.place]
        step = np.zeros_like(jump)
        step[held] = (self.state.jump.ravel()[self.place] - jump)[held]
        moving = np.flatnonzero(step)
        across = self.open_gaps.influence[moving].T @ step[moving]
        matrix, rest = self.open_gaps.opened(gaps), wrong - across
        # Changes of forces by these steps and those of the gaps that follow.
        by_gaps = matrix @ np.where(gaps, rest, 0.0)
        step[gaps] = -by_gaps[gaps]
        slides = ~(gaps | held)
        if slides.any():
            self._slide(step, slides, matrix, tangent, wrong, across + by_gaps)
            step[gaps] -= (matrix @ np.where(slides, step, 0.0))[gaps]
        return step

    def _slide(
        self,
        step: Floats,
        slides: Flags,
        matrix: Floats,
        tangent: Floats,
        wrong: Floats,
        across: Floats,
    ) -> None:
        """Put the steps of the components that slide into ``step``; ``across``: by the others."""
        nodes = np.unique(self.place[slides] // 3)
        # All nodes that slide have three components, one after the other.
        all_three = np.searchsorted(self.place, 3 * nodes)[:, None] + np.arange(3)
        rows, blocks = slides[all_three], tangent[nodes]
        relaxed = np.eye(3) - blocks / self._springs()[all_three][:, None, :]
        right = wrong[all_three] - _times(blocks, step[all_three])
        right -= _times(relaxed, across[all_three])
        inside = matrix[np.ix_(all_three.ravel(), np.flatnonzero(slides))]
        system = (relaxed @ inside.reshape(len(nodes), 3, -1))[rows]
        number = np.zeros(rows.shape, np.int64)
        number[rows] = np.arange(len(system))
        node, i, j = np.nonzero(rows[:, :, None] & rows[:, None, :])
        system[number[node, i], number[node, j]] += blocks[node, i, j]
        step[slides] = np.linalg.solve(system, right[rows])

    def _springs(self) -> Floats:
        """Stiffness of the components (N/m), (M,)."""
        return np.asarray(self.law[np.where(self.place % 3, SHEAR, NORMAL), self.place // 3])


def _times(blocks: Floats, vectors: Floats) -> Floats:
    return np.asarray((blocks @ vectors[:, :, None])[:, :, 0])
