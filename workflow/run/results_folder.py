"""The results folder: one run at a time, and caches where the usual places are read-only."""

import errno
import fcntl
import os
import sys
from pathlib import Path
from typing import TextIO

from workflow.configuration import CallError

LOCK = ".lock"
REPORT = "report.html"
CACHES = {  # of Snakemake, matplotlib and numba: in the environment, and where they are by default
    "XDG_CACHE_HOME": Path("~/.cache"),
    "MPLCONFIGDIR": Path("~/.config/matplotlib"),
}
NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}
SNAKEMAKE = ".snakemake"  # in the working directory


def lock(results: Path) -> TextIO:
    """Lock ``results`` for as long as this process lives and the returned file is kept.

    The system releases the lock when the process ends, however that happens: no stale lock remains.
    `CallError` if another run holds it, or nothing can be written there. Where the file system has
    no locks, as some of clusters, a line on standard error says that nothing keeps others out.
    """
    try:
        results.mkdir(parents=True, exist_ok=True)
        stream = (results / LOCK).open("a+")
    except OSError as error:
        raise CallError(f"results: {results} cannot be written to: {_reason(error)}") from None
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        stream.seek(0)
        other = stream.read().strip() or "unknown"
        raise CallError(f"{results}: another run is using this folder (process {other})") from None
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise CallError(f"results: {results} cannot be locked: {_reason(error)}") from None
        words = "its file system has no locks, so start no second run in it"
        print(f"{results}: {words} ({_reason(error)})", file=sys.stderr)
    try:
        stream.truncate(0)
        stream.write(f"{os.getpid()}\n")
        stream.flush()
    except OSError as error:
        raise CallError(f"results: {results} cannot be written to: {_reason(error)}") from None
    return stream


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


def use_writable_caches(results: Path) -> None:
    """Keep caches in the folder ``results`` where the usual places cannot be written to.

    Raises `CallError` where ``results`` or the working directory cannot be, either.
    """
    for place, what in ((results, "results"), (Path(SNAKEMAKE), "the working directory")):
        if not writable(place):
            shown = results if place == results else Path.cwd()
            raise CallError(f"{what}: {shown} cannot be written to: permission denied")
    for name, place in CACHES.items():
        if name not in os.environ and not writable(place.expanduser()):
            os.environ[name] = str(Path(results, ".cache", place.name).absolute())


def writable(folder: Path) -> bool:
    """Whether a folder can be written to or created."""
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    return os.access(there, os.W_OK | os.X_OK)
