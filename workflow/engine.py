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
from sidmacib.engines.scripts.records import FALLS_ALONE, OUTPUTS
from sidmacib.errors import CapacityError, ResultError
from sidmacib.mechanics.raised import NEVER_FALLS
from workflow.case import Case
from workflow.results import BROKE_DOWN, CASE, record_of, record_without_result
from workflow.step import Arguments, Files, KilledError, step


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the record and, if the engine succeeds, its files; returns the error message.

    `KilledError` if the engine was killed and this is not the last try. A mark beside the record
    says that the engine may not end so again.
    """
    case: Case[Any] = Case.from_json(arguments["case"])
    engine, numerics = ENGINES[case.model], case.numerics
    assert numerics is not None, f"{case.name}: an engine needs numerics"
    record, result = outputs["record"], outputs["result"]
    folder, wrong = record.parent, None
    (folder / CASE).write_text(case.to_json())
    for name in (BROKE_DOWN, *OUTPUTS):
        (folder / name).unlink(missing_ok=True)
    try:
        problem = case.subject.problem()
        if reason := refusal(engine, *problem):
            found = record_without_result(case, refused=f"{engine.name}: {reason}")
            _say(result, f"{engine.name}: {reason}")
        else:
            what = problem, numerics, f"{case.name}.", folder, arguments["time_limit"]
            outcome = engine_outcome(engine, *what)
            found = record_of(case, problem, outcome, engine.versions())
    except (EngineError, ResultError, CapacityError, ValueError) as error:
        words = error.in_short if isinstance(error, EngineError) else str(error)
        reason = f"{case.name}: {case.model}: {error}"
        if isinstance(error, EngineKilledError) and not arguments["last_try"]:
            raise KilledError(reason) from error
        for name in OUTPUTS:
            (folder / name).unlink(missing_ok=True)
        if not isinstance(error, EngineNoAnswerError | CapacityError):
            (folder / BROKE_DOWN).touch()
        told = [each for each in (NEVER_FALLS, FALLS_ALONE) if words.endswith(each)]
        if told:  # an answer, if not a number
            found = record_without_result(case, refused=f"{case.model}: {told[0]}")
        else:
            found = record_without_result(case, error=f"{case.model}: {words}")
            wrong = reason
        _say(result, words)
    record.write_text(found.to_json() + "\n")
    return wrong


def _say(result: Path, error: str) -> None:
    """Write why there is no result where it would be."""
    result.write_text(json.dumps({"error": error}) + "\n")


if __name__ == "__main__":
    step(run)
