"""What stands in a results folder where a file or a folder of the study must be, and is neither.

A pipe is waited for without end, a device is read without end, and what is written to a link
changes a file somewhere else. So links, pipes and the like are removed before a run (never what a
link names), and a folder or a file in the other's place is set aside.
"""

import os
from collections.abc import Iterable, Iterator, Set
from contextlib import suppress
from itertools import count
from pathlib import Path, PurePosixPath

# What runs keep there, beside the outputs of their jobs.
KEPT = (".plan", ".receipts", ".times", ".begun", "logs")
GIVEN = "decks"  # where people put files, and perhaps links to them


def mended(results: Path, names: Iterable[str]) -> list[str]:
    """Make way for the files ``names``, below ``results``, and for what runs keep beside them.

    Returns a line for each thing that was removed or set aside.
    """
    files = frozenset(names)
    folders = {str(parent) for name in files for parent in PurePosixPath(name).parents} | {*KEPT}
    tops = {name.partition("/")[0] for name in files | folders} - {GIVEN}
    return [cleared(Path(results, name)) for name in _wrong(results, "", files, folders, tops)]


def cleared(path: Path) -> str:
    """Remove what is no file and no folder, or set it aside if it is one; says so in a line."""
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
    """What must go, below ``results``: in the folder ``place``, or ``only`` some entries of it."""
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
