"""What the commands behind `make` share: Snakemake for some targets, options, errors."""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from workflow.configuration import CallError, ConfigError, read_study_file
from workflow.planning.results_folder import use_writable_caches
from workflow.run.job import end_with_parent
from workflow.run.process import STOPPED, end_on_signals, end_with_make, stop, stopping
from workflow.run.waiting import waiting
from workflow.schema import Study

CHECKOUT = Path(__file__).parents[2]
PROFILES = CHECKOUT / "profiles"
PATIENCE = 10.0  # s, for Snakemake to clean up when it is asked to end
MOST_REASONS = 3  # shown at the end of an incomplete run


def options_of(
    program: str, description: str | None, what: Sequence[str]
) -> argparse.ArgumentParser:
    """Options of ``program``: what to do, a configuration and a results folder."""
    parser = argparse.ArgumentParser(prog=program, description=description)
    parser.add_argument("what", choices=what)
    parser.add_argument("config", type=Path)
    parser.add_argument("--results", help="results folder; overrides the configuration")
    parser.add_argument(
        "--end-with-parent",
        action="store_true",
        help="end together with the process that started this one",
    )
    return parser


def run_command(command: Callable[[], str | None], arguments: argparse.Namespace) -> None:
    """Run ``command``; end this process with a line if it returns one or the input has an error."""
    if arguments.end_with_parent:
        end_with_parent()
        end_with_make()
    try:
        fault = command()
    except CallError as error:
        sys.exit(str(error))
    except ConfigError as error:
        sys.exit(str(error.of(arguments.config)))
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
    targets: Sequence[str],
    engines: Sequence[str],
    profile: Path | None = None,
) -> bool:
    """Have Snakemake make ``targets`` (none: the whole study); returns whether it did.

    ``profile``: a folder with Snakemake's options for a cluster.
    """
    from workflow.run import progress

    use_writable_caches(Path(results))
    os.environ.pop("SNAKEMAKE_PROFILE", None)  # of other workflows
    logger = progress.register()  # before the command line is read, which knows the plugins

    from snakemake.cli import args_to_api, parse_args
    from snakemake.exceptions import print_exception
    from snakemake.scheduling.job_scheduler import JobScheduler

    # Snakemake would wait for the running jobs when it is asked to end.
    JobScheduler.exit_gracefully = staticmethod(stop)

    options = [
        "--snakefile",
        str(CHECKOUT / "Snakefile"),
        "--logger",
        logger,
        "--configfile",
        str(config),
        "--config",
        f"results={results}",
    ]
    options.append(f"dem={{engines: [{', '.join(engines)}]}}")
    if profile is not None:
        options += ["--profile", str(profile)]
    parser, arguments = parse_args([*targets, *options])
    # With a limit to the rate of jobs, the scheduler polls once a second for each job that has
    # ended, which takes a tenth of a core after a hundred jobs. On a cluster, the limit is useful.
    if profile is None:
        arguments.max_jobs_per_timespan = None
    end_on_signals(PATIENCE)
    done = False
    try:
        with waiting("Planning the jobs") as plans:
            progress.when_planned(plans.end)
            done = bool(args_to_api(arguments, parser))
    except Exception as error:  # whatever it is, as Snakemake's command reports it
        print_exception(error)
    if stopping():
        sys.exit(STOPPED)
    return done


def profile_named(name: str | None) -> Path | None:
    """The folder of the profile ``name``; None without a name. `ConfigError` if it is unknown."""
    if not name:
        return None
    known = sorted(path.parent.name for path in PROFILES.glob("*/config.yaml"))
    if name not in known:
        raise CallError(f"PROFILE: {name!r} is not allowed; it must be one of {', '.join(known)}")
    return PROFILES / name


def because() -> str:
    """The reasons why the last run of Snakemake failed, to end an error message."""
    from workflow.run import progress

    reasons = progress.last_run().reasons
    if not reasons:
        return ", see above"
    more = (
        f"\n  and {len(reasons) - MOST_REASONS} more, see above"
        if len(reasons) > MOST_REASONS
        else ""
    )
    return ":\n  " + "\n  ".join(reasons[:MOST_REASONS]) + more
