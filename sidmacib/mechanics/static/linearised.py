"""The equations of rigid pieces on contact nodes as matrices, and their derivatives.

The units and unknowns are those of `sidmacib.mechanics.springs`. Six numbers describe each node,
in the order of `NORMAL` to `BOND_FRICTION`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import bsr_array, csc_array, csr_array, eye_array
from scipy.sparse.linalg import SuperLU, splu

from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Loads
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.equilibrium import free_rows
from sidmacib.mechanics.newton.node_law import forces_and_tangents
from sidmacib.mechanics.springs import RIGID, Springs

NORMAL, SHEAR, FRICTION, COHESION, TENSION, BOND_FRICTION = range(6)  # rows of `System.nodes`
FLOOR = 1e-10  # of the largest stiffness: holds pieces that nothing holds, in the first solution
CARRIED = 1e-6  # over the forces: what may be left of them, which nothing carries
REFINEMENTS = 2  # of a solution, which remove the effect of the floor


@dataclass(frozen=True)
class System:
    """Pieces on contact nodes under loads.

    ``motion``: displacements of the nodes, along normal and tangents, by the unknowns, (3 N, U).
    ``nodes``: normal and shear stiffness (N/m), friction, shear and tensile strength (N), friction
    of bonds, (6, N). ``permanent`` (N) and ``variable`` (per newton of load): loads, (U,).
    """

    motion: csr_array
    nodes: Floats
    permanent: Floats
    variable: Floats

    @classmethod
    def of(cls, assembly: Assembly, loads: Loads) -> "System":
        """The system of an ``assembly`` of rigid pieces."""
        springs, rows = Springs.of(assembly), free_rows(assembly)
        law = springs.contact_law
        nodes = [
            law.normal_stiffness,
            law.shear_stiffness,
            law.friction,
            law.shear_strength,
            law.tensile_strength,
            law.bond_friction,
        ]
        permanent, variable = (
            forces.ravel()[rows] / springs.units for forces in (loads.permanent, loads.variable)
        )
        return cls(_motion(springs, assembly.nodes.face), np.array(nodes), permanent, variable)

    def less(self, other: "System", difference: float) -> "System":
        """The derivative by a parameter: less another system, over the ``difference``."""
        motion = (self.motion - other.motion) / difference
        motion.eliminate_zeros()
        return System(
            motion,
            (self.nodes - other.nodes) / difference,
            (self.permanent - other.permanent) / difference,
            (self.variable - other.variable) / difference,
        )

    def at(self, load: float) -> Floats:
        """The forces (N) that the nodes carry under ``load`` (N), (U,)."""
        return self.permanent + load * self.variable


def _motion(springs: Springs, face: Integers) -> csr_array:
    """See `System.motion`; ``face``: of each node, (N,)."""
    p, q = springs.place.T
    one, zero = np.ones_like(p), np.zeros_like(p)
    by_face = np.array(
        [
            [one, zero, zero, zero, q, -p],
            [zero, one, zero, -q, zero, zero],
            [zero, zero, one, p, zero, zero],
        ]
    )
    values = np.einsum("ikn,nskj->nsij", by_face, springs.motion[face])
    piece, count = springs.piece[face], len(p)
    row = 3 * np.arange(count)[:, None, None, None] + np.arange(3)[:, None]
    column = RIGID * piece[:, :, None, None] + np.arange(RIGID)
    free = np.broadcast_to(piece[:, :, None, None] >= 0, values.shape)
    row, column = np.broadcast_to(row, values.shape), np.broadcast_to(column, values.shape)
    places = row[free], column[free]
    return csr_array((values[free], places), (3 * count, int(springs.unknowns[-1])))


@dataclass(frozen=True)
class Linearised:
    """A system where its nodes are displaced, and the tangents of the nodes' forces there.

    ``apart``: displacements of the nodes (m) less their slip, (N, 3); ``whole``: see `NodeState`.
    """

    system: System
    apart: Floats
    whole: Floats

    @classmethod
    def of(cls, system: System, unknowns: Floats, slip: Floats, whole: Floats) -> "Linearised":
        """At these ``unknowns`` (m), from the ``slip`` (m) before."""
        apart = (system.motion @ unknowns).reshape(-1, 3)
        apart[:, 1:] -= slip
        return cls(system, apart, whole)

    @cached_property
    def _law(self) -> tuple[Floats, Floats]:
        nodes = self.system.nodes
        stiffness = np.ascontiguousarray(nodes[[NORMAL, SHEAR]].T)
        force, tangent = forces_and_tangents(stiffness, nodes[FRICTION], self.whole, self.apart)
        return force, tangent

    @property
    def force(self) -> Floats:
        """Of the nodes, in N, (N, 3)."""
        return self._law[0]

    @cached_property
    def tangent(self) -> bsr_array:
        """Derivative of the forces by ``apart``, in N/m, (3 N, 3 N)."""
        tangent = self._law[1]
        count = len(tangent)
        return bsr_array((tangent, np.arange(count), np.arange(count + 1)), (3 * count, 3 * count))

    @cached_property
    def _stiffness(self) -> tuple[csc_array, SuperLU]:
        motion = self.system.motion
        stiffness = csc_array(motion.T @ (self.tangent @ motion))
        floor = FLOOR * float(np.abs(stiffness.diagonal()).max()) or 1.0
        return stiffness, splu(csc_array(stiffness + floor * eye_array(stiffness.shape[0])))

    def solved(self, right: Floats) -> Floats:
        """Unknowns (m), (U,) or (U, K), under further forces ``right`` (N) on the pieces."""
        stiffness, factors = self._stiffness
        found = factors.solve(right)
        for _ in range(REFINEMENTS):
            found += factors.solve(right - stiffness @ found)
        return np.asarray(found)

    def carried(self, right: Floats) -> Floats:
        """`solved` for forces (U, K), with NaN where nothing carries them."""
        found, (stiffness, _) = self.solved(right), self._stiffness
        left = np.abs(right - stiffness @ found).max(axis=0)
        return np.where(left > CARRIED * np.abs(right).max(), np.nan, found)

    @property
    def held(self) -> Flags:
        """Whether a node is bonded, (N,)."""
        return self.whole > 0.0

    @property
    def limit(self) -> Floats:
        """Friction limit of each node that is not bonded, in N, (N,)."""
        nodes = self.system.nodes
        return np.asarray(nodes[FRICTION] * nodes[NORMAL] * np.maximum(self.apart[:, 0], 0.0))

    @cached_property
    def beyond(self) -> Floats:
        """Shear force (N) without sliding, less the limit: above 0 where a node slides, (N,)."""
        size = np.hypot(self.apart[:, 1], self.apart[:, 2])
        return np.asarray(self.system.nodes[SHEAR] * size - self.limit)

    def force_by(self, nodes: Floats) -> Floats:
        """Derivative of the forces, (N, 3), for that of ``System.nodes``, at the same ``apart``."""
        normal, along = self.apart[:, 0], self.apart[:, 1:]
        closed = self.held | (normal > 0.0)
        slides = ~self.held & closed & (self.beyond > 0.0)
        mine = self.system.nodes
        rise = mine[FRICTION] * nodes[NORMAL] + nodes[FRICTION] * mine[NORMAL]
        size = np.hypot(along[:, 0], along[:, 1])
        by_limit = np.divide(rise * normal, size, out=np.zeros_like(size), where=slides)
        shear = np.where(slides, by_limit, np.where(closed, nodes[SHEAR], 0.0))
        return np.column_stack(
            [np.where(closed, nodes[NORMAL] * normal, 0.0), shear[:, None] * along]
        )
