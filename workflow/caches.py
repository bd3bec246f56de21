"""Where Snakemake, matplotlib and numba keep what they make only once: where they can write."""

import os
from pathlib import Path

from workflow.configuration import CallError

FOLDERS = {  # in the environment, and where they are by default
    "XDG_CACHE_HOME": Path("~/.cache"),
    "MPLCONFIGDIR": Path("~/.config/matplotlib"),
}
SNAKEMAKE = ".snakemake"  # in the working directory


def use_writable_caches(results: Path) -> None:
    """Keep caches in the folder ``results`` where the usual places cannot be written to.

    Raises `CallError` where ``results`` or the working directory cannot be, either.
    """
    for place, what in ((results, "results"), (Path(SNAKEMAKE), "the working directory")):
        if not writable(place):
            shown = results if place == results else Path.cwd()
            raise CallError(f"{what}: {shown} cannot be written to: permission denied")
    for name, place in FOLDERS.items():
        if name not in os.environ and not writable(place.expanduser()):
            os.environ[name] = str(Path(results, ".cache", place.name).absolute())


def writable(folder: Path) -> bool:
    """Whether a folder can be written to, or made."""
    there = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    return os.access(there, os.W_OK | os.X_OK)
