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
import time
from pathlib import Path
from typing import Any

from workflow.closure import code_digest
from workflow.receipts import write_receipt

PR_SET_PDEATHSIG = 1
SELF, CHILDREN = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN


def end_with_parent() -> None:
    """Have the system end this process when the one that started it ends, however that happens."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it has ended in the meantime
        sys.exit("stopped")


def run_job(plan: dict[str, Any]) -> None:
    """Do the job that ``plan`` describes as plain data, and leave a receipt if it has a result."""
    code = plan["code"]
    if code_digest(code["modules"], code["files"]) != code["digest"]:
        sys.exit(f"{plan['name']}: the code was edited after the run had begun; start it again")
    results = Path(plan["results"])
    receipt = results / plan["receipt"]
    receipt.unlink(missing_ok=True)
    for name in plan["outputs"]:
        (results / name).parent.mkdir(parents=True, exist_ok=True)
    step = importlib.import_module(plan["step"])
    inputs = [results / name for name in plan["inputs"]]
    outputs = [results / name for name in plan["outputs"]]
    error = step.run({**plan["arguments"], **plan["settings"]}, inputs, outputs)
    if error:  # the results say so too; without a receipt the next run tries again
        print(error, file=sys.stderr)
        if not all(path.exists() for path in outputs):
            sys.exit(1)
        return
    made = (*plan["outputs"], *plan["others"])
    write_receipt(receipt, plan["name"], plan["digest"], results, made)


def write_times(path: Path, start: float) -> None:
    """Write what the job took: s in all since ``start``, CPU-s of its own and of its programs."""
    own, programs = (resource.getrusage(who) for who in (SELF, CHILDREN))
    times = {
        "wall_s": time.monotonic() - start,
        "own_cpu_s": own.ru_utime + own.ru_stime,
        "programs_cpu_s": programs.ru_utime + programs.ru_stime,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(times) + "\n")


def main() -> None:
    """Command line: the plan of the job, a file."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    signal.signal(signal.SIGHUP, lambda *_: sys.exit("stopped"))
    end_with_parent()
    plan = json.loads(Path(sys.argv[1]).read_text())
    start = time.monotonic()
    run_job(plan)
    write_times(Path(plan["results"], ".times", f"{plan['name']}.json"), start)


if __name__ == "__main__":
    main()
