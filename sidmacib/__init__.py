"""Models of interlocking masonry joints with several locks under torsion and shear."""

from sidmacib.capacity import (
    Capacity,
    CapacityError,
    InfeasibleError,
    Sidmacib,
    SolverError,
    UnboundedError,
    capacities,
    capacity,
)
from sidmacib.contact_points import OPTIONS, ContactOption
from sidmacib.envelope import Envelope, envelope
from sidmacib.joint import Direction, FaceMaterial, Joint

__all__ = [
    "OPTIONS",
    "Capacity",
    "CapacityError",
    "ContactOption",
    "Direction",
    "Envelope",
    "FaceMaterial",
    "InfeasibleError",
    "Joint",
    "Sidmacib",
    "SolverError",
    "UnboundedError",
    "capacities",
    "capacity",
    "envelope",
]
