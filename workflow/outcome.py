"""What a model finds."""

from dataclasses import dataclass

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags


@dataclass(frozen=True)
class State:
    """Node forces that balance a ``load`` (N, along the direction of loading).

    ``displacement``: the one that the load works on, in m; None in a model without displacements.
    ``force``: (N, 3) in N, on the piece above in the frame of the face, see
    `sidmacib.mechanics.equilibrium.face_frames`; ``bonded``: (N,), whether a node holds. Both are
    None in a model without stresses.
    """

    load: float
    displacement: float | None = None
    force: Floats | None = None
    bonded: Flags | None = None


@dataclass(frozen=True)
class Outcome:
    """What a model finds: states on the way, the last of them the peak, and loads in N.

    ``failed_load``: the smallest known that the joint does not carry. ``first_failure_load``: where
    the first node fails; None in a model without failure.
    """

    path: tuple[State, ...]
    failed_load: float
    first_failure_load: float | None = None
