"""The commands behind `make`: a whole study, one case, the decks or the calibration."""

from workflow.run.process import (
    STOPPED,
    end_on_signals,
    end_with_make,
    read_utf8,
    stop,
    stopping,
)

if __name__ == "__main__":  # before the other imports, which take half a second
    end_on_signals()
    read_utf8()

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.report.files import REPORT
from workflow.configuration import CallError, ConfigError, installed_engines, read_study_file
from workflow.consistency import notes
from workflow.models import CLOSED_FORM, REFERENCE_MODEL
from workflow.planning.cases import case_count, find_case, find_place
from workflow.results.files import RECORD
from workflow.run.job import end_with_parent
from workflow.run.results_folder import use_writable_caches
from workflow.run.waiting import waiting
from workflow.schema import Study

CHECKOUT = Path(__file__).parents[1]
PROFILES = CHECKOUT / "profiles"
# Of joints, and of structures: the job of that name, and its rule, by the file that it writes.
SUMMARIES = {"summary.txt": "summary", "structures.txt": "structure_summary"}
PATIENCE = 10.0  # s, for Snakemake to clean up when it is asked to end
MANY = 5000  # cases, which take a while to plan
MOST_REASONS = 3  # shown at the end of an incomplete run


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


def run_study(config: Path, results: str | None, profile: Path | None = None) -> str | None:
    """Run a study and print its summary; returns why it is incomplete, None if it is complete."""
    from workflow.run import progress

    with waiting(f"Reading {config}"):
        study = read_study_file(config, results)
        count = case_count(study)
    for line in notes(study):
        print(f"Note: {line}", file=sys.stderr)
    if count > MANY:
        print(f"{count:,} cases", file=sys.stderr)
    engines = installed_engines(study)
    if profile is None:  # nothing is computed on a cluster's front end
        _first_report(config, study, engines)
    whole = snakemake(config, study.results, (), engines, profile)
    old = ""
    for name, rule in SUMMARIES.items():
        if not (study.samples if rule == "summary" else study.structures):
            continue
        path = Path(study.results, name)
        ours = whole or progress.last_run().is_made(rule)
        if ours and path.is_file():
            print(path.read_text(), end="")
        elif path.is_file():
            old += f" ({name} is from an earlier run)"
    if whole and study.structures and not study.samples:  # the summary of joints names it
        print(f"Report: {study.results}/{REPORT}")
    return None if whole else f"{study.results}: the study is incomplete{old}{_because()}"


def _because() -> str:
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


def _first_report(config: Path, study: Study, engines: Sequence[str]) -> None:
    """Write a first report without the engines, which may take long.

    Only if there is no report yet; it is written again when the engines have ended.
    """
    path = Path(study.results, REPORT)
    if study.samples and engines and REFERENCE_MODEL in study.models and not path.exists():
        print("Writing a first report without the engines", file=sys.stderr)
        # In a separate process, whose lock of the results folder ends with it.
        words = ["report", str(config), f"--results={study.results}"]
        words += ["--without-engines", "--end-with-parent"]
        subprocess.run([sys.executable, "-m", "workflow", *words], check=False)


def run_case(config: Path, results: str | None, name: str, model: str | None) -> str | None:
    """Run one case if necessary and print its result; returns an error message, or None."""
    from workflow.results.files import read_records

    study = _with_joints(config, results)
    use_writable_caches(Path(study.results))  # before importing modules that compile code
    from analysis.summary.one_case import describe_record

    if model in CLOSED_FORM:
        return _rule(study, name, model)
    chosen = find_case(study, name, model)
    folder = Path(study.results, chosen.id.folder)
    engines = list(study.dem.engines)
    if not snakemake(config, study.results, (str(folder / "result.json"),), engines):
        return f"{name}: no result{_because()}"
    (record,) = read_records([folder / RECORD])
    print(f"{describe_record(record)}\n  files: {folder}")
    if record.error is not None:
        return f"{name}: no result"
    if chosen.model == REFERENCE_MODEL:
        from analysis.vtk import write_path  # compiles code and caches it

        pieces, _ = write_path(chosen, folder / "vtk")
        print(f"  for ParaView: {pieces.parent}/*.pvd")
    return None


def _rule(study: Study, name: str, model: str) -> str | None:
    """Print the result of a closed-form rule for a case; returns an error message, or None."""
    from analysis.summary.one_case import describe_rule
    from analysis.tables.capacity import NO_ANSWER

    try:
        print(f"{name}, {describe_rule(study, model, find_place(study, name))}")
    except ConfigError:
        raise
    except NO_ANSWER as error:
        return f"{name} ({model}): no result: {error}"
    return None


def _with_joints(config: Path, results: str | None) -> Study:
    """The study in ``config``; `ConfigError` if it has no joints."""
    study = read_study_file(config, results)
    if not study.samples:
        raise ConfigError(
            "samples: missing; this command works on joints, and the study has only structures"
        )
    return study


def write_report(config: Path, results: str | None, engines: bool = True) -> str | None:
    """Write the report, on request without engines; returns an error message, or None."""
    study = read_study_file(config, results)
    if not study.samples and not study.structures:
        raise ConfigError("samples: missing; a report needs joints or structures")
    path = str(Path(study.results, REPORT))
    if not snakemake(config, study.results, (path,), installed_engines(study) if engines else ()):
        return f"no report{_because()}"
    print(f"Report: {path}")
    return None


def write_decks(config: Path, results: str | None) -> str | None:
    """Write the decks for 3DEC; returns an error message, or None."""
    study = _with_joints(config, results)
    if not snakemake(config, study.results, ("decks",), list(study.dem.engines)):
        return f"no decks{_because()}"
    print(f"Decks: {study.results}/decks/3dec")
    return None


def main() -> None:
    """Command line: a command, a configuration and a results folder."""
    parser = argparse.ArgumentParser(prog="python -m workflow", description=__doc__)
    parser.add_argument("what", choices=["study", "case", "report", "decks", "calibrate"])
    parser.add_argument("config", type=Path)
    parser.add_argument("--results", help="results folder; overrides the configuration")
    parser.add_argument("--case", help="name of a case, such as n3-mesh0.02-e0.1a")
    parser.add_argument("--model", help="model of the case; default: the first one installed")
    parser.add_argument(
        "--profile", help="profile of a cluster: a folder in profiles, such as slurm"
    )
    parser.add_argument(
        "--without-engines", action="store_true", help="write the report without results of engines"
    )
    parser.add_argument(
        "--end-with-parent",
        action="store_true",
        help="end together with the process that started this one",
    )
    arguments = parser.parse_args()
    if arguments.end_with_parent:
        end_with_parent()
        end_with_make()
    results = arguments.results or None
    try:
        if arguments.what == "case":
            if not arguments.case:
                raise CallError(
                    "CASE: missing; it must be the name of a case, as in "
                    "make case CASE=n3-mesh0.02-e0.1a"
                )
            fault = run_case(arguments.config, results, arguments.case, arguments.model or None)
        elif arguments.what == "report":
            fault = write_report(arguments.config, results, not arguments.without_engines)
        elif arguments.what == "calibrate":
            from analysis.calibration.calibrate import calibrate

            _with_joints(arguments.config, results)
            fault = calibrate(arguments.config, results, snakemake)
        elif arguments.what == "decks":
            fault = write_decks(arguments.config, results)
        else:
            fault = run_study(arguments.config, results, profile_named(arguments.profile))
    except CallError as error:
        sys.exit(str(error))
    except ConfigError as error:
        sys.exit(str(error.of(arguments.config)))
    if fault:
        sys.exit(fault)


if __name__ == "__main__":
    main()
