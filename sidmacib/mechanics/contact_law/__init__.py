r"""The contact law of a node: elastic, with failure, softening, opening and Coulomb friction.

Below, A is the area of a node, s the force that the piece below exerts on the piece above, and
delta the displacement of the piece below relative to the piece above, both in the frame of
`sidmacib.mechanics.equilibrium.face_frames`: normal (n) and two tangents (t).

Bonded, with the fraction D of its stiffness left (1 until it softens):

.. math::

    s_n = D K_n A\, \delta_n, \qquad s_t = D K_s A\, (\delta_t - \gamma)

with D = 1 in the first under compression. It fails where its utilisation is 1:

.. math::

    u = \max\left( \frac{|s_t| - \mu_b s_n}{\tau_k A},\ \frac{-s_n}{\sigma A} \right)

The friction of bonds, :math:`\mu_b`, is 0 in the paper. A brittle bond then has D = 0, a softening
one less and less, see `sidmacib.mechanics.static.softening`.

Dry, or bonded no more (D = 0): no tension, and Coulomb's friction, by return mapping:

.. math::

    s_n = K_n A \max(\delta_n, 0), \qquad
    s_t = K_s A\, (\delta_t - \gamma)\ \min\left(1,
    \frac{\mu s_n}{K_s A\, |\delta_t - \gamma|} \right)

The slip takes the rest, without dilation: :math:`\gamma` becomes
:math:`\delta_t - s_t / (K_s A)`. Where the node slides, along the unit vector t, the tangent is

.. math::

    \frac{\partial s_t}{\partial \delta_n} = \mu K_n A\, t, \qquad
    \frac{\partial s_t}{\partial \delta_t}
    = \frac{\mu s_n}{|\delta_t - \gamma|} \left( I - t\, t^T \right)

Of all this, limit analysis knows only the limits of the forces, see `Cone`:

.. math::

    |s_t| \le \tau A + \mu s_n, \qquad s_n \ge -\sigma A

Forces, tangents, slip and utilisation are compiled, in `sidmacib.mechanics.contact_law.kernels`.
They are apart, so that whoever needs only numbers of nodes loads no compiler. Engines run on
their own: each script has the law in its engine's terms, and the utilisation of bonds in
`sidmacib.engines.scripts.assembly`.
"""

from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats, Kind

Flags = NDArray[np.bool_]
_NUMBERS = attrgetter(
    *("normal_stiffness", "shear_stiffness", "cohesion", "tensile_strength"),
    *("friction", "friction_in_bonds"),
)


@dataclass(frozen=True)
class ContactLaw:
    """The numbers of the law at each node, all of shape (N,).

    Stiffness in N/m: K_n A, K_s A. ``friction``: mu of a node that is not bonded. Strengths of
    bonds in N: tau_k A, sigma A; ``bond_friction``: mu_b. ``cohesive``: whether it is bonded at
    the start. ``locked``: whether it is a contact point in place of locks.
    """

    normal_stiffness: Floats
    shear_stiffness: Floats
    friction: Floats
    shear_strength: Floats
    tensile_strength: Floats
    cohesive: Flags
    bond_friction: Floats
    locked: Flags

    @classmethod
    def of(cls, assembly: Assembly) -> "ContactLaw":
        """Material of each node's face times the node's area."""
        per_face = np.array([_NUMBERS(face.material) for face in assembly.faces])
        per_node = per_face[assembly.nodes.face]
        area = assembly.nodes.area[:, None]
        normal, shear, held, torn = np.ascontiguousarray((per_node[:, :4] * area).T)
        friction, bond_friction = np.ascontiguousarray(per_node[:, 4:].T)
        kinds = np.array([face.kind for face in assembly.faces])[assembly.nodes.face]
        cohesive, locked = kinds == Kind.INNER, kinds == Kind.LOCKED
        return cls(normal, shear, friction, held, torn, cohesive, bond_friction, locked)

    def rows(self) -> Floats:
        """The rows that compiled code reads, see `sidmacib.mechanics.contact_law.kernels`."""
        given = np.zeros_like(self.friction)
        return np.array([self.normal_stiffness, self.shear_stiffness, self.friction, given])

    def cone(self, *, friction: bool = True) -> "Cone":
        """The limits of the forces; ``friction``: whether nodes that are not bonded have any."""
        bond, held = self.cohesive, self.cohesive | self.locked
        return Cone(
            np.where(held, self.shear_strength, 0.0),
            np.where(bond, self.bond_friction, self.friction * friction),
            np.where(bond, self.tensile_strength, 0.0),
        )


@dataclass(frozen=True)
class Cone:
    """Limits of node forces: |s_t| <= ``held`` + ``slope`` s_n and s_n >= -``torn``.

    ``held``, ``torn`` in N; all (N,). At a contact point in place of locks ``slope`` limits the
    force along the locks, ``held`` that across them.
    """

    held: Floats
    slope: Floats
    torn: Floats

    def at(self, nodes: NDArray[np.int64]) -> "Cone":
        """The limits at some ``nodes``."""
        return Cone(self.held[nodes], self.slope[nodes], self.torn[nodes])

    def shear(self, normal: Floats) -> Floats:
        """The largest shear (N) under ``normal`` forces (N), both (N,)."""
        return np.asarray(self.held + self.slope * normal)


@dataclass(frozen=True)
class NodeState:
    """The history of the nodes.

    ``slip``: gamma in m, (N, 2). ``whole``: D, the fraction of the bond's stiffness that is left,
    from 1 to 0 (no bond), (N,).
    """

    slip: Floats
    whole: Floats

    @property
    def bonded(self) -> Flags:
        """Whether anything is left of a node's bond, (N,)."""
        return self.whole > 0.0

    @property
    def jump(self) -> Floats:
        """Opening and slip (m) of a node that its springs hold without force, (N, 3)."""
        return np.column_stack([np.zeros(len(self.slip)), self.slip])

    def after(self, jump: Floats) -> "NodeState":
        """The state once nodes that are not bonded have opened and slipped by ``jump``, (N, 3)."""
        return replace(self, slip=np.where(self.bonded[:, None], self.slip, jump[:, 1:]))

    @classmethod
    def initial(cls, bonded: Flags) -> "NodeState":
        """No slip yet, and ``bonded`` nodes, (N,), with whole bonds."""
        return cls(np.zeros((len(bonded), 2)), bonded.astype(float))


def components(vectors: Floats) -> Floats:
    """The components of the nodes' ``vectors``, (N, K), one after the other, (K, N).

    Compiled code reads and writes them in this order; nothing is copied where it made them.
    """
    return np.ascontiguousarray(vectors.T)
