"""Jobs that were killed: for lack of time or memory, or because their machine went down.

A mark is there while a job runs, and goes when it ends by itself, well or badly. So a mark that is
there when a job is tried again tells that it was killed, and that more time or memory may help.
"""

import os
import shutil
from pathlib import Path

LAST_TRY = "MULTILOCK_LAST_TRY"  # in the environment: 0 if the job will be tried again
RETRIES = 2  # on a cluster, as in its profile
STOPPED = "stopped"  # a job's last word, if it is told to end


class KilledError(SystemExit):
    """The job was killed from outside, or a program of its was: it has no result to speak of."""


class Settled(str):
    """Why a job has no result, where it would say the same if it were done again."""


def _mark(results: Path, job: str) -> Path:
    return results / ".begun" / f"{job}.job"


def was_killed(results: Path, job: str) -> bool:
    """Whether a job, which is not running, was killed when it was last tried in this run."""
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
