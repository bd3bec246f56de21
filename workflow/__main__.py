"""What `make` calls: a whole study, one case, the decks or the calibration."""

from workflow.run.process import (
    STOPPED,
    end_when_told,
    end_with_make,
    read_utf8,
    stop,
    told_to_stop,
)

if __name__ == "__main__":  # before the other imports, which take half a second
    end_when_told()
    read_utf8()

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from analysis.report.files import REPORT
from workflow.cases import case_count, find_case, find_place
from workflow.configuration import CallError, ConfigError, installed_engines, read_study_file
from workflow.consistency import notes
from workflow.models import CLOSED_FORM, REFERENCE_MODEL
from workflow.results.files import RECORD
from workflow.run.job import end_with_parent
from workflow.run.results_folder import use_writable_caches
from workflow.run.waiting import waiting
from workflow.schema import Study

CHECKOUT = Path(__file__).parents[1]
PROFILES = CHECKOUT / "profiles"
# Of joints, and of structures: the job of that name, and its rule, by the file that it writes.
SUMMARIES = {"summary.txt": "summary", "structures.txt": "structure_summary"}
PATIENCE = 10.0  # s, for Snakemake to clean up when it is told to end
MANY = 5000  # cases, which take a while to plan
TOLD = 3  # reasons at the end of a run that is incomplete


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

    # Told to end, it would wait for the jobs that are running.
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
    # With a limit to the rate of jobs the scheduler looks around once a second for each job that
    # has ended: a tenth of a core after a hundred of them. A cluster is glad of one.
    if profile is None:
        arguments.max_jobs_per_timespan = None
    end_when_told(PATIENCE)
    done = False
    try:
        with waiting("Planning what has to be done") as plans:
            progress.when_planned(plans.end)
            done = bool(args_to_api(arguments, parser))
    except Exception as error:  # whatever it is, as Snakemake's own command tells it
        print_exception(error)
    if told_to_stop():
        sys.exit(STOPPED)
    return done


def profile_named(name: str | None) -> Path | None:
    """The folder of a profile; None if there is no ``name``. `ConfigError` if there is no such."""
    if not name:
        return None
    known = sorted(path.parent.name for path in PROFILES.glob("*/config.yaml"))
    if name not in known:
        raise CallError(f"PROFILE: {name!r} is not known; it must be one of {', '.join(known)}")
    return PROFILES / name


def study(config: Path, results: str | None, profile: Path | None = None) -> str | None:
    """Run a study and print its summary; returns why it is incomplete, None if it is complete."""
    from workflow.run import progress

    with waiting(f"Reading {config}"):
        own = read_study_file(config, results)
        count = case_count(own)
    for line in notes(own):
        print(f"Note: {line}", file=sys.stderr)
    if count > MANY:
        print(f"{count:,} cases", file=sys.stderr)
    engines = installed_engines(own)
    if profile is None:  # a cluster's front end is not for computing
        _first_report(config, own, engines)
    whole = snakemake(config, own.results, (), engines, profile)
    old = ""
    for name, rule in SUMMARIES.items():
        if not (own.samples if rule == "summary" else own.structures):
            continue
        path = Path(own.results, name)
        ours = whole or progress.last_run().is_made(rule)
        if ours and path.is_file():
            print(path.read_text(), end="")
        elif path.is_file():
            old += f" ({name} is of an earlier run)"
    if whole and own.structures and not own.samples:  # whose summary names it
        print(f"Report: {own.results}/{REPORT}")
    return None if whole else f"{own.results}: the study is incomplete{old}{_because()}"


def _because() -> str:
    """Why the last run of Snakemake did not end well, for the end of a line."""
    from workflow.run import progress

    reasons = progress.last_run().reasons
    if not reasons:
        return ", see above"
    more = f"\n  and {len(reasons) - TOLD} more, see above" if len(reasons) > TOLD else ""
    return ":\n  " + "\n  ".join(reasons[:TOLD]) + more


def _first_report(config: Path, own: Study, engines: Sequence[str]) -> None:
    """Where engines take their time, write a report of what needs none of them first.

    Only if there is none yet: what it shows is made again when the engines have ended.
    """
    path = Path(own.results, REPORT)
    if own.samples and engines and REFERENCE_MODEL in own.models and not path.exists():
        print("First, a report without the engines", file=sys.stderr)
        # In a process of its own, whose lock of the results folder ends with it.
        told = ["report", str(config), f"--results={own.results}"]
        told += ["--without-engines", "--end-with-parent"]
        subprocess.run([sys.executable, "-m", "workflow", *told], check=False)


