"""Where an engine looks first: the static model's answer, which stands beside the engine's anyway.

Apart from `workflow.engines.render`, so that whoever only plans loads no compiled model.
"""

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.static.model import static_peak
from workflow.engines.scripts.assembly import Guide


def guide_of(assembly: Assembly, loads: Loads) -> Guide | None:
    """Where the static model expects failure, roughly; None where it expects nothing."""
    if assembly.failure is not Failure.BRITTLE:
        return None
    try:
        found = static_peak(assembly, loads)
    except CapacityError:
        return None
    if found.peak.load <= 0.0:
        return None
    return Guide(_roughly(found.first_failure_load), _roughly(found.peak.load))


def _roughly(value: float) -> float:
    """``value`` with the digits that matter to a search."""
    return float(f"{value:.4g}")
