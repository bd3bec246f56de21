"""Read the output of a program run elsewhere for a case, check it, and write the record."""

from sidmacib.errors import ResultError
from workflow.case import JointCase
from workflow.results.record import record_of, record_without_result, write_record
from workflow.run.step import Arguments, Files, step
from workflow.threedec import read_returned


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record; returns the error message, or None."""
    case = JointCase.from_json(arguments["case"])
    try:
        problem, found = read_returned(inputs["printed"].read_text(errors="replace"), case)
        record = record_of(case, problem, found, {})
    except (OSError, ResultError) as error:
        record = record_without_result(case, error=f"{case.model}: {error}")
    write_record(record, outputs["record"])
    return None if record.error is None else f"{case.name}: {record.error}"


if __name__ == "__main__":
    step(run)
