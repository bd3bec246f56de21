"""Run an engine on a case, check what it returns, and write the record."""

import json
from pathlib import Path
from typing import Any

from sidmacib.engines import ENGINES
from sidmacib.engines.run import (
    EngineError,
    EngineKilledError,
    EngineNoAnswerError,
    engine_outcome,
    refusal,
)
from sidmacib.engines.scripts.assembly import NEVER_FALLS
from sidmacib.engines.scripts.records import OUTPUTS
from sidmacib.errors import CapacityError, ResultError
from workflow.case import Case
from workflow.results import BROKE_DOWN, CASE, Record, record_of, record_without_result
from workflow.step import Arguments, Files, KilledError, step


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record and, if the engine succeeds, its files; returns the error message."""
    case: Case[Any] = Case.from_json(arguments["case"])
    record, result = outputs["record"], outputs["result"]
    folder, wrong = record.parent, None
    (folder / CASE).write_text(case.to_json())
    for name in (BROKE_DOWN, *OUTPUTS):
        (folder / name).unlink(missing_ok=True)
    try:
        found = found_by_engine(case, folder, arguments["time_limit"])
        if found.refused:
            _say(result, found.refused)
    except (EngineError, ResultError, CapacityError, ValueError) as error:
        reason = f"{case.name}: {case.model}: {error}"
        leave_no_result(error, reason, folder, last_try=arguments["last_try"])
        if NEVER_FALLS in str(error):  # an answer, if not a number
            found = record_without_result(case, refused=f"{case.model}: {NEVER_FALLS}")
        else:
            found = record_without_result(case, error=f"{case.model}: {_in_short(error)}")
            wrong = reason
        _say(result, _in_short(error))
    record.write_text(found.to_json() + "\n")
    return wrong


def found_by_engine(case: Case[Any], folder: Path, time_limit: float) -> Record[Any]:
    """The checked record of ``case``, or a record of the reason why its engine refuses it."""
    engine, numerics = ENGINES[case.model], case.numerics
    assert numerics is not None, f"{case.name}: an engine needs numerics"
    problem = case.subject.problem()
    if reason := refusal(engine, *problem):
        return record_without_result(case, refused=f"{engine.name}: {reason}")
    outcome = engine_outcome(engine, problem, numerics, f"{case.name}.", folder, time_limit)
    return record_of(case, problem, outcome, {engine.name: engine.version()})


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


def _in_short(error: Exception) -> str:
    return error.in_short if isinstance(error, EngineError) else str(error)


def _say(result: Path, error: str) -> None:
    """Write why there is no result where it would be."""
    result.write_text(json.dumps({"error": error}) + "\n")


if __name__ == "__main__":
    step(run)
