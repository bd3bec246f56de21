"""The results folder of a run: it must be writable, locked and free of links and pipes.

Something else may be where the study needs a file or a folder: reading a pipe would block, reading
a device would never end, and writing to a link would change a file elsewhere. Links, pipes and
devices are therefore removed before a run (never what a link points to); a folder in place of a
file, or a file in place of a folder, is renamed.
"""

import fcntl
import os
import sys
from collections.abc import Iterable, Iterator, Set
from contextlib import suppress
from itertools import count
from pathlib import Path, PurePosixPath
from typing import TextIO

from workflow.configuration import CallError

LOCK = ".lock"
REPORT = "report.html"
CACHES = {  # of Snakemake, matplotlib and numba: in the environment, and where they are by default
    "XDG_CACHE_HOME": Path("~/.cache"),
    "MPLCONFIGDIR": Path("~/.config/matplotlib"),
}
SNAKEMAKE = ".snakemake"  # in the working directory

# What runs keep there, beside the outputs of their jobs.
KEPT = (".plan", ".receipts", ".times", ".begun", "logs")
GIVEN = "decks"  # where people put files, and perhaps links to them


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
        raise LockedError(
            f"{results}: another run is using this folder (process {other})"
        ) from None
    stream.truncate(0)
    stream.write(f"{os.getpid()}\n")
    stream.flush()
    return stream


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


def mended(results: Path, names: Iterable[str]) -> list[str]:
    """Make way for the files ``names``, below ``results``, and for what runs keep beside them.

    Returns a line for each thing that was removed or set aside.
    """
    files = frozenset(names)
    folders = {str(parent) for name in files for parent in PurePosixPath(name).parents} | {*KEPT}
    tops = {name.partition("/")[0] for name in files | folders} - {GIVEN}
    return [cleared(Path(results, name)) for name in _wrong(results, "", files, folders, tops)]


def cleared(path: Path) -> str:
    """Remove a link or special file, or rename a file or folder; returns a line that says so."""
    if path.is_symlink() or not (path.is_file() or path.is_dir()):
        kind = "a link" if path.is_symlink() else "no file"
        path.unlink()
        return f"{path} was {kind}: it was removed"
    kind = "folder" if path.is_dir() else "file"
    names = (path.with_name(f"{path.name}.aside{number}") for number in count(1))
    aside = next(name for name in names if not os.path.lexists(name))
    path.rename(aside)
    return f"{path} was a {kind}: it is {aside.name} now"


def _wrong(
    results: Path, place: str, files: Set[str], folders: Set[str], only: Set[str] | None = None
) -> Iterator[str]:
    """Paths below ``results`` to clear: in the folder ``place``, or ``only`` some entries of it."""
    with suppress(FileNotFoundError), os.scandir(results / place) as entries:
        for entry in entries:
            name = f"{place}{entry.name}"
            if only is not None and name not in only:
                continue
            if entry.is_dir(follow_symlinks=False):
                if name in files:
                    yield name
                else:
                    yield from _wrong(results, f"{name}/", files, folders)
            elif name in folders or not entry.is_file(follow_symlinks=False):
                yield name
