"""The cases of a study and their state, as `make cases` lists them."""

import csv
import subprocess
from pathlib import Path
from typing import Any

from sidmacib.errors import ResultError
from workflow.case import Case
from workflow.configuration import read_study_file
from workflow.planning.batches import case_jobs
from workflow.results.files import BATCH_RECORDS, RECORD
from workflow.results.record import Record, read_records
from workflow.run.command import snakemake_command

DONE, FAILED, OUTDATED, TO_DO = "done", "failed", "outdated", "to do"
REFUSED = "refused"  # by a model that cannot do such a structure
NONE = (None, False)
CURRENT = "no update"  # what Snakemake plans for an output that is up to date


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
        except (OSError, ResultError):
            continue
    jobs = case_jobs(study)
    cases: list[Case[Any]] = [*jobs.joints.values(), *jobs.structures.values()]
    return [
        {"model": case.model, "case": case.name, **_state(*found.get(case.folder, NONE))}
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
    if record is None:
        return {"state": TO_DO, "peak (N)": None, "note": ""}
    if record.refused:
        return {"state": REFUSED, "peak (N)": None, "note": record.refused}
    if record.error is not None:
        return {"state": FAILED, "peak (N)": None, "note": record.error}
    return {"state": DONE if valid else OUTDATED, "peak (N)": record.load_N, "note": ""}
