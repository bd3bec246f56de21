"""What the commands behind `make` share: Snakemake for some targets, options, errors."""

import argparse
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from sidmacib.engines.scripts.children import ENDS_WITH_PARENT
from workflow.configuration import CallError, ConfigError, read_study_file
from workflow.run.results_folder import use_writable_caches
from workflow.schema import Study

CHECKOUT = Path(__file__).parents[2]
PROFILES = CHECKOUT / "profiles"
STOPPED = "Stopped. The next run continues from here."


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
        *(sys.executable, "-m", "snakemake", "--snakefile", str(CHECKOUT / "Snakefile")),
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
