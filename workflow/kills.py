"""How often a job was killed: for lack of time or memory, or because its machine went down.

A mark is there while a job runs, and goes when it ends by itself, well or badly. So a mark that is
there when the job begins tells that it was killed. A cluster's retry then asks for more.
"""

import os
from pathlib import Path

RETRIES = "MULTILOCK_RETRIES"  # in the environment: how often a job that was killed is tried again
MOST_RETRIES = 2  # on a cluster, as in its profile


STOPPED = "stopped"  # a job's last word, if it is told to end


class KilledError(SystemExit):
    """The job was killed from outside, or a program of its was: it has no result to speak of."""


def mark(results: Path, job: str) -> Path:
    """Where the mark of a job is."""
    return results / ".begun" / job


def kills(results: Path, job: str) -> int:
    """How often a job, which is not running, was killed since it last ended by itself."""
    try:
        return len(mark(results, job).read_text().splitlines())
    except OSError:
        return 0


def begin(results: Path, job: str) -> None:
    """Mark that a job begins."""
    path = mark(results, job)
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a") as stream:
        stream.write("begun\n")


def end(results: Path, job: str) -> None:
    """Mark that a job has ended by itself."""
    mark(results, job).unlink(missing_ok=True)


def tried_again(results: Path, job: str) -> bool:
    """Whether a job, which is running, will be tried again if it is killed."""
    return kills(results, job) <= int(os.environ.get(RETRIES, "0"))
