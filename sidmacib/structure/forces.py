"""What each interface of a structure carries: resultants and utilisation, from forces at nodes."""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.contact_law import ContactLaw, NodeState, utilisation

ROUNDING = 1e-9  # of the largest node force: nodes below carry nothing


@dataclass(frozen=True)
class InterfaceForce:
    """What an interface carries.

    ``normal``: compression in N, negative in tension; ``shear``: size of the resultant along the
    interface, N. ``utilisation``: of the node that is used most, 1 at failure: shear or tension
    over strength where it is bonded, shear over friction where it is not. ``bonded``: the part of
    its area that is bonded.
    """

    name: str
    normal: float
    shear: float
    utilisation: float
    bonded: float


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
        normal, *shear = force[nodes].sum(axis=0).tolist()
        bonded = float(area[nodes & state.bonded].sum() / area[nodes].sum())
        size = float(np.hypot(*shear))
        found.append(InterfaceForce(face.name, normal, size, float(used[nodes].max()), bonded))
    return tuple(found)


def _slipping(law: ContactLaw, force: Floats) -> Floats:
    """Shear over what friction allows at each node that is pressed, 0 at others, (N,)."""
    pressed = force[:, 0] > ROUNDING * float(np.abs(force).max(initial=0.0))
    allowed = law.friction * force[:, 0]
    shear = np.hypot(force[:, 1], force[:, 2])
    ratio = np.where(shear > 0.0, np.inf, 0.0)
    np.divide(shear, allowed, out=ratio, where=allowed > 0.0)
    return np.where(pressed, ratio, 0.0)
