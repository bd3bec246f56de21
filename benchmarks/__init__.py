"""Benchmarks; here what they measure by: time of a function; time and memory of a command.

A process counts the memory of the one that starts it as its own. So this module, which imports
little, runs as a program in between: `python benchmarks/__init__.py FILE COMMAND …`.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Usage:
    """Time on the clock and of processors, s, and memory of the largest process, MB."""

    wall: float
    cpu: float
    memory: float


def used(command: Sequence[str], folder: Path) -> Usage:
    """Run ``command`` in ``folder``; RuntimeError if it fails."""
    with tempfile.NamedTemporaryFile("r") as numbers:
        between = [sys.executable, "-S", str(Path(__file__).resolve()), numbers.name, *command]
        done = subprocess.run(
            between,
            cwd=folder,
            check=False,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        if done.returncode:
            raise RuntimeError(f"{' '.join(command)}: {done.stdout[-2000:]}")
        return Usage(**json.load(numbers))


def seconds(
    work: Callable[[], object], repeats: int = 1, clock: Callable[[], float] = time.process_time
) -> float:
    """Processor time of ``work``, or its time on another ``clock``: the mean of ``repeats``, s."""
    start = clock()
    for _ in range(repeats):
        work()
    return (clock() - start) / repeats


def main() -> int:
    """Run the command of the command line, and write what it used to the file."""
    file, *command = sys.argv[1:]
    start = time.monotonic()
    status = subprocess.run(command, check=False).returncode
    wall = time.monotonic() - start
    of_all = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu, memory = of_all.ru_utime + of_all.ru_stime, of_all.ru_maxrss / 1024
    Path(file).write_text(json.dumps({"wall": wall, "cpu": cpu, "memory": memory}))
    return status


if __name__ == "__main__":
    sys.exit(main())
