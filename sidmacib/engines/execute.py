"""Run an engine on a rendered case; its files are kept only if it succeeds."""

import contextlib
import json
import math
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from sidmacib.engines.engine import Engine, engine_environment
from sidmacib.engines.render import DATA_FILE, MODULES
from sidmacib.engines.scripts.children import ENDS_WITH_PARENT
from sidmacib.engines.scripts.records import NO_ANSWER, OUTPUTS, RESULT

TAIL_LINES = 20
KILLED_WITHIN = 128 + signal.SIGKILL  # exit code of a script whose program was killed


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
            if not _ends_within(process.pid, time_limit):
                raise EngineError(_with_tail(f"out of time after {time_limit:g} s", log))
            status = process.wait()
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


def _ends_within(pid: int, time_limit: float) -> bool:
    """Wait for a process, without the polling of `Popen.wait`, for at most ``time_limit`` s."""
    handle = os.pidfd_open(pid)
    try:
        return bool(select.select([handle], [], [], time_limit)[0])
    finally:
        os.close(handle)


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
