"""What the commands behind `make` share: Snakemake, options, errors, and the results folder.

One run at a time uses a results folder; caches are in it where the usual places are read-only.
"""

import argparse
import errno
import fcntl
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TextIO

from sidmacib.engines.scripts.children import ENDS_WITH_PARENT
from workflow.configuration import CallError, ConfigError, read_study_file
from workflow.schema import Study

LOCK = ".lock"
REPORT = "report.html"
CACHES = {  # of Snakemake, matplotlib and numba: in the environment, and where they are by default
    "XDG_CACHE_HOME": Path("~/.cache"),
    "MPLCONFIGDIR": Path("~/.config/matplotlib"),
}
NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}
SNAKEMAKE = ".snakemake"  # in the working directory
SNAKEMAKE_CLI = (  # ^C while it loads ends it without a traceback
    "import signal; signal.signal(signal.SIGINT, signal.SIG_DFL); from snakemake.cli import main; "
    "signal.signal(signal.SIGINT, signal.default_int_handler); main()"
)
STOPPED = "Stopped. The next run continues from here."


def lock(results: Path) -> TextIO:
    """Lock ``results`` for as long as this process lives and the returned file is kept.

    The system releases the lock when the process ends, however that happens: no stale lock remains.
    `CallError` if another run holds it, or nothing can be written there. Where the file system has
    no locks, as some of clusters, a line on standard error says that nothing keeps others out.
    """
    try:
        results.mkdir(parents=True, exist_ok=True)
        stream = (results / LOCK).open("a+")
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            stream.seek(0)
            other = stream.read().strip() or "unknown"
            words = f"another run is using this folder (process {other})"
            raise CallError(f"{results}: {words}") from None
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise
            words = "its file system has no locks, so start no second run in it"
            print(f"{results}: {words} ({_reason(error)})", file=sys.stderr)
        stream.truncate(0)
        stream.write(f"{os.getpid()}\n")
        stream.flush()
    except OSError as error:
        raise CallError(f"results: {results} cannot be written to: {_reason(error)}") from None
    return stream


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()


def set_back(results: Path) -> None:
    """Bring times of files in ``results`` out of the future, where a wrong clock may put them.

    All go back by as much, so that what is newer stays newer: Snakemake goes by these times.
    """
    with suppress(OSError):  # of others' results, or while another run writes
        times = {path: path.stat().st_mtime_ns for path in results.rglob("*") if path.is_file()}
        ahead = max(times.values(), default=0) - time.time_ns()
        for path, when in times.items() if ahead > 0 else ():
            os.utime(path, ns=(when - ahead, when - ahead))


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


CHECKOUT = Path(__file__).parents[1]
PROFILES = CHECKOUT / "profiles"


def options_of(
    program: str, description: str | None, what: Sequence[str]
) -> argparse.ArgumentParser:
    """Options of ``program``: what to do, a configuration and a results folder."""
    parser = argparse.ArgumentParser(prog=program, description=description)
    parser.add_argument("what", choices=what)
    parser.add_argument("config", type=Path)
    parser.add_argument("--results", help="results folder; overrides the configuration")
    return parser


def run_command(command: Callable[[], str | None], arguments: argparse.Namespace) -> None:
    """Run ``command``; end this process with a line if it returns one or the input has an error."""
    try:
        fault = command()
    except CallError as error:
        sys.exit(str(error))
    except ConfigError as error:
        sys.exit(str(error.of(arguments.config)))
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    if fault:
        sys.exit(fault)


def study_with_joints(config: Path, results: str | None) -> Study:
    """The study in ``config``; `ConfigError` if it has no joints."""
    study = read_study_file(config, results)
    if not study.samples:
        raise ConfigError(
            "samples: missing; this command works on joints, and the study has only structures"
        )
    return study


def snakemake(
    config: Path,
    results: str,
    targets: Sequence[str] = (),
    options: Sequence[str] = (),
    *,
    engines: bool = True,
) -> bool:
    """Have Snakemake make ``targets`` (none: the whole study); returns whether it did.

    It ends with this process, however that ends. ``engines``: whether they run.
    """
    use_writable_caches(Path(results))
    os.environ.pop("SNAKEMAKE_PROFILE", None)  # of other workflows
    command = snakemake_command(config, results, engines=engines)
    whole = [*ENDS_WITH_PARENT, *command, *options, "--", *targets]
    return subprocess.run(whole, check=False).returncode == 0


def snakemake_command(config: Path, results: str, *, engines: bool = True) -> list[str]:
    """The command line of Snakemake for a study, without its targets."""
    return [
        *(sys.executable, "-c", SNAKEMAKE_CLI, "--snakefile", str(CHECKOUT / "Snakefile")),
        *("--configfile", str(config), "--config", f"results={results}"),
        *(() if engines else ("dem={engines: []}",)),
    ]


def profile_named(name: str | None) -> list[str]:
    """Options for the profile ``name``; none without a name. `ConfigError` if it is unknown."""
    if not name:
        return []
    known = sorted(path.parent.name for path in PROFILES.glob("*/config.yaml"))
    if name not in known:
        raise CallError(f"PROFILE: {name!r} is not allowed; it must be one of {', '.join(known)}")
    return ["--profile", str(PROFILES / name)]
