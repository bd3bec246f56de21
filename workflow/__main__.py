"""The commands behind `make study`, `make report`, `make decks` and `make cases`."""

import signal

if __name__ == "__main__":  # while it loads: some packages swallow ^C
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import csv
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from sidmacib.command.output import FORMATS, text_of
from sidmacib.errors import ResultError
from sidmacib.models import REFERENCE_MODEL
from workflow.case import Case
from workflow.command import (
    REPORT,
    lock,
    options_of,
    profile_named,
    run_command,
    snakemake,
    snakemake_command,
    study_with_joints,
)
from workflow.configuration import read_study_file
from workflow.consistency import notes
from workflow.jobs import case_jobs
from workflow.results import BATCH_RECORDS, BROKE_DOWN, RECORD, Record, read_records
from workflow.schema import Study

CURRENT = "no update"  # what Snakemake plans for an output that is up to date
LITTLE = 10.0  # MB: with less left, a job may have failed for want of room
RETRY = "RETRY"  # in the environment: try all cases without a result again


def run_study(config: Path, results: str | None, options: Sequence[str] = ()) -> str | None:
    """Run a study and print its summary; returns why it is incomplete, None if it is not."""
    study = read_study_file(config, results)
    for line in notes(study):
        print(f"Note: {line}", file=sys.stderr)
    with lock(Path(study.results)):
        forget_failures(Path(study.results), every=bool(os.environ.get(RETRY)))
    if not options:  # nothing is computed on a cluster's front end
        _first_report(config, study)
    started = time.time()
    whole = snakemake(config, study.results, options=options)
    # The log of what follows the summary shows whether this run has come so far.
    log = Path(study.results, "logs/complete.log")
    if whole or (log.is_file() and log.stat().st_mtime > started):
        print(Path(study.results, "summary.txt").read_text(), end="")
    if whole and not study.samples:  # the summary of joints names it
        print(f"Report: {study.results}/{REPORT}")
    if whole:
        return None
    left = shutil.disk_usage(study.results).free / 1e6
    why = f"its disk has {left:.2g} MB left" if left < LITTLE else "see above"
    return f"{study.results}: the study is incomplete, {why}"


def forget_failures(results: Path, *, every: bool) -> None:
    """Remove the records of cases without a result, so that the next run tries them again.

    Those that an engine broke down in, or ``every`` one; and records that cannot be read.
    """
    records = [mark.with_name(RECORD) for mark in results.rglob(BROKE_DOWN)]
    for path in (*results.rglob(RECORD), *results.rglob(BATCH_RECORDS)):
        try:
            found = read_records([path])
            own = [results / each.folder for each in found] == [path.parent]
            if not found or (path.name == RECORD and not own):
                raise ResultError(f"{path}: damaged, not the record of this case")
            if every and any(each.error is not None for each in found):
                records.append(path)
        except ResultError as error:
            print(f"{error}; its cases run again", file=sys.stderr)
            records.append(path)
    for path in records:
        path.unlink(missing_ok=True)


def _first_report(config: Path, study: Study) -> None:
    """Write a first report without the engines, which may take long.

    Only if there is no report yet; it is written again when the engines have ended.
    """
    path = Path(study.results, REPORT)
    engines = study.samples and study.dem.engines and REFERENCE_MODEL in study.models
    if engines and not path.exists():
        print("Writing a first report without the engines", file=sys.stderr)
        snakemake(config, study.results, (str(path),), engines=False)


def write_report(config: Path, results: str | None) -> str | None:
    """Write the report; returns an error message, or None."""
    study = read_study_file(config, results)
    return _made(config, study, "report", str(Path(study.results, REPORT)))


def write_decks(config: Path, results: str | None) -> str | None:
    """Write the decks for 3DEC; returns an error message, or None."""
    study = study_with_joints(config, results)
    return _made(config, study, "decks", f"{study.results}/decks/3dec", "decks")


def _made(
    config: Path, study: Study, what: str, path: str, target: str | None = None
) -> str | None:
    if not snakemake(config, study.results, (target or path,)):
        return f"no {what}, see above"
    print(f"{what.capitalize()}: {path}")
    return None


def case_rows(config: Path, results: str | None) -> list[dict[str, Any]]:
    """One row for each case, with its state, peak (N), and the reason if there is none.

    Outdated is what was made from another configuration or by other code. `ConfigError` for a
    configuration that is not valid.
    """
    study = read_study_file(config, results)
    found: dict[str, tuple[Record[Any] | None, bool]] = {}
    for path, valid in _current(config, study.results).items():
        try:
            found |= {record.folder: (record, valid) for record in read_records([path])}
        except (OSError, ValueError):
            continue
    jobs = case_jobs(study)
    cases: list[Case[Any]] = [*jobs.joints.values(), *jobs.structures.values()]
    cases += chain.from_iterable(jobs.earthquakes.values())
    return [
        {"model": case.model, "case": case.name, **_state(*found.get(case.folder, (None, False)))}
        for case in cases
    ]


def _current(config: Path, results: str) -> dict[Path, bool]:
    """The records that Snakemake knows, and whether each is up to date."""
    command = [*snakemake_command(config, results), "--summary"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = csv.DictReader(text.splitlines(), delimiter="\t")
    return {
        Path(row["output_file"]): row["plan"] == CURRENT
        for row in rows
        if Path(row["output_file"]).name in (RECORD, BATCH_RECORDS)
    }


def _state(record: Record[Any] | None, valid: bool) -> dict[str, Any]:
    """The state of a case, its peak, and why it has none; a model refuses what it cannot do."""
    state = "done" if valid else "outdated"
    if record is None:
        state = "to do"
    elif record.refused or record.error is not None:
        state = "refused" if record.refused else "failed"
    note = (record.refused or record.error or "") if record else ""
    return {"state": state, "peak (N)": record and record.load_N, "note": note}


def main() -> None:
    """Command line: a command, a configuration and a results folder."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    parser = options_of("python -m workflow", __doc__, ["study", "report", "decks", "cases"])
    parser.add_argument(
        "--profile", help="profile of a cluster: a folder in profiles, such as slurm"
    )
    parser.add_argument(
        "--format", default="table", choices=FORMATS, help="of the list of cases; default: table"
    )
    arguments = parser.parse_args()
    config, results = arguments.config, arguments.results or None
    commands = {
        "study": lambda: run_study(config, results, profile_named(arguments.profile)),
        "report": lambda: write_report(config, results),
        "decks": lambda: write_decks(config, results),
        "cases": lambda: print(text_of(case_rows(config, results), arguments.format)),
    }
    run_command(commands[arguments.what], arguments)


if __name__ == "__main__":
    main()
