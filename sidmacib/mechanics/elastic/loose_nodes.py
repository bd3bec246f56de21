"""Newton's steps of the jumps at nodes that are not wholly bonded: all that can open or slip.

At a wholly bonded node the contact law is linear, and there is no jump. The other nodes are open,
stick or slip, and a step treats them by that: the jumps of open ones follow from all others, see
`sidmacib.mechanics.elastic.open_gaps`; those of sticking ones are known; only slip is solved for.
"""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.mechanics.contact_law import Flags, NodeState
from sidmacib.mechanics.contact_law.kernels import NORMAL, SHEAR, forces_and_tangents
from sidmacib.mechanics.elastic.open_gaps import OpenGaps


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
