"""The cases of a study and their state, as `make cases` lists them."""

from pathlib import Path
from typing import Any

from workflow.configuration import read_study_file
from workflow.joints.case import CaseId
from workflow.planning.plan import Job, why
from workflow.planning.snakefile import plan_of
from workflow.results.files import read_records
from workflow.results.record import CaseRecord, ResultError
from workflow.structures.case import FOLDER
from workflow.structures.record import StructureRecord, read_structure_records

DONE, FAILED, OUTDATED, TO_DO = "done", "failed", "outdated", "to do"
REFUSED = "refused"  # by a model that cannot do such a structure


def case_rows(config: Path, results: str | None) -> list[dict[str, Any]]:
    """One row for each case, with its state, peak (N), and the reason if there is none.

    Outdated is what was made from another configuration or by other code. `ConfigError` for a
    configuration that is not valid.
    """
    study = read_study_file(config, results)
    plan, folder = plan_of(study), Path(study.results)
    rows = []
    for job in plan.made.values():
        if not job.finds:
            continue
        found = _records(job, folder)
        valid = why(job, job.digest(), folder) is None
        rows += [
            {"model": case.model, "case": case.name, **_state(found.get(case), valid)}
            for case in job.finds
            if case in plan.cases
        ]
    return rows


def _records(job: Job, folder: Path) -> dict[CaseId, CaseRecord | StructureRecord]:
    """Records that a job has made, by case; empty if it has not run."""
    path = folder / job.written[0]
    try:
        read = read_structure_records if job.name.startswith(f"{FOLDER}/") else read_records
        return {each.id: each for each in read([path])}
    except (OSError, ResultError):
        return {}


def _state(record: CaseRecord | StructureRecord | None, valid: bool) -> dict[str, Any]:
    if record is None:
        return {"state": TO_DO, "peak (N)": None, "note": ""}
    if isinstance(record, StructureRecord) and record.refused:
        return {"state": REFUSED, "peak (N)": None, "note": record.refused}
    if record.error is not None:
        return {"state": FAILED, "peak (N)": None, "note": record.error}
    return {"state": DONE if valid else OUTDATED, "peak (N)": record.load_N, "note": ""}
