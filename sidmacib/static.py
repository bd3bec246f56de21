"""Static brittle model of the whole joint: equilibrium of rigid pieces on springs that can fail.

The unknowns are the six displacements of every free piece. A node's force follows from the relative
displacement of its two pieces by `sidmacib.contact_law`, so Newton's method needs matrices of the
size of the pieces, however fine the mesh. The load rises in increments, which gives friction its
history. When the first node fails, all of its strength goes at once (those that fail together go
together) and a new equilibrium is sought at the same load; where none exists is the peak.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sidmacib.contact_law import NodeLaw, NodeState, Response, advanced, respond, utilisation
from sidmacib.discretisation import Discretisation, Floats
from sidmacib.equilibrium import (
    face_frames,
    free_rows,
    permanent_and_reference,
    wrenches,
)
from sidmacib.loading import PieceLoad

FIRST_INCREMENT = 0.1  # load increment over T0
LEAST_INCREMENT = 1e-6  # over the load: where the search for a failure or for the peak ends
RESIDUAL = 1e-10  # unbalanced force over the loads, at equilibrium
NEWTON_STEPS = 60


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium of the joint.

    ``load``: along the direction of loading, in N. ``displacement``: of the free pieces, (6 F,), in
    m and rad. ``force``: (N, 3) in N, what the piece below each node exerts on the piece above in
    the frame of the face: normal (compression positive) and two tangents. ``state``: of the nodes.
    """

    load: float
    displacement: Floats
    force: Floats
    state: NodeState


@dataclass(frozen=True)
class StaticSolution:
    """The path of the joint to its peak.

    ``first_failure_load`` in N: where the first node fails. ``path``: the equilibria on the way;
    the last one is the peak. ``newton_steps``: how many it took.
    """

    first_failure_load: float
    path: tuple[Equilibrium, ...]
    newton_steps: int

    @property
    def peak(self) -> Equilibrium:
        """The equilibrium at the largest load."""
        return max(self.path, key=lambda point: point.load)


class NoEquilibriumError(RuntimeError):
    """Newton's method finds no equilibrium at a load."""


@dataclass(frozen=True)
class System:
    """A discretised joint as Newton's method needs it.

    The nodes of a face move like a rigid body: delta = ``motion`` w, (N, 3, 6), with six components
    w = ``faces`` u, (F, 6, 6 P), of the face's two pieces. ``starts``: index of each face's first
    node. ``load``, ``weight``: forces on the free pieces, (6 P,), per N of load, and in N.
    """

    law: NodeLaw
    motion: Floats
    faces: Floats
    starts: NDArray[np.int64]
    load: Floats
    weight: Floats

    @classmethod
    def of(cls, model: Discretisation, loads: tuple[PieceLoad, ...]) -> "System":
        """The system of ``model`` under ``loads``."""
        nodes, frames = model.nodes, face_frames(model)
        origins = np.array([(np.array(f.low) + np.array(f.high)) / 2 for f in model.faces])
        free = [i for i, piece in enumerate(model.pieces) if not piece.fixed]
        faces = np.zeros((len(model.faces), 6, 6 * len(free)))
        for number, face in enumerate(model.faces):
            for piece, sign in ((face.below, 1.0), (face.above, -1.0)):
                if piece in free:
                    column = 6 * free.index(piece)
                    arm = origins[number] - model.pieces[piece].centre
                    faces[number, :, column : column + 6] = sign * np.eye(6)
                    # A turn moves the origin of the face by turn x arm.
                    faces[number, :3, column + 3 : column + 6] = -sign * np.cross(arm, np.eye(3)).T
        permanent, reference = permanent_and_reference(model, loads)
        rows = free_rows(model)
        return cls(
            NodeLaw.of(model),
            # Row by row, force and moment of a unit force about the face's origin.
            wrenches(nodes.position - origins[nodes.face], frames, np.zeros(3))
            .T.reshape(-1, 3, 6)
            .copy(),
            faces,
            np.flatnonzero(np.diff(nodes.face, prepend=-1)),
            reference[rows],
            permanent[rows],
        )

    def node_displacements(self, displacement: Floats) -> Floats:
        """Relative displacement at each node, below minus above, in the frame of its face."""
        counts = np.diff(self.starts, append=len(self.motion))
        per_face = np.repeat(self.faces @ displacement, counts, axis=0)
        return np.asarray((self.motion @ per_face[:, :, None])[:, :, 0])

    def piece_forces(self, force: Floats) -> Floats:
        """Forces on the free pieces that balance node forces, (6 P,)."""
        per_node = (force[:, None, :] @ self.motion)[:, 0]
        per_face = np.add.reduceat(per_node, self.starts)
        return np.asarray(np.einsum("fk,fkp->p", per_face, self.faces))

    def stiffness(self, tangent: Floats) -> Floats:
        """Derivative of `piece_forces` by the displacements, (6 P, 6 P)."""
        per_node = self.motion.transpose(0, 2, 1) @ (tangent @ self.motion)
        per_face = np.add.reduceat(per_node, self.starts)
        size = self.faces.shape[2]
        return self.faces.reshape(-1, size).T @ (per_face @ self.faces).reshape(-1, size)

    def elastic_stiffness(self) -> Floats:
        """Stiffness with every node closed and bonded."""
        tangent = np.zeros((len(self.motion), 3, 3))
        tangent[:, 0, 0] = self.law.normal_stiffness
        tangent[:, 1, 1] = tangent[:, 2, 2] = self.law.shear_stiffness
        return self.stiffness(tangent)


