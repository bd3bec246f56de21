"""Search the peak of an assembly with an engine, beginning at the loads of the static model.

Its script is rendered and executed; its files are read, checked and kept.
"""

import contextlib
import importlib
import json
import math
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from sidmacib.engines import Engine, Numerics, engine_environment
from sidmacib.engines.render import DATA_FILE, MODULES, write_script
from sidmacib.engines.results import check_bracket, check_first_failure, read_outcome
from sidmacib.engines.scripts.assembly import Guide
from sidmacib.engines.scripts.children import ENDS_WITH_PARENT
from sidmacib.engines.scripts.records import NO_ANSWER, OUTPUTS, RESULT
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Cuboid, Face, Failure, Kind, Loads
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import compliance
from sidmacib.mechanics.static import static_peak
from sidmacib.model import Ability
from sidmacib.problem import Outcome, Problem
from sidmacib.structure.loads import SupportMotion

HOUR = 3600.0  # s
USUAL = Numerics()
TAIL_LINES = 20
KILLED_WITHIN = 128 + signal.SIGKILL  # exit code of a script whose program was killed


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
    keeps nothing. Raises `sidmacib.engines.run.EngineError` if the engine is not installed,
    cannot compute such an assembly or finds no peak, and `sidmacib.errors.ResultError` if what it
    found cannot be right.
    """
    if folder is None:
        with tempfile.TemporaryDirectory() as name:
            return engine_outcome(engine, problem, numerics, title, Path(name), time_limit)
    guide = run_engine(engine, problem, numerics, title, folder, time_limit)
    outcome = read_outcome(folder, problem.assembly)
    check_bracket(outcome, numerics.tolerance, numerics.first_increment * problem.loads.scale)
    joint = all(isinstance(piece, Cuboid) for piece in problem.assembly.pieces)
    if guide and joint:  # blocks of a structure may slide or rock at any load
        check_first_failure(outcome, guide.first_failure_N)
    return outcome


def guide_of(assembly: Assembly, loads: Loads) -> Guide | None:
    """Failure loads of the static model, with the digits that matter; None without one."""
    if assembly.failure is not Failure.BRITTLE:
        return None
    try:
        if loads.axis is None:
            found = static_peak(assembly, loads)
            first, peak = found.first_failure_load, found.peak.load
        else:
            # Imported here: it needs scipy.sparse, which joints do not.
            tilt = importlib.import_module("sidmacib.structure.analysis.tilt")
            turned = tilt.static_tilt(assembly, loads)
            angles = turned.first_failure, turned.angle
            first, peak = (tilt.load_of_tilt(angle, loads) for angle in angles)
    except CapacityError:
        return None
    return Guide(float(f"{first:.4g}"), float(f"{peak:.4g}")) if peak > 0.0 else None


def run_engine(
    engine: Engine,
    problem: Problem,
    numerics: Numerics,
    title: str,
    folder: Path,
    time_limit: float,
) -> Guide | None:
    """Search the peak of ``problem`` for at most ``time_limit`` s; where the search started.

    None if ``numerics`` or the engine want no guide, or the static model gives none. Leaves in
    ``folder`` the script with all that it needs, the engine's log, and its results. Raises
    `EngineError` if the engine cannot compute such an assembly, or ends without a result.
    """
    if reason := refusal(engine, *problem):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    if isinstance(problem.loads, SupportMotion):
        problem.loads.require_proportional()
    if not engine.elastic and (reason := _soft_contacts(problem, numerics)):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    guide = guide_of(*problem) if numerics.guided and "guided" in engine.reads else None
    write_script(engine, *problem, numerics, title, folder, guide)
    execute(engine, folder, time_limit)
    return guide


def refusal(engine: Engine, assembly: Assembly, loads: Loads | None = None) -> str | None:
    """Why the engine cannot compute ``assembly``, or ``loads`` on it; None if it can."""
    beside = getattr(loads, "beside", None)  # of a structure
    if loads is not None and loads.axis is not None and beside and beside.wrenches.any():
        return "gravity turns beside other permanent loads; engines turn all permanent loads"
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
    if any(each is not engine.elastic for each in deforms):
        kinds = ("rigid", "elastic") if engine.elastic else ("elastic", "rigid")
        return f"pieces are {kinds[0]}; this engine models only {kinds[1]} pieces"
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
    if crushed := crushed_faces(assembly):
        return f"{crushed[0][1].name} has a compressive_strength; no engine models crushing"
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


class EngineError(RuntimeError):
    """The engine did not end with a result; the message says why, with the tail of its log."""

    @property
    def in_short(self) -> str:
        """The reason on one line: how the engine ended, and the last line of its log."""
        first, *log = str(self).splitlines()
        ending = first.partition("; end of ")[0]
        return f"{ending}: {log[-1].strip(' |')}" if log else ending


class EngineNoAnswerError(EngineError):
    """The engine said why there is no result, and would say so again."""


class EngineKilledError(EngineError):
    """The engine was killed, probably because memory ran out."""


def execute(engine: Engine, folder: Path, time_limit: float) -> None:
    """Run the script in ``folder`` for at most ``time_limit`` s; results are put beside it.

    The engine works in a scratch folder; its log stays as ``engine.log``. However this process
    ends, the engine ends with it. Raises `EngineError` if the program is missing, fails, is killed,
    runs out of time or ends without a peak.
    """
    for name in OUTPUTS:
        (folder / name).unlink(missing_ok=True)
    for left in folder.glob("running-*"):  # by a run that was killed, and may just be ending
        shutil.rmtree(left, ignore_errors=True)
    if missing := engine.missing():
        raise EngineError(missing)
    log = folder / "engine.log"
    scratch_folder = tempfile.TemporaryDirectory(
        dir=folder, prefix="running-", ignore_cleanup_errors=True
    )
    with scratch_folder as name:
        scratch = Path(name)
        for file in (engine.script, DATA_FILE):
            shutil.copy(folder / file, scratch)
        shutil.copytree(folder / MODULES.name, scratch / MODULES.name)
        _run([*engine.command, engine.script], scratch, log, time_limit)
        _check(scratch, log)
        for file in OUTPUTS:
            (scratch / file).replace(folder / file)


def _run(command: list[str], folder: Path, log: Path, time_limit: float) -> None:
    """Run ``command`` in a separate process group, which ends with this process."""
    with log.open("w") as stream:
        process = subprocess.Popen(
            [*ENDS_WITH_PARENT, *command],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env=engine_environment(OMP_NUM_THREADS="1"),
        )
        try:
            status = process.wait(time_limit)
        except subprocess.TimeoutExpired:
            raise EngineError(_with_tail(f"out of time after {time_limit:g} s", log)) from None
        finally:
            _end(process)
    if status in (-signal.SIGKILL, KILLED_WITHIN):
        raise EngineKilledError(_with_tail("killed by signal 9", log))
    if status == NO_ANSWER:
        raise EngineNoAnswerError(_with_tail("no answer", log))
    if status < 0:
        raise EngineError(_with_tail(f"killed by signal {-status}", log))
    if status > 0:
        raise EngineError(_with_tail(f"ended with exit code {status}", log))


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process group, first by SIGTERM, after which mpirun ends its ranks itself."""
    for number, patience in ((signal.SIGTERM, 5.0), (signal.SIGKILL, 1.0)):
        deadline = time.monotonic() + patience
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, number)
            while time.monotonic() < deadline:
                process.poll()
                os.killpg(process.pid, 0)  # until nobody is left
                time.sleep(0.02)


def _check(folder: Path, log: Path) -> None:
    for name in OUTPUTS:
        if not (folder / name).is_file():
            raise EngineError(_with_tail(f"ended without {name}", log))
    try:
        result = json.loads((folder / RESULT).read_text())
        peak, failed = result["peak_load_N"], result["failed_load_N"]
        sound = 0.0 < peak <= failed and math.isfinite(failed)
    except (ValueError, KeyError, TypeError, RecursionError):
        raise EngineError(_with_tail("ended with an unreadable result.json", log)) from None
    if not sound:
        raise EngineError(
            _with_tail(f"ended without a peak: it carries {peak} N and fails at {failed} N", log)
        )


def _with_tail(reason: str, log: Path) -> str:
    tail = log.read_text(errors="replace").splitlines()[-TAIL_LINES:]
    return "\n".join([f"{reason}; end of {log}:", *(f"  | {line}" for line in tail)])
