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
import os
import resource
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.blas import dgemm

from sidmacib.errors import CapacityError, NoEquilibriumError, SolverError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.elastic.flexibility import element_edges, flexibility
from sidmacib.mechanics.elastic.jumps import LooseNodes, OpenGaps, cholesky_factor, inverse_by
from sidmacib.mechanics.equilibrium import equilibrium_matrix, free_rows, row_units
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.newton import STEPS
from sidmacib.mechanics.solution import (
    LARGEST_STEP,
    Equilibrium,
    Solver,
    farthest_motion,
    lifted_part,
)
from sidmacib.quantities import four_digits

GIB = 2.0**30
BYTES = 8.0  # of a number
MATRICES = 3.5  # that are in memory at the same time
ENTRY = 6.0  # numbers for each entry of a stiffness while it is put together
CGROUP = Path("/sys/fs/cgroup/memory.max")  # of a container
PATIENCE = 16  # steps in which the residual must at least halve
SHARES = (1.0, 0.5, 0.25, 0.125, 1.0)  # fractions of a Newton step that are tried
LAW_RESIDUAL = 1e-9  # of the contact law, over the loads
OPEN_FLOOR = 1e-9  # of a node's stiffness: added where it is open
LOOSE = 1e-13  # of the stiffness against rigid motions: added for pieces that nothing holds
LEAST_STEP = 0.01  # of friction that is raised from 0
STICKS = 1e6  # times friction: at so much, hardly a node slides
LEAST_LOWERING = 7e-4  # of the logarithm of friction that is lowered from there


def require_memory(needed: float, what: str) -> None:
    """Raise `CapacityError` if ``what`` needs more than this machine has; ``needed``: bytes."""
    available = memory()
    if needed > available:
        raise CapacityError(
            f"{what} need {needed / GIB:.1f} GiB of memory or more, and this machine has "
            f"{available / GIB:.1f} GiB; use a coarser mesh"
        )


def memory() -> float:
    """Memory (bytes) that a process may use on this machine."""
    limits = [float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))]
    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY:
        limits.append(float(allowed))
    with suppress(OSError, ValueError):  # no container, or one without a limit
        limits.append(float(CGROUP.read_text()))
    return min(limits)


def memory_needed(assembly: Assembly, kept: Integers) -> float:
    """Least memory (bytes) of the elastic solver for the node components ``kept``.

    It keeps several matrices at a time, by components; before, the stiffness of the largest piece.
    """
    quadratic = assembly.layout is not NodeLayout.VERTICES
    step, coupled = (2, 4) if quadratic else (1, 3)  # nodes of an element and to others, on a line
    freedoms = 0.0
    for number, piece in enumerate(assembly.pieces):
        if piece.elastic is not None and not piece.fixed:
            edges = element_edges(assembly, number)
            freedoms = max(freedoms, 3.0 * math.prod(step * (len(e) - 1) + 1 for e in edges))
    square = float(len(kept)) ** 2
    return BYTES * max(MATRICES * square, square + ENTRY * 3.0 * coupled**3 * freedoms)


