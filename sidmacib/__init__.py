"""Models of interlocking masonry joints with several locks under torsion and shear."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the same names again, for type checkers and completion
    from sidmacib.contact_points import OPTIONS, ContactOption
    from sidmacib.errors import CapacityError, InfeasibleError, SolverError, UnboundedError
    from sidmacib.joint import Direction, Joint
    from sidmacib.loading import Loading, lateral_load
    from sidmacib.mechanics.assembly import Assembly, Elastic, FaceMaterial, Loads, NodeLayout
    from sidmacib.mechanics.limit import limit_load
    from sidmacib.mechanics.static import static_peak
    from sidmacib.pieces import assemble
    from sidmacib.polygon import Envelope, envelope
    from sidmacib.programme import Capacity, Sidmacib, capacities, capacity

# Where each public name is: a module is imported when one of its names is first used, as solvers
# take longer to import than most models take to run.
_HOME = {
    "OPTIONS": "contact_points",
    "Assembly": "mechanics.assembly",
    "Capacity": "programme",
    "CapacityError": "errors",
    "ContactOption": "contact_points",
    "Direction": "joint",
    "Elastic": "mechanics.assembly",
    "Envelope": "polygon",
    "FaceMaterial": "mechanics.assembly",
    "InfeasibleError": "errors",
    "Joint": "joint",
    "Loading": "loading",
    "Loads": "mechanics.assembly",
    "NodeLayout": "mechanics.assembly",
    "Sidmacib": "programme",
    "SolverError": "errors",
    "UnboundedError": "errors",
    "assemble": "pieces",
    "capacities": "programme",
    "capacity": "programme",
    "envelope": "polygon",
    "lateral_load": "loading",
    "limit_load": "mechanics.limit",
    "static_peak": "mechanics.static",
}

__all__ = [
    "OPTIONS",
    "Assembly",
    "Capacity",
    "CapacityError",
    "ContactOption",
    "Direction",
    "Elastic",
    "Envelope",
    "FaceMaterial",
    "InfeasibleError",
    "Joint",
    "Loading",
    "Loads",
    "NodeLayout",
    "Sidmacib",
    "SolverError",
    "UnboundedError",
    "assemble",
    "capacities",
    "capacity",
    "envelope",
    "lateral_load",
    "limit_load",
    "static_peak",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
