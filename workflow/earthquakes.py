"""Move a structure by one record at all factors, and write the records of these cases."""

from dataclasses import replace

from sidmacib.answers.in_time import TimeAnswer
from sidmacib.errors import CapacityError
from workflow.case import EarthquakeCase
from workflow.results import record_without_result
from workflow.results.earthquake_part import EarthquakePart, EarthquakeRecord
from workflow.step import Arguments, Files, step


def moved(case: EarthquakeCase) -> EarthquakeRecord:
    """What happens in a ``case``, or why that is not known."""
    try:
        answer = TimeAnswer.of(case.subject.problem(), factor=case.subject.factor)
    except (CapacityError, ValueError, MemoryError) as error:
        reason = str(error) or "out of memory"
        return record_without_result(case, error=f"{case.model}: {reason}", raised=error)
    return replace(record_without_result(case), part=EarthquakePart.moved(case, answer))


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write a record of each case."""
    found = [moved(EarthquakeCase.from_json(text)) for text in arguments["cases"]]
    outputs["records"].write_text("".join(each.to_json() + "\n" for each in found))
    return "\n".join(f"{each.name}: {each.error}" for each in found if each.error) or None


if __name__ == "__main__":
    step(run)
