"""What each interface of a structure carries: resultants and utilisation, from forces at nodes."""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Vector
from sidmacib.mechanics.contact_law import ContactLaw, NodeState
from sidmacib.mechanics.utilisation import utilisation

ROUNDING = 1e-9  # of the largest node force: nodes below carry nothing
LEVERAGE = 1e-3  # of all normal forces: what they add up to, if they act anywhere


@dataclass(frozen=True)
class InterfaceForce:
    """What an interface carries.

    ``normal``: compression in N, negative in tension; ``shear``: size of the resultant along the
    interface, N. ``utilisation``: of the node that is used most, 1 at failure: shear or tension
    over strength where it is bonded, shear over friction where it is not. ``bonded``: the part of
    its area that is bonded. ``resultant``: of the forces on the block above, N, along x, y and z.
    ``at``: the point (m) of the interface's plane through which it acts, torsion apart; None where
    compression and tension leave next to none of either.
    """

    name: str
    normal: float
    shear: float
    utilisation: float
    bonded: float
    resultant: Vector
    at: Vector | None


def interface_forces(
    assembly: Assembly, force: Floats, state: NodeState | None = None
) -> tuple[InterfaceForce, ...]:
    """What each face of ``assembly`` carries under node forces, (N, 3) in N as in `Equilibrium`.

    ``state``: of the nodes; by default all bonds are whole.
    """
    law, area = ContactLaw.of(assembly), assembly.nodes.area
    state = state or NodeState.initial(law)
    used = np.where(state.bonded, utilisation(law, state, force), _slipping(law, force))
    found = []
    for number, face in enumerate(assembly.faces):
        nodes = assembly.nodes.face == number
        whole = force[nodes].sum(axis=0)
        normal, *shear = whole.tolist()
        bonded = float(area[nodes & state.bonded].sum() / area[nodes].sum())
        found.append(
            InterfaceForce(
                face.name,
                normal,
                float(np.hypot(*shear)),
                float(used[nodes].max()),
                bonded,
                _vector(whole @ face.axes),
                _centre(assembly.nodes.position[nodes], force[nodes, 0]),
            )
        )
    return tuple(found)


def _centre(places: Floats, normal: Floats) -> Vector | None:
    """Where normal forces, (N,) in N, act at ``places``, (N, 3) in m; None if they add up to 0."""
    whole = float(normal.sum())
    if abs(whole) <= LEVERAGE * float(np.abs(normal).sum()):
        return None
    return _vector(normal @ places / whole)


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z


def _slipping(law: ContactLaw, force: Floats) -> Floats:
    """Shear over what friction allows at each node that is pressed, 0 at others, (N,)."""
    pressed = force[:, 0] > ROUNDING * float(np.abs(force).max(initial=0.0))
    allowed = law.friction * force[:, 0]
    shear = np.hypot(force[:, 1], force[:, 2])
    ratio = np.where(shear > 0.0, np.inf, 0.0)
    np.divide(shear, allowed, out=ratio, where=allowed > 0.0)
    return np.where(pressed, ratio, 0.0)
