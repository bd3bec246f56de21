"""The contact law of the nodes: elastic, with failure, opening and Coulomb friction.

At a node, delta is the displacement of the piece below relative to the piece above, in the frame of
`sidmacib.mechanics.equilibrium.face_frames`, and s the force that the piece below exerts on the
piece above: s_n = K A delta_n, positive in compression, and s_t = K A (delta_t - slip). For a
bonded node this holds until it fails, where |s_t| = c A + mu_b s_n (Mohr-Coulomb, mu_b being 0 in
the paper) or s_n = -sigma A (tension cut-off). Any other node carries no tension, and its shear
force stays within the circular friction cone, |s_t| <= mu s_n; slip takes the rest, without
dilation.

This module holds the constants of a node and its state. Its forces, their derivatives and its
utilisation are compiled, see `sidmacib.mechanics.newton`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats, Kind

Flags = NDArray[np.bool_]

ROUNDING = 1e-9  # of the largest node force; equilibria are ten times more accurate


@dataclass(frozen=True)
class ContactLaw:
    """Stiffness (N/m), friction coefficient and strengths (N) of each node, all of shape (N,).

    ``bond_friction``: of bonded nodes, added to the shear strength under compression.
    """

    normal_stiffness: Floats
    shear_stiffness: Floats
    friction: Floats
    shear_strength: Floats
    tensile_strength: Floats
    cohesive: Flags  # whether the node is bonded at the start
    bond_friction: Floats

    @classmethod
    def of(cls, assembly: Assembly) -> "ContactLaw":
        """Material of each node's face times the node's area."""
        material = [face.material for face in assembly.faces]
        per_face = np.array(
            [
                (
                    each.normal_stiffness,
                    each.shear_stiffness,
                    each.cohesion,
                    each.tensile_strength,
                    each.friction,
                    each.bond_friction,
                )
                for each in material
            ]
        )
        inner = np.array([face.kind is Kind.INNER for face in assembly.faces])
        per_node = per_face[assembly.nodes.face]
        area = assembly.nodes.area[:, None]
        normal, shear, held, torn = np.ascontiguousarray((per_node[:, :4] * area).T)
        friction, bond_friction = np.ascontiguousarray(per_node[:, 4:].T)
        cohesive = inner[assembly.nodes.face]
        return cls(normal, shear, friction, held, torn, cohesive, bond_friction)


@dataclass(frozen=True)
class NodeState:
    """The history of the nodes.

    ``slip``: in m, (N, 2). ``whole``: the fraction of the bond's stiffness that is left, from 1 to
    0 (no bond), (N,).
    """

    slip: Floats
    whole: Floats

    @property
    def bonded(self) -> Flags:
        """Whether anything is left of a node's bond, (N,)."""
        return self.whole > 0.0

    @classmethod
    def initial(cls, contact_law: ContactLaw) -> "NodeState":
        """No slip yet, and every cohesive node bonded."""
        return cls(np.zeros((len(contact_law.friction), 2)), contact_law.cohesive.astype(float))


def components(vectors: Floats) -> Floats:
    """The components of the nodes' ``vectors``, (N, K), one after the other, (K, N).

    Compiled code reads and writes them in this order; nothing is copied where it made them.
    """
    return np.ascontiguousarray(vectors.T)
