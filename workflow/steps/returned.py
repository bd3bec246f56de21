"""Read the output of a program run elsewhere for a case, check it, and write the record."""

from workflow.joints.case import Case
from workflow.results.files import write_record
from workflow.results.record import ResultError, failed_record, record_of
from workflow.run.step import Arguments, Files, step
from workflow.threedec import read_returned


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record; returns the error message, or None."""
    case = Case.from_json(arguments["case"])
    try:
        problem, found = read_returned(inputs["printed"].read_text(errors="replace"), case)
        record = record_of(case, problem, found, {})
    except (OSError, ResultError) as error:
        record = failed_record(case, f"{case.model}: {error}")
    write_record(record, outputs["record"])
    return None if record.error is None else f"{case.name}: {record.error}"


if __name__ == "__main__":
    step(run)
