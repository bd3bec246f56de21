"""Search the peak of an assembly with an engine, beginning at the loads of the static model.

Its script is rendered and executed; its files are read, checked and kept.
"""

import importlib
import tempfile
from pathlib import Path

from sidmacib.engines.engine import Engine, Numerics
from sidmacib.engines.execute import EngineNoAnswerError, execute
from sidmacib.engines.render import write_script
from sidmacib.engines.results import check_bracket, check_first_failure, read_outcome
from sidmacib.engines.scripts.assembly import Guide
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Cuboid, Face, Failure, Kind, Loads
from sidmacib.mechanics.springs import compliance
from sidmacib.mechanics.static.model import static_peak
from sidmacib.model import Ability
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


def run_engine(
    engine: Engine,
    problem: Problem,
    numerics: Numerics,
    title: str,
    folder: Path,
    time_limit: float,
    guide: Guide | None,
) -> None:
    """Search the peak of ``problem`` for at most ``time_limit`` s, from the ``guide`` if any.

    Leaves in ``folder`` the script with all that it needs, the engine's log, and its results.
    Raises `EngineError` if the engine cannot compute such an assembly, or ends without a result.
    """
    if reason := refusal(engine, problem.assembly):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    if not engine.elastic and (reason := _soft_contacts(problem, numerics)):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    write_script(engine, *problem, numerics, title, folder, guide)
    execute(engine, folder, time_limit)


def refusal(engine: Engine, assembly: Assembly) -> str | None:
    """Why the engine cannot compute ``assembly``; None if it can."""
    if reason := _structure_refusal(engine, assembly):
        return reason
    if assembly.failure is Failure.SOFTENING:
        return (
            f"inner faces are {assembly.failure}; no engine models softening bonds; use "
            "the static model"
        )
    if Ability.DUCTILE not in engine.abilities and assembly.failure is not Failure.BRITTLE:
        return f"inner faces are {assembly.failure}; this engine models only {Failure.BRITTLE} ones"
    deforms = [piece.elastic is not None for piece in assembly.pieces if not piece.fixed]
    if engine.elastic and not all(deforms):
        return "pieces are rigid; this engine models only elastic pieces"
    if any(deforms) and not engine.elastic:
        return "pieces are elastic; this engine models only rigid pieces"
    reasons = (_bond_refusal(engine, face) for face in assembly.faces if face.kind is Kind.INNER)
    return next(filter(None, reasons), None)


def _soft_contacts(problem: Problem, numerics: Numerics) -> str | None:
    """Why the contacts are too soft for distinct elements; None if they are not."""
    moved = compliance(*problem) * problem.loads.scale / problem.assembly.length
    if moved <= numerics.collapse_share:
        return None
    return (
        f"contacts are so soft that the load moves the pieces by {moved:.2g} of their size; this "
        f"engine takes more than {numerics.collapse_share:g} for a collapse"
    )


def _structure_refusal(engine: Engine, assembly: Assembly) -> str | None:
    """Why the engine cannot compute pieces or faces of this kind; None if it can."""
    if engine.elastic and not all(isinstance(piece, Cuboid) for piece in assembly.pieces):
        return "pieces are polyhedra; this engine models only cuboids along the axes"
    return assembly.without_stiffness


def _bond_refusal(engine: Engine, face: Face) -> str | None:
    """Why the engine cannot compute an inner face; None if it can."""
    law = face.material
    if law.bond_friction:
        return f"{face.name} has a bond_friction of {law.bond_friction:g}; it must be 0"
    unequal = law.normal_stiffness != law.shear_stiffness
    if unequal and Ability.TWO_STIFFNESSES not in engine.abilities:
        return (
            f"{face.name} has a normal stiffness of {law.normal_stiffness:g} Pa/m and a shear "
            f"stiffness of {law.shear_stiffness:g} Pa/m; inner faces must have one stiffness"
        )
    return None
