"""The cases of a study and their state, as `make cases` lists them."""

import csv
import subprocess
from pathlib import Path
from typing import Any

from workflow.configuration import read_study_file
from workflow.planning.batches import case_jobs
from workflow.results.files import BATCH_RECORDS, RECORD, read_records
from workflow.results.record import CaseRecord, ResultError
from workflow.run.command import snakemake_command
from workflow.structures.case import FOLDER
from workflow.structures.cases import structure_jobs
from workflow.structures.record import StructureRecord, read_structure_records

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
    current, records = _current(config, study.results), Path(study.results)
    found: dict[Any, tuple[CaseRecord | StructureRecord | None, bool]] = {}
    for path in current:
        read = read_structure_records if path.is_relative_to(records / FOLDER) else read_records
        try:
            found |= {record.id: (record, current[path]) for record in read([path])}
        except (OSError, ResultError):
            continue
    cases: list[Any] = [*case_jobs(study).cases.values(), *structure_jobs(study).cases.values()]
    return [
        {"model": case.model, "case": case.name, **_state(*found.get(case.id, NONE))}
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


def _state(record: CaseRecord | StructureRecord | None, valid: bool) -> dict[str, Any]:
    if record is None:
        return {"state": TO_DO, "peak (N)": None, "note": ""}
    if isinstance(record, StructureRecord) and record.refused:
        return {"state": REFUSED, "peak (N)": None, "note": record.refused}
    if record.error is not None:
        return {"state": FAILED, "peak (N)": None, "note": record.error}
    return {"state": DONE if valid else OUTDATED, "peak (N)": record.load_N, "note": ""}
