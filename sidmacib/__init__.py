"""Models of interlocking masonry joints with several locks under torsion and shear."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # the same names again, for type checkers and completion
    from sidmacib.contact_points.envelope import Envelope, envelope
    from sidmacib.contact_points.options import OPTIONS, READY_OPTIONS, ContactOption
    from sidmacib.contact_points.programme import Capacity, Sidmacib, capacities, capacity
    from sidmacib.errors import CapacityError, InfeasibleError, SolverError, UnboundedError
    from sidmacib.joint.effects import Effect, Sensitivity, sensitivity
    from sidmacib.joint.hold_down import HoldDown
    from sidmacib.joint.joint import Block, Direction, Joint, OwnLock, UpperBody
    from sidmacib.joint.loading import Loading, lateral_load
    from sidmacib.joint.pieces import assemble
    from sidmacib.joint.weights import lock_weights
    from sidmacib.mechanics.assembly import Assembly, Elastic, FaceMaterial, Loads, NodeLayout
    from sidmacib.mechanics.limit import limit_load
    from sidmacib.mechanics.limit_sensitivity import limit_derivatives
    from sidmacib.mechanics.static.lowest_peak import lowest_peak
    from sidmacib.mechanics.static.model import static_first_failure, static_peak
    from sidmacib.rule.demand import Candidate, Demand, Prices
    from sidmacib.rule.inverse import Search, all_candidates, cheapest, fewest_locks
    from sidmacib.rule.law import LawCapacity, law, safe
    from sidmacib.rule.pairs import Pairs, pairs_of
    from sidmacib.structure.analysis.vertices import vertex_effects

# Where each public name is: a module is imported when one of its names is first used, as solvers
# take longer to import than most models take to run.
_HOME = {
    "OPTIONS": "contact_points.options",
    "READY_OPTIONS": "contact_points.options",
    "Assembly": "mechanics.assembly",
    "Block": "joint.joint",
    "Candidate": "rule.demand",
    "Capacity": "contact_points.programme",
    "CapacityError": "errors",
    "ContactOption": "contact_points.options",
    "Demand": "rule.demand",
    "Direction": "joint.joint",
    "Effect": "joint.effects",
    "Elastic": "mechanics.assembly",
    "Envelope": "contact_points.envelope",
    "FaceMaterial": "mechanics.assembly",
    "HoldDown": "joint.hold_down",
    "InfeasibleError": "errors",
    "Joint": "joint.joint",
    "LawCapacity": "rule.law",
    "Loading": "joint.loading",
    "Loads": "mechanics.assembly",
    "NodeLayout": "mechanics.assembly",
    "OwnLock": "joint.joint",
    "Pairs": "rule.pairs",
    "Prices": "rule.demand",
    "Search": "rule.inverse",
    "Sensitivity": "joint.effects",
    "Sidmacib": "contact_points.programme",
    "SolverError": "errors",
    "UnboundedError": "errors",
    "UpperBody": "joint.joint",
    "all_candidates": "rule.inverse",
    "assemble": "joint.pieces",
    "capacities": "contact_points.programme",
    "capacity": "contact_points.programme",
    "cheapest": "rule.inverse",
    "envelope": "contact_points.envelope",
    "fewest_locks": "rule.inverse",
    "lateral_load": "joint.loading",
    "law": "rule.law",
    "limit_derivatives": "mechanics.limit_sensitivity",
    "limit_load": "mechanics.limit",
    "lock_weights": "joint.weights",
    "lowest_peak": "mechanics.static.lowest_peak",
    "pairs_of": "rule.pairs",
    "safe": "rule.law",
    "sensitivity": "joint.effects",
    "static_first_failure": "mechanics.static.model",
    "static_peak": "mechanics.static.model",
    "vertex_effects": "structure.analysis.vertices",
}

__all__ = [
    "OPTIONS",
    "READY_OPTIONS",
    "Assembly",
    "Block",
    "Candidate",
    "Capacity",
    "CapacityError",
    "ContactOption",
    "Demand",
    "Direction",
    "Effect",
    "Elastic",
    "Envelope",
    "FaceMaterial",
    "HoldDown",
    "InfeasibleError",
    "Joint",
    "LawCapacity",
    "Loading",
    "Loads",
    "NodeLayout",
    "OwnLock",
    "Pairs",
    "Prices",
    "Search",
    "Sensitivity",
    "Sidmacib",
    "SolverError",
    "UnboundedError",
    "UpperBody",
    "all_candidates",
    "assemble",
    "capacities",
    "capacity",
    "cheapest",
    "envelope",
    "fewest_locks",
    "lateral_load",
    "law",
    "limit_derivatives",
    "limit_load",
    "lock_weights",
    "lowest_peak",
    "pairs_of",
    "safe",
    "sensitivity",
    "static_first_failure",
    "static_peak",
    "vertex_effects",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__
