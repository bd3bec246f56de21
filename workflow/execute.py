"""Run an engine on a rendered case; what it writes counts only if it ends well."""

import argparse
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from workflow.engines import ENGINES, Engine
from workflow.render import DATA_FILE
from workflow.results import OUTPUTS

TAIL_LINES = 20


class EngineError(RuntimeError):
    """The engine did not end with a result; the message says why, with the tail of its log."""


def execute(engine: Engine, folder: Path, time_limit: float) -> None:
    """Run the script in ``folder`` for at most ``time_limit`` s and put its results beside it.

    The engine works in a scratch folder; its log stays as ``engine.log``. Raises `EngineError` if
    the program is missing, fails, is killed, runs out of time or ends without a peak.
    """
    for name in OUTPUTS:
        (folder / name).unlink(missing_ok=True)
    for left in folder.glob("running-*"):  # by a run that was killed
        shutil.rmtree(left)
    if missing := engine.missing():
        raise EngineError(missing)
    log = folder / "engine.log"
    with tempfile.TemporaryDirectory(dir=folder, prefix="running-") as scratch:
        for name in (engine.script, DATA_FILE):
            shutil.copy(folder / name, scratch)
        _run([*engine.command, engine.script], Path(scratch), log, time_limit)
        _check(Path(scratch), log)
        for name in OUTPUTS:
            (Path(scratch) / name).replace(folder / name)


def _run(command: list[str], folder: Path, log: Path, time_limit: float) -> None:
    """Run ``command`` in a process group of its own, which ends with this process."""
    with log.open("w") as stream:
        process = subprocess.Popen(
            command,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        try:
            status = process.wait(time_limit)
        except subprocess.TimeoutExpired:
            raise EngineError(_with_tail(f"out of time after {time_limit:g} s", log)) from None
        finally:
            _end(process)
    if status < 0:
        raise EngineError(_with_tail(f"killed by signal {-status}", log))
    if status > 0:
        raise EngineError(_with_tail(f"ended with exit code {status}", log))


def _end(process: subprocess.Popen[bytes]) -> None:
    """End what is left of the process group: asked first, as mpirun then ends its ranks itself."""
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
        peak = json.loads((folder / "result.json").read_text())["peak_load_N"]
    except (ValueError, KeyError):
        raise EngineError(_with_tail("ended with an unreadable result.json", log)) from None
    if not peak > 0:
        raise EngineError(_with_tail(f"ended without a peak: load {peak} N", log))


def _with_tail(reason: str, log: Path) -> str:
    tail = log.read_text(errors="replace").splitlines()[-TAIL_LINES:]
    return "\n".join([f"{reason}; end of {log}:", *(f"  | {line}" for line in tail)])


def main() -> None:
    """Command line: engine, folder of the case, time limit in s."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("engine", choices=ENGINES)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--time-limit", type=float, required=True, metavar="S")
    arguments = parser.parse_args()
    for number in (signal.SIGTERM, signal.SIGHUP):  # the engine ends with this process
        signal.signal(number, lambda *_: sys.exit("stopped"))
    try:
        execute(ENGINES[arguments.engine], arguments.folder, arguments.time_limit)
    except EngineError as error:
        sys.exit(f"{arguments.folder.name}: {arguments.engine} {error}")


if __name__ == "__main__":
    main()
