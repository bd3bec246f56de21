"""Search the peak of an assembly with an engine, beginning at the loads of the static model."""

import importlib
import tempfile
from pathlib import Path

from sidmacib.engines.engine import Engine
from sidmacib.engines.numerics import Numerics
from sidmacib.engines.results import check_bracket, check_first_failure, read_outcome
from sidmacib.engines.run import refusal, run_engine
from sidmacib.engines.scripts.assembly import Guide
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Cuboid, Failure, Loads
from sidmacib.mechanics.static.model import static_peak
from sidmacib.problem import Outcome, Problem

HOUR = 3600.0  # s
USUAL = Numerics()


def engine_outcome(
    engine: Engine,
    problem: Problem,
    numerics: Numerics = USUAL,
    title: str = "Assembly.",
    folder: Path | None = None,
    time_limit: float = HOUR,
) -> Outcome:
    """The path of ``problem`` to its peak in ``engine``, after at most ``time_limit`` s.

    ``folder``: keeps the script with all that it needs, the engine's log and its results; None
    keeps nothing. Raises `sidmacib.engines.execute.EngineError` if the engine is not installed,
    cannot compute such an assembly or finds no peak, and `sidmacib.errors.ResultError` if what it
    found cannot be right.
    """
    if folder is None:
        with tempfile.TemporaryDirectory() as name:
            return engine_outcome(engine, problem, numerics, title, Path(name), time_limit)
    guide = guide_for(engine, problem, numerics)
    run_engine(engine, problem, numerics, title, folder, time_limit, guide)
    outcome = read_outcome(folder, problem.assembly)
    check_bracket(outcome, numerics.tolerance, numerics.first_increment * problem.loads.scale)
    joint = all(isinstance(piece, Cuboid) for piece in problem.assembly.pieces)
    if guide and joint:  # blocks of a structure may slide or rock at any load
        check_first_failure(outcome, guide.first_event_N)
    return outcome


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
