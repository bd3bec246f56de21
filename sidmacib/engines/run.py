"""Search the peak of an assembly with an engine, beginning at the loads of the static model.

Its script is rendered and executed; its files are read, checked and kept.
"""

import contextlib
import importlib
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from sidmacib.engines import Engine, Numerics, engine_environment
from sidmacib.engines.render import DATA_FILE, MODULES, write_script
from sidmacib.engines.results import check_first_failure, read_outcome
from sidmacib.engines.scripts.assembly import GivenMaterial, Guide
from sidmacib.engines.scripts.children import ENDS_WITH_PARENT
from sidmacib.engines.scripts.records import NO_ANSWER, OUTPUTS
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import OF_BONDS, Assembly, Cuboid, FaceMaterial, Failure, Kind
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.equilibrium import compliance
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.static import static_peak
from sidmacib.model import Ability
from sidmacib.problem import Outcome, Problem
from sidmacib.structure.loads import SupportMotion
from sidmacib.validation import kinds_of

HOUR = 3600.0  # s
# Numbers of a law that no script reads; bonds that soften are refused as a whole.
NOT_GIVEN = [
    each for each in kinds_of(FaceMaterial) if each not in {*kinds_of(GivenMaterial), *OF_BONDS}
]
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
    assembly, loads = problem
    if reason := refusal(engine, assembly, loads):
        raise EngineNoAnswerError(f"{engine.name}: {reason}")
    if isinstance(loads, SupportMotion):
        loads.require_proportional()
    if not engine.elastic:
        moved = compliance(*problem) * loads.scale / assembly.length
        if moved > numerics.collapse_share:
            raise EngineNoAnswerError(
                f"{engine.name}: contacts are so soft that the load moves the pieces by "
                f"{moved:.2g} of their size; this engine takes more than "
                f"{numerics.collapse_share:g} for a collapse"
            )
    guide = guide_of(*problem) if numerics.guided and "guided" in engine.reads else None
    write_script(engine, *problem, numerics, title, folder, guide)
    execute(engine, folder, time_limit)
    outcome = read_outcome(folder, assembly)
    joint = all(isinstance(piece, Cuboid) for piece in assembly.pieces)
    if guide and joint:  # blocks of a structure may slide or rock at any load
        check_first_failure(outcome, guide.first_failure_N)
    return outcome


def guide_of(assembly: Assembly, loads: Loads) -> Guide | None:
    """Failure loads of the static model, with the digits that matter; None without one."""
    if assembly.failure is not Failure.BRITTLE:
        return None
    try:
        if loads.raised.axis:
            # Imported here: it needs scipy.sparse, which joints do not.
            tilt = importlib.import_module("sidmacib.structure.analysis.tilt")
            turned = tilt.static_tilt(assembly, loads)
            first, peak = map(loads.raised.newtons, (turned.first_failure, turned.angle))
        else:
            found = static_peak(assembly, loads)
            first, peak = found.first_failure_load, found.peak.load
    except CapacityError:
        return None
    return Guide(float(f"{first:.4g}"), float(f"{peak:.4g}")) if peak > 0.0 else None


def refusal(engine: Engine, assembly: Assembly, loads: Loads | None = None) -> str | None:
    """Why the engine cannot compute ``assembly``, or ``loads`` on it; None if it can."""
    return next(_refusals(engine, assembly, loads), None)


def _refusals(engine: Engine, assembly: Assembly, loads: Loads | None) -> Iterator[str]:
    beside = getattr(loads, "beside", None)  # of a structure
    if loads is not None and loads.raised.axis and beside and beside.wrenches.any():
        yield "gravity turns beside other permanent loads; engines turn all permanent loads"
    if engine.elastic and not all(isinstance(piece, Cuboid) for piece in assembly.pieces):
        yield "pieces are polyhedra; this engine models only cuboids along the axes"
    for _, crushed, _ in crushed_faces(assembly):
        yield f"{crushed.name} has a compressive_strength; no engine models crushing"
    if reason := assembly.without_stiffness:
        yield reason
    bonds = f"inner faces are {assembly.failure}"
    if assembly.failure is Failure.SOFTENING:
        yield f"{bonds}; no engine models softening bonds; use the static model"
    if Ability.DUCTILE not in engine.abilities and assembly.failure is not Failure.BRITTLE:
        yield f"{bonds}; this engine models only {Failure.BRITTLE} ones"
    deforms = [piece.elastic is not None for piece in assembly.pieces if not piece.fixed]
    if any(each is not engine.elastic for each in deforms):
        kinds = ("rigid", "elastic") if engine.elastic else ("elastic", "rigid")
        yield f"pieces are {kinds[0]}; this engine models only {kinds[1]} pieces"
    for face in assembly.faces:
        law, inner = face.material, face.kind is Kind.INNER
        for name in NOT_GIVEN:
            if value := getattr(law, name):
                yield f"{face.name} has a {name} of {value:g}; it must be 0"
        if inner and law.needs_in_bonds and Ability.BOND_FRICTION not in engine.abilities:
            given = f"{face.name} has a bond_friction of {law.friction_in_bonds:g}"
            yield f"{given}; it must be {law.needs_in_bonds}"
        unequal = law.normal_stiffness != law.shear_stiffness
        if inner and unequal and Ability.TWO_STIFFNESSES not in engine.abilities:
            yield (
                f"{face.name} has a normal stiffness of {law.normal_stiffness:g} Pa/m and a shear "
                f"stiffness of {law.shear_stiffness:g} Pa/m; inner faces must have one stiffness"
            )


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
    log, kind = folder / "engine.log", EngineError
    scratch_folder = tempfile.TemporaryDirectory(
        dir=folder, prefix="running-", ignore_cleanup_errors=True
    )
    with scratch_folder as name:
        scratch = Path(name)
        for file in (engine.script, DATA_FILE):
            shutil.copy(folder / file, scratch)
        shutil.copytree(folder / MODULES.name, scratch / MODULES.name)
        status = _run([*engine.command, engine.script], scratch, log, time_limit)
        lacking = [file for file in OUTPUTS if not (scratch / file).is_file()]
        if status is None:
            reason = f"out of time after {time_limit:g} s"
        elif status in (-signal.SIGKILL, KILLED_WITHIN):
            kind, reason = EngineKilledError, "killed by signal 9"
        elif status == NO_ANSWER:
            kind, reason = EngineNoAnswerError, "no answer"
        elif status < 0:
            reason = f"killed by signal {-status}"
        elif status > 0:
            reason = f"ended with exit code {status}"
        elif lacking:
            reason = f"ended without {lacking[0]}"
        else:
            for file in OUTPUTS:
                (scratch / file).replace(folder / file)
            return
    tail = log.read_text(errors="replace").splitlines()[-TAIL_LINES:]
    raise kind("\n".join([f"{reason}; end of {log}:", *(f"  | {line}" for line in tail)]))


def _run(command: list[str], folder: Path, log: Path, time_limit: float) -> int | None:
    """Exit code of ``command``, run in a separate process group; None if it is out of time."""
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
            return process.wait(time_limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            _end(process)


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
