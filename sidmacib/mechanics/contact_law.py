"""Law of the contact nodes: elastic, with failure, opening and Coulomb friction.

At a node, delta is the displacement of the piece below relative to the piece above in the frame of
`sidmacib.mechanics.equilibrium.face_frames`, and s the force that the piece below exerts on the
piece above: s_n = K A delta_n, positive in compression, and s_t = K A (delta_t - slip). A bonded node keeps both
until it fails. Any other node cannot pull, and its shear force stays on or inside the circular
friction cone, |s_t| <= mu s_n: slip makes up the difference, without dilation.
"""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Floats, Kind

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class NodeLaw:
    """Stiffness (N/m), friction coefficient and strengths (N) of each node, all of shape (N,)."""

    normal_stiffness: Floats
    shear_stiffness: Floats
    friction: Floats
    shear_strength: Floats
    tensile_strength: Floats
    cohesive: Flags  # bonded at the start

    @classmethod
    def of(cls, assembly: Assembly) -> "NodeLaw":
        """The law of every node of ``assembly``: the face's material times the node's area."""
        face, area = assembly.nodes.face, assembly.nodes.area

        def per_node(name: str) -> Floats:
            return np.array([getattr(each.material, name) for each in assembly.faces])[face]

        return cls(
            per_node("normal_stiffness") * area,
            per_node("shear_stiffness") * area,
            per_node("friction"),
            per_node("cohesion") * area,
            per_node("tensile_strength") * area,
            np.array([each.kind is Kind.INNER for each in assembly.faces])[face],
        )

    def part(self, own: Flags) -> "NodeLaw":
        """The law of the ``own`` nodes, (N,), alone."""
        return NodeLaw(*(getattr(self, field.name)[own] for field in fields(self)))


@dataclass(frozen=True)
class NodeState:
    """What a node remembers: its slip (m), shape (N, 2), and whether it is bonded, shape (N,)."""

    slip: Floats
    bonded: Flags

    @classmethod
    def initial(cls, law: NodeLaw) -> "NodeState":
        """No slip yet, and every cohesive node bonded."""
        return cls(np.zeros((len(law.friction), 2)), law.cohesive)

    def part(self, own: Flags) -> "NodeState":
        """The state of the ``own`` nodes, (N,), alone."""
        return NodeState(self.slip[own], self.bonded[own])


@dataclass(frozen=True)
class Response:
    """What the nodes do at given displacements.

    ``force``: s in N, (N, 3). ``sticks``, ``slides``: closed nodes below and at the limit of
    friction, (N,). ``along``: unit vector of the shear force where a node slides, 0 elsewhere, and
    ``share``: of the elastic shear force that is left, (N, 2) and (N,).
    """

    force: Floats
    sticks: Flags
    slides: Flags
    along: Floats
    share: Floats


def respond(law: NodeLaw, state: NodeState, delta: Floats) -> Response:
    """Return mapping: forces of all nodes at relative displacements ``delta`` (m), (N, 3)."""
    normal = law.normal_stiffness * delta[:, 0]
    trial = law.shear_stiffness[:, None] * (delta[:, 1:] - state.slip)
    size = np.hypot(trial[:, 0], trial[:, 1])
    closed = state.bonded | (normal > 0.0)
    cone = np.where(closed, law.friction * normal, 0.0)
    sticks = state.bonded | (closed & (size <= cone))
    slides = closed & ~sticks
    inverse = np.divide(1.0, size, out=np.zeros_like(size), where=slides)
    share = np.where(sticks, 1.0, cone * inverse)
    force = np.column_stack([np.where(closed, normal, 0.0), share[:, None] * trial])
    return Response(force, sticks, slides, inverse[:, None] * trial, share)


def tangent(law: NodeLaw, response: Response) -> Floats:
    """Derivative of the forces of `respond` by delta, in N/m, (N, 3, 3)."""
    stiffness = np.zeros((len(response.share), 3, 3))
    stiffness[:, 0, 0] = law.normal_stiffness * (response.sticks | response.slides)
    shear = response.share * law.shear_stiffness
    stiffness[:, 1, 1] = stiffness[:, 2, 2] = shear
    own = np.flatnonzero(response.slides)
    along = response.along[own]
    stiffness[own, 1:, 0] = (law.friction * law.normal_stiffness)[own, None] * along
    stiffness[own, 1:, 1:] -= (shear[own, None] * along)[:, :, None] * along[:, None, :]
    return stiffness


def advanced(law: NodeLaw, state: NodeState, delta: Floats, force: Floats) -> NodeState:
    """The state after equilibrium at ``delta`` and ``force``: slip is kept, for the next step."""
    slip = delta[:, 1:] - force[:, 1:] / law.shear_stiffness[:, None]
    return NodeState(np.where(state.bonded[:, None], state.slip, slip), state.bonded)


def utilisation(law: NodeLaw, state: NodeState, force: Floats) -> Floats:
    """Largest of shear and tension over strength at the bonded nodes, 0 at others, shape (N,).

    Without tensile strength any tension counts as infinite.
    """
    shear = np.hypot(force[:, 1], force[:, 2])
    tension = np.maximum(-force[:, 0], 0.0)
    own = state.bonded & (law.tensile_strength > 0.0)
    ratios = np.where(state.bonded & (tension > 0.0), np.inf, 0.0)
    np.divide(tension, law.tensile_strength, out=ratios, where=own)
    held = np.divide(shear, law.shear_strength, out=np.zeros_like(shear), where=state.bonded)
    return np.asarray(np.maximum(ratios, held))
