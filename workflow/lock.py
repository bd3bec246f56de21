"""One run at a time in each results folder."""

import fcntl
import os
from pathlib import Path
from typing import TextIO

LOCK = ".lock"


class LockedError(RuntimeError):
    """The folder cannot be used, as by another run; the message is one line."""


def lock(results: Path) -> TextIO:
    """Lock ``results`` for as long as this process lives and the returned file is kept.

    The system releases the lock when the process ends, however that happens: no stale lock remains.
    """
    try:
        results.mkdir(parents=True, exist_ok=True)
        stream = (results / LOCK).open("a+")
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise LockedError(f"results: {results} cannot be written to: {reason}") from None
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        stream.seek(0)
        other = stream.read().strip() or "unknown"
        stream.close()
        raise LockedError(f"{results}: another run is at work here (process {other})") from None
    stream.truncate(0)
    stream.write(f"{os.getpid()}\n")
    stream.flush()
    return stream
