"""The start of an engine's search, from the static model, which the study runs in any case.

Apart from `workflow.engines.render`, so that whoever only plans loads no compiled model.
"""

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.static.model import static_peak
from sidmacib.structure.analysis.tilt import Tilt, load_of_tilt, static_tilt
from workflow.engines.scripts.assembly import Guide


def guide_of(assembly: Assembly, loads: Loads) -> Guide | None:
    """Failure loads of the static model, roughly; None without one."""
    if assembly.failure is not Failure.BRITTLE:
        return None
    try:
        first, peak = _failures(assembly, loads)
    except CapacityError:
        return None
    if peak <= 0.0:
        return None
    return Guide(_roughly(first), _roughly(peak))


def _failures(assembly: Assembly, loads: Loads) -> tuple[float, float]:
    """Loads (N) of the first failure and the peak in the static model, which may raise."""
    if loads.axis is None:
        found = static_peak(assembly, loads)
        return found.first_failure_load, found.peak.load
    tilt = static_tilt(assembly, Tilt(loads.axis))
    return load_of_tilt(tilt.first_failure, loads), load_of_tilt(tilt.angle, loads)


def _roughly(value: float) -> float:
    """``value`` with the digits that matter to a search."""
    return float(f"{value:.4g}")