def case(config: Path, results: str | None, name: str, model: str | None) -> str | None:
    """Run one case if need be and print its result; returns why there is none."""
    from workflow.results.files import read_records

    own = _with_joints(config, results)
    use_writable_caches(Path(own.results))  # before anything is imported that compiles
    from analysis.summary.one_case import describe_record

    if model in CLOSED_FORM:
        return _rule(own, name, model)
    chosen = find_case(own, name, model)
    folder = Path(own.results, chosen.id.folder)
    engines = list(own.dem.engines)
    if not snakemake(config, own.results, (str(folder / "result.json"),), engines):
        return f"{name}: no result{_because()}"
    (record,) = read_records([folder / RECORD])
    print(f"{describe_record(record)}\n  files: {folder}")
    if record.error is not None:
        return f"{name}: no result"
    if chosen.model == REFERENCE_MODEL:
        from analysis.vtk import write_path  # compiles what it caches

        pieces, _ = write_path(chosen, folder / "vtk")
        print(f"  for ParaView: {pieces.parent}/*.pvd")
    return None


def _rule(own: Study, name: str, model: str) -> str | None:
    """Print what a rule in closed form says of a case; returns why it says nothing."""
    from analysis.summary.one_case import describe_rule
    from analysis.tables.capacity import NO_ANSWER

    try:
        print(f"{name}, {describe_rule(own, model, find_place(own, name))}")
    except ConfigError:
        raise
    except NO_ANSWER as error:
        return f"{name} ({model}): no result: {error}"
    return None


def _with_joints(config: Path, results: str | None) -> Study:
    """The study in ``config``; `ConfigError` if it has no joints."""
    own = read_study_file(config, results)
    if not own.samples:
        raise ConfigError("samples: missing; this is made of joints, and the study has structures")
    return own


def report(config: Path, results: str | None, engines: bool = True) -> str | None:
    """Write the report, without engines of what needs none; returns why there is no report."""
    own = read_study_file(config, results)
    if not own.samples and not own.structures:
        raise ConfigError("samples: missing; a report is of joints or structures")
    path = str(Path(own.results, REPORT))
    if not snakemake(config, own.results, (path,), installed_engines(own) if engines else ()):
        return f"no report{_because()}"
    print(f"Report: {path}")
    return None


def decks(config: Path, results: str | None) -> str | None:
    """Write the decks for 3DEC; returns why there are none."""
    own = _with_joints(config, results)
    if not snakemake(config, own.results, ("decks",), list(own.dem.engines)):
        return f"no decks{_because()}"
    print(f"Decks: {own.results}/decks/3dec")
    return None


def main() -> None:
    """Command line: what to do, with which configuration, in which results folder."""
    parser = argparse.ArgumentParser(prog="python -m workflow", description=__doc__)
    parser.add_argument("what", choices=["study", "case", "report", "decks", "calibrate"])
    parser.add_argument("config", type=Path)
    parser.add_argument("--results", help="results folder, in place of the configuration's")
    parser.add_argument("--case", help="name of a case, such as n3-mesh0.02-e0.1a")
    parser.add_argument("--model", help="its model; by default the first one installed")
    parser.add_argument("--profile", help="of a cluster: a folder in profiles, such as slurm")
    parser.add_argument(
        "--without-engines", action="store_true", help="a report of what needs no engine"
    )
    parser.add_argument(
        "--end-with-parent", action="store_true", help="end when the process that started it ends"
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
            fault = case(arguments.config, results, arguments.case, arguments.model or None)
        elif arguments.what == "report":
            fault = report(arguments.config, results, not arguments.without_engines)
        elif arguments.what == "calibrate":
            from analysis.calibration.calibrate import calibrate

            _with_joints(arguments.config, results)
            fault = calibrate(arguments.config, results, snakemake)
        elif arguments.what == "decks":
            fault = decks(arguments.config, results)
        else:
            fault = study(arguments.config, results, profile_named(arguments.profile))
    except CallError as error:
        sys.exit(str(error))
    except ConfigError as error:
        sys.exit(str(error.of(arguments.config)))
    if fault:
        sys.exit(fault)


if __name__ == "__main__":
    main()
