"""Run an engine on a case of a structure, check what it returns, and write the record."""

from pathlib import Path

from sidmacib.engines import ENGINES
from sidmacib.engines.execute import EngineError
from sidmacib.engines.guide import guide_for
from sidmacib.engines.run import refusal, run_engine
from sidmacib.engines.scripts.assembly import NEVER_FALLS
from sidmacib.engines.scripts.records import HISTORY
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly
from sidmacib.models.found import Found
from sidmacib.structure.files.structure_file import structure_of
from workflow.results.files import BROKE_DOWN, CASE, read_outcome, read_table
from workflow.results.record import ResultError, check_bracket
from workflow.run.step import Arguments, Files, step
from workflow.steps.engine import in_short, leave_no_result
from workflow.structures.case import StructureCase
from workflow.structures.record import StructureRecord, record_without_result, structure_record

BROKEN = "_broken_share"  # suffix of a history's columns of broken bonds


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record, and beside it the engine's files; returns the error message."""
    case, path = StructureCase.from_json(arguments["case"]), outputs["record"]
    folder = path.parent
    (folder / CASE).write_text(case.to_json())
    (folder / BROKE_DOWN).unlink(missing_ok=True)
    wrong: str | None = None
    try:
        record = found_by_engine(case, folder, arguments["time_limit"])
    except (EngineError, ResultError, CapacityError, ValueError) as error:
        reason = f"{case.name}: {case.model}: {error}"
        leave_no_result(error, reason, folder, last_try=arguments["last_try"])
        if NEVER_FALLS in str(error):  # an answer, if not a number
            record = record_without_result(case, refused=f"{case.model}: {NEVER_FALLS}")
        else:
            record = record_without_result(case, error=f"{case.model}: {in_short(str(error))}")
            wrong = reason
    path.write_text(record.to_json() + "\n")
    return wrong


def found_by_engine(case: StructureCase, folder: Path, time_limit: float) -> StructureRecord:
    """The checked record of ``case``, or a record of the reason why its engine refuses it."""
    engine = ENGINES[case.model]
    assert case.numerics is not None, f"{case.name}: an engine needs numerics"
    problem = structure_of(case.description)
    if reason := refusal(engine, problem.assembly):
        return record_without_result(case, refused=f"{engine.name}: {reason}")
    guide = guide_for(engine, problem, case.numerics)
    run_engine(engine, problem, case.numerics, f"{case.name}.", folder, time_limit, guide)
    outcome = read_outcome(folder, problem.assembly)
    check_bracket(
        outcome,
        case.numerics.tolerance,
        case.numerics.first_increment * problem.loads.scale,
    )
    found = Found(outcome, broken_at=broken_at(folder / HISTORY, problem.assembly))
    return structure_record(case, problem, found, {engine.name: engine.version()})


def broken_at(history: Path, assembly: Assembly) -> dict[int, float]:
    """The least load (N) with a broken share of each face; in the order of loads, then shares."""
    names = {f"{face.name}{BROKEN}": number for number, face in enumerate(assembly.faces)}
    rows = read_table(history, ("load_N",))
    broken = [
        (float(row["load_N"]), -float(row[name]), number)
        for row in rows
        for name, number in names.items()
        if name in row and float(row[name]) > 0.0
    ]
    found: dict[int, float] = {}
    for load, _, number in sorted(broken):
        found.setdefault(number, load)
    return found


if __name__ == "__main__":
    step(run)