class Solver:
    """Newton's method on a `System`; counts its steps."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.steps = 0
        self.elastic: Floats = system.elastic_stiffness()
        # Keeps pieces that nothing holds for a moment from flying off.
        self.floor = 1e-10 * np.diag(np.diag(self.elastic))

    def start(self) -> Equilibrium:
        """Equilibrium under self-weight alone."""
        state = NodeState.initial(self.system.law)
        guess = np.asarray(np.linalg.solve(self.elastic, self.system.weight), dtype=float)
        return self.solve(0.0, guess, state)

    def solve(self, load: float, guess: Floats, state: NodeState) -> Equilibrium:
        """Equilibrium at ``load`` (N), from a ``guess`` of the displacements and the nodes' state.

        Raises `NoEquilibriumError` where Newton's method ends nowhere.
        """
        system = self.system
        target = load * system.load + system.weight
        allowed = RESIDUAL * float(np.abs(target).max())

        def at(displacement: Floats) -> tuple[Floats, Floats, Response, Floats, float]:
            delta = system.node_displacements(displacement)
            response = respond(system.law, state, delta)
            residual = target - system.piece_forces(response.force)
            return displacement, delta, response, residual, float(np.linalg.norm(residual))

        now = at(guess)
        for _ in range(NEWTON_STEPS):
            displacement, delta, response, residual, size = now
            if size <= allowed:
                after = advanced(system.law, state, delta, response.force)
                return Equilibrium(load, displacement, response.force, after)
            self.steps += 1
            step = np.linalg.solve(system.stiffness(response.tangent) + self.floor, residual)
            if not np.abs(step).max() < 1.0:
                break
            full = now = at(displacement + step)
            share = 1.0
            while now[4] > size and share > 0.01:
                share /= 2
                now = at(displacement + share * step)
            if now[4] > size:
                now = full
        raise NoEquilibriumError(f"no equilibrium at {load:g} N")


def static_peak(model: Discretisation, loads: tuple[PieceLoad, ...]) -> StaticSolution:
    """Raise ``loads`` from 0 to the peak of ``model``.

    Raises `NoEquilibriumError` if the joint does not stand under its own weight.
    """
    solver = Solver(System.of(model, loads))
    path = [solver.start()]
    first_failure: float | None = None
    while True:
        path, failing = _raised(solver, path, FIRST_INCREMENT * model.joint.T0)
        first_failure = path[-1].load if first_failure is None else first_failure
        if not failing.any():
            break
        try:
            path.append(_redistributed(solver, path[-1], failing))
        except NoEquilibriumError:
            break
    return StaticSolution(first_failure, tuple(path), solver.steps)


@dataclass(frozen=True)
class _Beyond:
    """A load that is too high, with the nodes' utilisation there; None without equilibrium."""

    load: float
    utilisation: Floats | None


def _raised(
    solver: Solver, path: list[Equilibrium], increment: float
) -> tuple[list[Equilibrium], NDArray[np.bool_]]:
    """Raise the load until nodes are about to fail, or no equilibrium exists.

    Returns the path to there, and which nodes fail: none where the load cannot rise.
    """
    law, path = solver.system.law, list(path)
    beyond: _Beyond | None = None
    while True:
        low = path[-1]
        used = utilisation(law, low.state, low.force)
        if used.max() >= 1.0 - LEAST_INCREMENT:
            return path, used >= used.max() * (1.0 - 1e-5)
        if beyond is None:
            load = low.load + increment
        elif beyond.load - low.load <= LEAST_INCREMENT * beyond.load:
            failing = beyond.utilisation
            return path, np.zeros(len(used), bool) if failing is None else failing >= 1.0
        elif beyond.utilisation is None:
            load = (low.load + beyond.load) / 2
        else:  # where the utilisation, all but linear, comes just below 1
            share = (1.0 - used.max()) / (beyond.utilisation.max() - used.max())
            load = low.load + (beyond.load - low.load) * min(share, 0.99) * (1.0 - 1e-7)
        guess = low.displacement
        if len(path) > 1 and low.load > path[-2].load:
            onward = (load - low.load) / (low.load - path[-2].load)
            guess = guess + onward * (guess - path[-2].displacement)
        try:
            point = solver.solve(load, guess, low.state)
        except NoEquilibriumError:
            beyond = _Beyond(load, None)
            continue
        reached = utilisation(law, point.state, point.force)
        if reached.max() > 1.0:
            beyond = _Beyond(load, reached)
        else:
            path.append(point)


def _redistributed(solver: Solver, point: Equilibrium, failing: NDArray[np.bool_]) -> Equilibrium:
    """The equilibrium at the same load after nodes have failed, and those that fail in turn.

    Raises `NoEquilibriumError` if there is none.
    """
    state = point.state
    while failing.any():
        state = replace(state, bonded=state.bonded & ~failing)
        after = solver.solve(point.load, point.displacement, state)
        failing = utilisation(solver.system.law, state, after.force) > 1.0
    return after
