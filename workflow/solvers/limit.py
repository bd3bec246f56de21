"""Limit analysis of all pieces, without friction."""

from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load
from workflow.outcome import Outcome, State


def solve(assembly: Assembly, loads: Loads) -> Outcome:
    """The largest load that forces can balance; `sidmacib.errors.CapacityError` if none is."""
    found = limit_load(assembly, loads)
    state = State(found.load, force=found.force, bonded=ContactLaw.of(assembly).cohesive)
    return Outcome((state,), failed_load=found.load)
