"""What the script of every rule does around its work."""

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import __main__

PR_SET_PDEATHSIG = 1

Arguments = Mapping[str, Any]
Files = Mapping[str, Path]
FileLists = Mapping[str, list[Path]]
Run = Callable[[Arguments, Any, Any], str | None]


class KilledError(SystemExit):
    """A program that the job started was killed from outside; a cluster may try again."""


def step(run: Run, **others: Run) -> None:
    """Call ``run`` with the parameters, inputs and outputs of the job that runs this script.

    ``others``: what the jobs of other rules call in its place, by the name of the rule. A ``run``
    takes parameters and resources by name, and paths by name: each a path or a list of paths. It
    may return why a case has no result, which its outputs say too. All that is printed goes to the
    job's log. The job ends with the process that started it, however that ends.
    """
    job = __main__.snakemake  # which Snakemake puts there
    run = others.get(job.rule, run)
    _end_with_parent()
    log = os.open(job.log[0], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
    for stream in (1, 2):
        os.dup2(log, stream)
    arguments = {**dict(job.resources.items()), **dict(job.params.items())}
    if error := run(arguments, _paths(job.input), _paths(job.output)):
        print(error, file=sys.stderr)
        if not all(Path(path).exists() for path in job.output):
            sys.exit(1)


def _end_with_parent() -> None:
    """Have the system end this process when the one that started it ends."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it has ended in the meantime
        sys.exit("stopped")


def _paths(files: Any) -> dict[str, Any]:
    return {
        name: Path(value) if isinstance(value, str) else [Path(path) for path in value]
        for name, value in files.items()
    }
