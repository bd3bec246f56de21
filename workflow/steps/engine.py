"""Run an engine on a case, check what it returns, and write the record."""

import json
from pathlib import Path

from sidmacib.engines import ENGINES
from sidmacib.engines.execute import EngineError, EngineKilledError, EngineNoAnswerError
from sidmacib.engines.guide import guide_for
from sidmacib.engines.run import run_engine
from sidmacib.engines.scripts.records import OUTPUTS
from sidmacib.errors import CapacityError
from workflow.joints.case import Case
from workflow.joints.problem import problem_of
from workflow.results.files import BROKE_DOWN, CASE, read_outcome, write_record
from workflow.results.record import (
    ResultError,
    check_bracket,
    check_first_failure,
    failed_record,
    record_of,
)
from workflow.run.step import Arguments, Files, KilledError, step


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record and, if the engine succeeds, its files; returns the error message."""
    case = Case.from_json(arguments["case"])
    record, result = outputs["record"], outputs["result"]
    folder = record.parent
    (folder / CASE).write_text(case.to_json())
    (folder / BROKE_DOWN).unlink(missing_ok=True)
    engine = ENGINES[case.model]
    assert case.numerics is not None, f"{case.name}: an engine needs numerics"
    title = f"{case.name}: {case.joint.locks} locks, mesh {case.mesh:g} m."
    try:
        problem = problem_of(case)
        guide = guide_for(engine, problem, case.numerics)
        settings = case.numerics, title, folder, arguments["time_limit"], guide
        run_engine(engine, problem, *settings)
        outcome = read_outcome(folder, problem.assembly)
        least = case.numerics.first_increment * problem.loads.scale
        check_bracket(outcome, case.numerics.tolerance, least)
        if guide:
            check_first_failure(outcome, guide.first_event_N)
        versions = {engine.name: engine.version()}
        write_record(record_of(case, problem, outcome, versions), record)
    except (EngineError, ResultError, CapacityError) as error:
        reason = f"{case.name}: {case.model}: {error}"
        leave_no_result(error, reason, folder, last_try=arguments["last_try"])
        result.write_text(json.dumps({"error": in_short(str(error))}) + "\n")
        write_record(failed_record(case, f"{case.model}: {in_short(str(error))}"), record)
        return reason
    return None


def leave_no_result(error: Exception, reason: str, folder: Path, *, last_try: bool) -> None:
    """Remove an engine's files from ``folder``, and mark it unless the engine would end so again.

    `KilledError` with the ``reason`` if the engine was killed and this is not the ``last_try``.
    """
    if isinstance(error, EngineKilledError) and not last_try:
        raise KilledError(reason) from error
    for name in OUTPUTS:
        (folder / name).unlink(missing_ok=True)
    if not isinstance(error, EngineNoAnswerError | CapacityError):
        (folder / BROKE_DOWN).touch()


def in_short(reason: str) -> str:
    """A reason on one line: how the engine ended, and the last line of its log."""
    first, *log = reason.splitlines()
    ending = first.partition("; end of ")[0]
    return f"{ending}: {log[-1].strip(' |')}" if log else ending


if __name__ == "__main__":
    step(run)
