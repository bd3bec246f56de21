"""One run at a time in each results folder."""

import fcntl
import os
import sys
from pathlib import Path
from typing import TextIO

from workflow.mending import cleared

LOCK = ".lock"


class LockedError(RuntimeError):
    """The folder cannot be used, as by another run; the message is one line."""


def lock(results: Path) -> TextIO:
    """Lock ``results`` for as long as this process lives and the returned file is kept.

    The system releases the lock when the process ends, however that happens: no stale lock remains.
    """
    try:
        results.mkdir(parents=True, exist_ok=True)
        path = results / LOCK
        if path.is_symlink() or (path.exists() and not path.is_file()):
            print(cleared(path), file=sys.stderr)
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC
        stream = os.fdopen(os.open(path, flags, 0o666), "a+")
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
