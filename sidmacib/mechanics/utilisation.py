"""How far each bond is used: shear and tension over strength."""

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import ROUNDING, ContactLaw, NodeState, components
from sidmacib.mechanics.newton.bonds import utilisations


def utilisation(contact_law: ContactLaw, state: NodeState, force: Floats) -> Floats:
    """Shear or tension over strength at each bonded node, whichever is larger; 0 at others, (N,).

    ``force``: in N, (N, 3). Where the bond has friction, the shear counts that this leaves to the
    cohesion. At a node without strength the result is infinite for any force above the rounding
    error of the largest force.
    """
    strengths = contact_law.shear_strength, contact_law.tensile_strength
    bonds = *strengths, contact_law.bond_friction, state.whole
    return np.asarray(utilisations(*bonds, components(force), ROUNDING))
