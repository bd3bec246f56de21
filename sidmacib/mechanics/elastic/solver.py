"""Equilibrium of elastic pieces on contact nodes, in terms of the jumps at the nodes.

A node's displacement delta (below minus above) is that of the pieces' rigid motions q and of their
deformation by node forces f and loads. It consists of an elastic part f / k, with the node's
stiffness k, and a jump s, the opening and slip:

    f / k + s = G q - D f + d,    G' f = loads

While all nodes are closed and bonded there are no jumps. Solved once, these equations give
f = f0 - W s for all jumps s and loads; W contains the pieces' finite elements and is computed once
for an assembly. Newton's method looks for the jumps at which each node's force obeys the contact
law; only nodes that are open or slip have unknowns. Node forces always balance the loads.
"""

import math

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve, lapack, lu_factor, lu_solve

from sidmacib.errors import NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Loads
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.elastic.flexibility import flexibility
from sidmacib.mechanics.elastic.memory import memory_needed, require_memory
from sidmacib.mechanics.equilibrium import free_rows, row_units
from sidmacib.mechanics.equilibrium_matrix import equilibrium_matrix
from sidmacib.mechanics.newton import forces_and_tangents
from sidmacib.mechanics.solution import Equilibrium, lifted_part

STEPS = 60  # of Newton's method, at most
PATIENCE = 16  # steps in which the residual must at least halve
SHARES = (1.0, 0.5, 0.25, 0.125, 1.0)  # fractions of a Newton step that are tried
RESIDUAL = 1e-9  # of the contact law, over the loads
FLOOR = 1e-9  # of a node's stiffness: added where it is open
LOOSE = 1e-13  # of the stiffness against rigid motions: added for pieces that nothing holds
LARGEST_STEP = 1e5  # Newton step over the displacements of the unbroken assembly


