"""The start of an engine's search: failure loads of the static model, roughly.

Apart from `sidmacib.engines.run`, so that whoever plans or runs an engine loads no compiled model.
"""

import importlib

from sidmacib.engines.engine import Engine
from sidmacib.engines.numerics import Numerics
from sidmacib.engines.run import refusal
from sidmacib.engines.scripts.assembly import Guide
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Failure, Loads
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Problem


def guide_for(engine: Engine, problem: Problem, numerics: Numerics) -> Guide | None:
    """The start of the search of ``engine``; None if ``numerics`` or the engine want no guide."""
    if not engine.wants_guide(numerics) or refusal(engine, problem.assembly):
        return None
    return guide_of(*problem)


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
    # Imported here: it needs scipy.sparse, which joints do not.
    tilt = importlib.import_module("sidmacib.structure.analysis.tilt")
    found = tilt.static_tilt(assembly, tilt.Tilt(loads.axis))
    return tilt.load_of_tilt(found.first_failure, loads), tilt.load_of_tilt(found.angle, loads)


def _roughly(value: float) -> float:
    """``value`` with the digits that matter to a search."""
    return float(f"{value:.4g}")
