"""Run one job of a study: do its step, then write its receipt.

Snakemake starts this with a file that holds all arguments, however many. The job ends when the
process that started it ends, so that nothing goes on unseen.
"""

import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from workflow.planning.closure import edited
from workflow.planning.receipts import write_receipt
from workflow.run.attempts import STOPPED, KilledError, Settled, begin, end

PR_SET_PDEATHSIG = 1
SIGNALS = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
SELF, CHILDREN = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
KEYS = ("wall_s", "own_cpu_s", "programs_cpu_s")
TIMES = ".times"  # below the results folder: what jobs took, and nothing depends on it


def end_with_parent() -> None:
    """Have the system end this process when the one that started it ends, however that happens."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it has ended in the meantime
        sys.exit(STOPPED)


def run_job(plan: dict[str, Any]) -> None:
    """Do the job that ``plan`` describes as plain data, and leave a receipt if it has a result."""
    if edited(plan["code"]):
        sys.exit(f"{plan['name']}: the code was edited during the run; start it again")
    results = Path(plan["results"])
    receipt = results / plan["receipt"]
    receipt.unlink(missing_ok=True)
    inputs, outputs = (paths(plan[key], results) for key in ("inputs", "outputs"))
    written = [path for files in outputs.values() for path in _listed(files)]
    for path in written:
        path.parent.mkdir(parents=True, exist_ok=True)
    step = importlib.import_module(plan["step"])
    error = step.run({**plan["arguments"], **plan["settings"]}, inputs, outputs)
    if error:  # the results say so too
        print(error, file=sys.stderr)
        if not all(path.exists() for path in written):
            sys.exit(1)
        if not isinstance(error, Settled):  # without a receipt the next run tries again
            return
    also = () if error else plan["also"]
    made = (*(str(path.relative_to(results)) for path in written), *also)
    write_receipt(receipt, plan["name"], plan["digest"], results, made)


def paths(files: Mapping[str, str | Sequence[str]], results: Path) -> dict[str, Any]:
    """Inputs or outputs of a step by name, each a path or a list of paths."""
    return {
        name: results / value if isinstance(value, str) else [results / path for path in value]
        for name, value in files.items()
    }


def _listed(files: Path | list[Path]) -> list[Path]:
    return [files] if isinstance(files, Path) else files


# Snakemake's `benchmark:` looks at processes from time to time instead: it has no CPU time of a job
# that ends before the first look, loses that of programs which begin and end between two looks, and
# does not keep a job and its programs apart.
def write_times(path: Path, start: float) -> None:
    """Write the time since ``start`` (s) and the CPU time (s) of the job and of its programs.

    Also the largest memory (MB) of the job, and of the largest of its programs.
    """
    python, programs = (resource.getrusage(who) for who in (SELF, CHILDREN))
    times = {
        "wall_s": time.monotonic() - start,
        "own_cpu_s": python.ru_utime + python.ru_stime,
        "programs_cpu_s": programs.ru_utime + programs.ru_stime,
        "own_memory_MB": python.ru_maxrss / 1024.0,
        "largest_program_MB": programs.ru_maxrss / 1024.0,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(times) + "\n")


def read_times(results: Path) -> Iterator[tuple[str, dict[str, float]]]:
    """Kind of each job, with its elapsed time and the CPU times of it and of its programs, in s.

    Incomplete files are skipped.
    """
    for path in sorted((results / TIMES).rglob("*.json")):
        try:
            found: Any = json.loads(path.read_text())
            times = {key: float(found[key]) for key in KEYS}
        except (OSError, ValueError, TypeError, KeyError, RecursionError):
            continue
        yield path.relative_to(results / TIMES).parts[0].removesuffix(".json"), times


def main() -> None:
    """Command line: the plan of the job, a file."""
    for number in SIGNALS:
        if number == signal.SIGTERM or signal.getsignal(number) != signal.SIG_IGN:  # as by nohup
            signal.signal(number, _killed)
    end_with_parent()
    plan = json.loads(Path(sys.argv[1]).read_text())
    results, name = Path(plan["results"]), plan["name"]
    start = time.monotonic()
    _limit(name, plan.get("time_limit"))
    begin(results, name)
    try:
        run_job(plan)
    except KilledError:
        raise
    except BaseException:
        end(results, name)
        raise
    end(results, name)
    write_times(results / TIMES / f"{name}.json", start)


def _limit(name: str, seconds: float | None) -> None:
    """End this process after so many ``seconds``: a job that is stuck would hold up its run."""

    def late() -> None:
        print(f"{name}: out of time after {seconds:g} s", file=sys.stderr, flush=True)
        os._exit(1)  # and the programs that it has started with it

    if seconds is not None:
        timer = threading.Timer(seconds, late)
        timer.daemon = True
        timer.start()


def _killed(*_: object) -> None:
    for number in SIGNALS:  # nothing disturbs the end of what the job has started
        signal.signal(number, signal.SIG_IGN)
    raise KilledError(STOPPED)


if __name__ == "__main__":
    main()