class ElasticSolver:
    """Newton's method on the jumps at the nodes of ``assembly``, with elastic pieces."""

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        self.contact_law = ContactLaw.of(assembly)
        normal, shear = self.contact_law.normal_stiffness, self.contact_law.shear_stiffness
        self.node_stiffness = np.column_stack([normal, shear])
        # No unknowns for shear at nodes that never carry any.
        self.rough = self.contact_law.cohesive | (self.contact_law.friction > 0.0)
        normals = np.ones_like(self.rough)
        self.kept = np.flatnonzero(np.column_stack([normals, self.rough, self.rough]).ravel())
        self.stiffness = np.column_stack([normal, shear, shear]).ravel()[self.kept]
        self.node = self.kept // 3
        what = f"elastic pieces with {len(self.kept):,} components of forces at contact nodes"
        require_memory(memory_needed(assembly, self.kept), what)
        give, moved, self.work = flexibility(assembly, loads, self.kept)
        rows = free_rows(assembly)
        size = row_units(assembly)
        rigid = (equilibrium_matrix(assembly).toarray()[rows][:, self.kept] / size[:, None]).T
        give[np.diag_indices_from(give)] += 1.0 / self.stiffness
        inverse, _ = lapack.dpotri(cho_factor(give, lower=True, check_finite=False)[0], lower=1)
        inverse = np.tril(inverse) + np.tril(inverse, -1).T
        held = inverse @ rigid
        whole = rigid.T @ held
        whole[np.diag_indices_from(whole)] += LOOSE * float(whole.diagonal().max())
        factor = cho_factor(whole)
        self.influence = inverse - held @ cho_solve(factor, held.T)
        balance = [each.ravel()[rows] / size for each in (loads.permanent, loads.variable)]
        forces = np.column_stack(
            [
                self.influence @ displacement + held @ cho_solve(factor, load)
                for displacement, load in zip(moved, balance, strict=True)
            ]
        )
        motions = cho_solve(factor, np.column_stack(balance) - held.T @ np.column_stack(moved))
        self.forces, self.moved, self.motions = forces, moved, motions
        self.factor, self.held = factor, held
        self.weight, self.variable = balance
        self.gaps: tuple[Integers, tuple[Floats, bool]] | None = None
        elastic = np.abs(self.forces / self.stiffness[:, None]).max(axis=0)
        self.largest_step = LARGEST_STEP * float(elastic[0] + loads.scale * elastic[1])

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        return self.solve(0.0, np.zeros(len(self.kept)), NodeState.initial(self.contact_law))

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the jumps and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method finds none and, if ``thorough``, none from
        the equilibrium without friction either: from there it also converges where all dry nodes
        begin without any force.
        """
        friction = self.contact_law.friction
        found = self._newton(load, guess, state, friction)
        if found is None and thorough:
            smooth = self._newton(load, guess, state, np.zeros_like(friction))
            if smooth is not None:
                found = self._newton(load, smooth.unknowns, state, friction)
        if found is None:
            raise NoEquilibriumError(f"no equilibrium at {load:g} N")
        return found

    def _newton(
        self, load: float, guess: Floats, state: NodeState, friction: Floats
    ) -> Equilibrium | None:
        """Newton's method from a ``guess`` of the jumps; None if it does not converge."""
        elastic = self.forces @ np.array([1.0, load])
        allowed = RESIDUAL * float(np.abs(elastic).max()) * np.sqrt(len(elastic))
        slip = np.zeros((len(self.contact_law.friction), 3))
        slip[:, 1:] = state.slip
        jump = np.where(state.whole[self.node] == 1.0, slip.ravel()[self.kept], guess)
        force, tangent, wrong = self._residual(elastic, jump, slip, state.whole, friction)
        size = float(np.linalg.norm(wrong))
        sizes = [size]
        for _ in range(STEPS):
            if size <= allowed:
                return self._equilibrium(load, force, jump, state)
            if min(sizes[-PATIENCE:]) > min(sizes[:-PATIENCE], default=math.inf) / 2:
                break
            step = self._step(tangent, wrong, jump, slip)
            if not float(np.abs(step).max()) <= self.largest_step:  # true for NaN as well
                break
            before, start = size, jump
            for share in SHARES:  # at last the whole step, if none reduces the residual
                jump = start + share * step
                force, tangent, wrong = self._residual(elastic, jump, slip, state.whole, friction)
                size = float(np.linalg.norm(wrong))
                if size <= before:
                    break
            sizes.append(size)
        return None

    def lift(self, point: Equilibrium, load: float) -> float:
        """Fraction of the pieces' motion that lifts them when they move away under ``load`` (N)."""
        elastic = self.forces @ np.array([1.0, load])
        slip = np.zeros((len(self.contact_law.friction), 3))
        slip[:, 1:] = point.state.slip
        whole, friction = point.state.whole, self.contact_law.friction
        _, tangent, wrong = self._residual(elastic, point.unknowns, slip, whole, friction)
        step = self._step(tangent, wrong, point.unknowns, slip)
        return lifted_part(self.weight, cho_solve(self.factor, self.held.T @ step))

    def _residual(
        self, elastic: Floats, jump: Floats, slip: Floats, whole: Floats, friction: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Forces by the contact law, their tangents, and balanced forces less those of the law."""
        balanced = elastic - self.influence @ jump
        displacement = np.zeros(slip.size)
        displacement[self.kept] = balanced / self.stiffness + jump
        moved = displacement.reshape(-1, 3) - slip
        force, tangent = forces_and_tangents(self.node_stiffness, friction, whole, moved)
        return force, tangent, balanced - force.ravel()[self.kept]

    def _step(self, tangent: Floats, wrong: Floats, jump: Floats, slip: Floats) -> Floats:
        """Newton step of the jumps."""
        # At nodes that stick the contact law is linear and the jump is the slip.
        held = (tangent[:, 1, 1] == self.contact_law.shear_stiffness) | ~self.rough
        sticks = (held & (tangent[:, 0, 0] == self.contact_law.normal_stiffness))[self.node]
        step = np.where(sticks, slip.ravel()[self.kept] - jump, 0.0)
        # wrong + J step = 0 with J = -W - T (1 - W / k); T = 0 at open nodes.
        target = wrong - self.influence @ step if step.any() else wrong
        opened = (tangent[:, 0, 0] == 0.0)[self.node]
        gaps, slides = np.flatnonzero(opened), np.flatnonzero(~sticks & ~opened)
        factor = self._factorised(gaps)
        step[gaps] = cho_solve(factor, target[gaps], check_finite=False)
        if len(slides):
            blocks = self._blocks(tangent, slides)
            both = np.concatenate([slides, gaps])
            inside = self.influence[np.ix_(slides, both)]
            matrix = inside - blocks @ (inside / self.stiffness[slides][:, None])
            matrix[:, : len(slides)] += blocks.toarray()
            # The steps of nodes that stick change the elastic part too.
            moved = target[slides] + blocks @ ((wrong - target)[slides] / self.stiffness[slides])
            across = self.influence[np.ix_(gaps, slides)]
            closed = cho_solve(factor, across, check_finite=False)
            reduced = matrix[:, : len(slides)] - matrix[:, len(slides) :] @ closed
            right = moved - matrix[:, len(slides) :] @ step[gaps]
            step[slides] = lu_solve(lu_factor(reduced, check_finite=False), right)
            step[gaps] -= closed @ step[slides]
        return step

    def _factorised(self, gaps: Integers) -> tuple[Floats, bool]:
        """The influence of open components on each other, factorised; the last result is kept."""
        if self.gaps is None or not np.array_equal(gaps, self.gaps[0]):
            matrix = self.influence[np.ix_(gaps, gaps)]
            matrix[np.diag_indices_from(matrix)] += FLOOR * self.stiffness[gaps]
            self.gaps = gaps, cho_factor(matrix, check_finite=False, overwrite_a=True)
        return self.gaps[1]

    def _blocks(self, tangent: Floats, free: Integers) -> sp.csr_array:
        """Tangents of the nodes that the components ``free`` belong to, as a sparse matrix."""
        place = np.full(3 * len(tangent), -1)
        place[self.kept[free]] = np.arange(len(free))
        by_node = place.reshape(-1, 3)
        rows = np.repeat(by_node, 3, axis=1).ravel()
        columns = np.tile(by_node, (1, 3)).ravel()
        values = tangent.reshape(len(tangent), -1).ravel()
        inside = (rows >= 0) & (columns >= 0)
        shape = len(free), len(free)
        return sp.csr_array((values[inside], (rows[inside], columns[inside])), shape)

    def _equilibrium(
        self, load: float, force: Floats, jump: Floats, state: NodeState
    ) -> Equilibrium:
        slip = np.zeros(force.size)
        slip[self.kept] = jump
        after = np.where(state.bonded[:, None], state.slip, slip.reshape(-1, 3)[:, 1:])
        kept = force.ravel()[self.kept]
        motion = self.motions @ np.array([1.0, load])
        motion = motion + cho_solve(self.factor, self.held.T @ jump)
        along = float(self.variable @ motion - self.moved[1] @ kept)
        along += float(self.work @ np.array([1.0, load]))
        return Equilibrium(load, jump, along, force, NodeState(after, state.whole))