class ElasticSolver(Solver):
    """Newton's method on the jumps at the nodes of ``assembly``, with elastic pieces."""

    def __init__(self, assembly: Assembly, loads: Loads) -> None:
        self.contact_law, self.scale = ContactLaw.of(assembly), loads.scale
        self.most_opening = assembly.most_opening
        normal, shear = self.contact_law.normal_stiffness, self.contact_law.shear_stiffness
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
        size, self.length = row_units(assembly), assembly.length
        rigid = (equilibrium_matrix(assembly).toarray()[rows][:, self.kept] / size[:, None]).T
        give[np.diag_indices_from(give)] += 1.0 / self.stiffness
        inverse = inverse_by(cholesky_factor(give))
        held = inverse @ rigid
        whole = rigid.T @ held
        whole[np.diag_indices_from(whole)] += LOOSE * float(whole.diagonal().max())
        factor = cho_factor(whole)
        # In place: these matrices are large.
        self.influence = dgemm(
            -1.0, held, cho_solve(factor, held.T), 1.0, inverse, overwrite_c=True
        ).T
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
        none = np.zeros(0, np.int64)
        self.open_gaps = none, none, OpenGaps(np.zeros((0, 0)), np.zeros(0))
        elastic = np.abs(self.forces / self.stiffness[:, None]).max(axis=0)
        self.largest_step = LARGEST_STEP * float(elastic[0] + loads.scale * elastic[1])
        self.flew_off = self.cycles_from_nothing = False

    def start(self) -> Equilibrium:
        """Equilibrium under the permanent loads alone."""
        initial = NodeState.initial(self.contact_law.cohesive)
        return self.solve(0.0, np.zeros(len(self.kept)), initial, thorough=True)

    def solve(
        self, load: float, guess: Floats, state: NodeState, *, thorough: bool = False
    ) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the jumps and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method finds none and, if ``thorough``, none from
        the equilibrium without friction either, at once or with friction raised in steps, from
        where it also converges if all dry nodes begin without any force; nor, while all bonds are
        whole, from that with so much friction that nothing slides, which is then lowered: stiff dry
        faces need that.
        """
        whole = np.array_equal(state.whole, self.contact_law.cohesive)
        found, from_nothing = None, whole and self._from_nothing(guess, state)
        if not (from_nothing and self.cycles_from_nothing):
            found = self._newton(load, guess, state, self.contact_law.friction)
            self.cycles_from_nothing |= from_nothing and found is None and not self.flew_off
        if found is None and thorough:
            found = self._by_steps(load, guess, state, lambda share: share, LEAST_STEP)
            if found is None and whole:
                found = self._by_steps(
                    load, guess, state, lambda share: STICKS ** (1.0 - share), LEAST_LOWERING
                )
            if found is None and from_nothing and self.cycles_from_nothing:
                raise SolverError(
                    "no equilibrium of elastic blocks was found from no force at all; give them a "
                    "density, which may be small"
                )
        if found is None:
            raise NoEquilibriumError(f"no equilibrium at {four_digits(load)} N")
        return found

    def _from_nothing(self, guess: Floats, state: NodeState) -> bool:
        """Whether no force or jump precedes the load: steps are then in proportion to it.

        If Newton's method cycles at one such load, it does so at all.
        """
        return not (self.forces[:, 0].any() or guess.any() or state.slip.any())

    def _by_steps(
        self,
        load: float,
        guess: Floats,
        state: NodeState,
        factor: Callable[[float], float],
        least: float,
    ) -> Equilibrium | None:
        """Equilibrium from that with a ``factor`` of 0 on friction, in steps to that of 1.

        A step that fails is halved, one that succeeds doubled; None if it becomes ``least``.
        """
        friction = self.contact_law.friction
        found = self._newton(load, guess, state, factor(0.0) * friction)
        share, step = 0.0, 1.0
        while found is not None and share < 1.0:
            if step < least:
                return None
            further = min(share + step, 1.0)
            after = self._newton(load, found.unknowns, state, factor(further) * friction)
            if after is None:
                step /= 2
            else:
                found, share, step = after, further, 2 * step
        return found

    def _newton(
        self, load: float, guess: Floats, state: NodeState, friction: Floats
    ) -> Equilibrium | None:
        """Newton's method from a ``guess`` of the jumps; None if it does not converge."""
        elastic = self.forces @ np.array([1.0, load])
        allowed = LAW_RESIDUAL * float(np.abs(elastic).max()) * np.sqrt(len(elastic))
        loose = self._loose_nodes(state, friction)
        balanced, jump = elastic[loose.components], guess[loose.components]
        force, tangent, wrong = loose.residual(balanced, jump)
        size = float(np.linalg.norm(wrong))
        sizes = [size]
        for _ in range(STEPS):
            if size <= allowed:
                motion = self._motion(load, loose, jump)
                # Pieces that nothing holds: what was added of stiffness carries the load.
                self.flew_off = bool(np.abs(motion).max() > self.length)
                if self.flew_off:
                    break
                return self._equilibrium(load, elastic, loose, force, jump, state, motion)
            if min(sizes[-PATIENCE:]) > min(sizes[:-PATIENCE], default=math.inf) / 2:
                break
            step = loose.step(tangent, wrong, jump)
            self.flew_off = not float(np.abs(step).max()) <= self.largest_step  # also for NaN
            if self.flew_off:
                break
            before, start = size, jump
            for share in SHARES:  # at last the whole step, if none reduces the residual
                jump = start + share * step
                force, tangent, wrong = loose.residual(balanced, jump)
                size = float(np.linalg.norm(wrong))
                if size <= before:
                    break
            sizes.append(size)
        return None

    def lift(self, point: Equilibrium, load: float) -> float:
        """Fraction of the pieces' motion that lifts them when they move away under ``load`` (N)."""
        loose = self._loose_nodes(point.state, self.contact_law.friction)
        elastic = self.forces[loose.components] @ np.array([1.0, load])
        jump = point.unknowns[loose.components]
        _, tangent, wrong = loose.residual(elastic, jump)
        step = loose.step(tangent, wrong, jump)
        return lifted_part(self.weight, self._moved_by(loose, step))

    def _loose_nodes(self, state: NodeState, friction: Floats) -> LooseNodes:
        """The nodes that may open or slip; what they have in common with the last is kept."""
        loose = state.whole != 1.0
        nodes, components, open_gaps = self.open_gaps
        if np.count_nonzero(loose) != len(nodes) or not loose[nodes].all():
            more = loose[nodes].all()  # than the last: these come first
            new = loose.copy()
            if more:
                new[nodes] = False
            else:
                nodes, components = nodes[:0], components[:0]
            nodes = np.concatenate([nodes, np.flatnonzero(new)])
            components = np.concatenate([components, np.flatnonzero(new[self.node])])
            influence = self.influence[np.ix_(components, components)]
            floor = OPEN_FLOOR * self.stiffness[components]
            make = open_gaps.extended if more else OpenGaps
            open_gaps = make(influence, floor)
            self.open_gaps = nodes, components, open_gaps
        number = np.zeros(len(loose), np.int64)
        number[nodes] = np.arange(len(nodes))
        place = 3 * number[self.node[components]] + self.kept[components] % 3
        law = replace(self.contact_law, friction=friction).rows().take(nodes, axis=1)
        loose_state = NodeState(state.slip[nodes], state.whole[nodes])
        return LooseNodes(nodes, components, place, law, self.rough[nodes], loose_state, open_gaps)

    def _motion(self, load: float, loose: LooseNodes, jump: Floats) -> Floats:
        """Rigid motions of the pieces (m; rotations times the assembly's length)."""
        moved: Floats = self.motions @ np.array([1.0, load])
        return moved + self._moved_by(loose, jump)

    def _moved_by(self, loose: LooseNodes, jump: Floats) -> Floats:
        """The part of `_motion` that follows from jumps."""
        return np.asarray(cho_solve(self.factor, self.held[loose.components].T @ jump))

    def _equilibrium(
        self,
        load: float,
        elastic: Floats,
        loose: LooseNodes,
        loose_force: Floats,
        loose_jump: Floats,
        state: NodeState,
        motion: Floats,
    ) -> Equilibrium:
        jump = np.zeros(len(elastic))
        jump[loose.components] = loose_jump
        force, opened = np.zeros((2, len(state.slip), 3))
        force.ravel()[self.kept] = elastic - self.influence @ jump
        force[loose.nodes] = loose_force
        opened.ravel()[self.kept] = jump
        kept = force.ravel()[self.kept]
        along = float(self.variable @ motion - self.moved[1] @ kept)
        along += float(self.work @ np.array([1.0, load]))
        turned, moved = farthest_motion(motion)
        after, largest = state.after(opened), -float(opened[:, 0].min())
        return Equilibrium(load, jump, along, force, after, turned / self.length, moved, largest)
