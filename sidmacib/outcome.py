"""The outcome of a model for a case, before it is checked."""

from dataclasses import dataclass

from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.contact_law import Flags


@dataclass(frozen=True)
class State:
    """A ``load`` (N, along the direction of loading) that is carried.

    ``displacement``: the one that the load does work on, in m. ``force``: (N, 3) in N, on the piece
    above in the frame of the face, see `sidmacib.mechanics.equilibrium.face_frames`. ``bonded``:
    (N,). Each is None if the model does not give it.
    """

    load: float
    displacement: float | None = None
    force: Floats | None = None
    bonded: Flags | None = None


@dataclass(frozen=True)
class Outcome:
    """States on the way, the last of them the capacity, and loads in N.

    ``failed_load``: the smallest load known not to be carried. ``first_failure_load``: where the
    first node fails; None in a model without failure. ``mode``: how the joint gives way; None if
    the model does not say. ``peak_spread``: of the peaks that were found, see
    `sidmacib.mechanics.static.lowest_peak`. ``peak_load``: of the peak; None in a model without
    one.
    """

    path: tuple[State, ...]
    failed_load: float
    first_failure_load: float | None = None
    mode: str | None = None
    peak_spread: float | None = None
    peak_load: float | None = None
