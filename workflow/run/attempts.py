"""Jobs that were killed: for lack of time or memory, or because their machine went down.

A mark exists while a job runs, and is removed when the job ends by itself, successfully or not. A
mark that is left when a job is tried again shows that it was killed, and that more time or memory
may help.
"""

import os
import shutil
from pathlib import Path

LAST_TRY = "MULTILOCK_LAST_TRY"  # in the environment: 0 if the job will be tried again
RETRIES = 2  # on a cluster, as in its profile
STOPPED = "stopped"  # last line of a job that was asked to end


class KilledError(SystemExit):
    """The job, or a program that it started, was killed from outside, and left no result."""


class Settled(str):
    """Why a job has no result, where another run would end with the same reason."""


def _mark(results: Path, job: str) -> Path:
    return results / ".begun" / f"{job}.job"


def was_killed(results: Path, job: str) -> bool:
    """Whether the last attempt of a job in this run was killed; the job is not running."""
    return _mark(results, job).is_file()


def begin(results: Path, job: str) -> None:
    """Mark that a job begins."""
    path = _mark(results, job)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()


def end(results: Path, job: str) -> None:
    """Mark that a job has ended by itself."""
    _mark(results, job).unlink(missing_ok=True)


def forget(results: Path) -> None:
    """Remove the marks of earlier runs."""
    shutil.rmtree(results / ".begun", ignore_errors=True)


def last_try() -> bool:
    """Whether this job will not be tried again if it is killed."""
    return os.environ.get(LAST_TRY, "1") != "0"
