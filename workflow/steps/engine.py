"""Run an engine on a case, check what it returns, and write the record."""

import importlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sidmacib.errors import CapacityError
from sidmacib.problem import Problem
from workflow.engines import ENGINES
from workflow.engines.execute import EngineError, EngineKilledError, EngineNoAnswerError
from workflow.engines.run import run_engine
from workflow.engines.scripts.assembly import Guide
from workflow.engines.scripts.records import OUTPUTS
from workflow.joints.case import Case
from workflow.joints.problem import problem_of
from workflow.results.files import CASE, read_outcome, write_record
from workflow.results.record import (
    ResultError,
    check_bracket,
    check_first_failure,
    failed_record,
    record_of,
)
from workflow.run.attempts import KilledError, Settled, last_try


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> str | None:
    """Write the record and, if the engine succeeds, its files; returns the error message."""
    case = Case.from_json(arguments["case"])
    record, result = outputs["record"], outputs["result"]
    folder = record.parent
    (folder / CASE).write_text(case.to_json())
    engine = ENGINES[case.model]
    assert case.numerics is not None, f"{case.name}: an engine needs numerics"
    title = f"{case.name}: {case.joint.locks} locks, mesh {case.mesh:g} m."
    try:
        problem = problem_of(case)
        guide = find_guide(folder.parents[1], arguments["guides_code"], case, problem)
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
        if isinstance(error, EngineKilledError) and not last_try():
            raise KilledError(f"{case.name}: {case.model}: {error}") from error
        for name in OUTPUTS:
            (folder / name).unlink(missing_ok=True)
        result.write_text(json.dumps({"error": in_short(str(error))}) + "\n")
        write_record(failed_record(case, f"{case.model}: {in_short(str(error))}"), record)
        reason = f"{case.name}: {case.model}: {error}"
        settled = isinstance(error, EngineNoAnswerError | CapacityError)
        return Settled(reason) if settled else reason
    return None


def find_guide(cases: Path, code: str, case: Case, problem: Problem) -> Guide | None:
    """Where the search of ``case`` begins; None: at 0.

    From what `workflow.steps.guides` left in the folder ``cases``, if it is of the same ``code``.
    """
    engine, numerics = ENGINES[case.model], case.numerics
    if numerics is None or not engine.wants_guide(numerics):
        return None
    try:
        found = json.loads((cases / "guides" / f"{case.model}.json").read_text())
        if found["code"] == code:
            loads = found["guides"][case.digest()]
            return Guide(**loads) if loads else None
    except (OSError, ValueError, TypeError, KeyError):
        pass  # not there yet
    # Imported here: it takes as long as an engine takes to start.
    module = importlib.import_module("workflow.engines.guide")
    guide: Guide | None = module.guide_for(engine, problem, numerics)
    return guide


def in_short(reason: str) -> str:
    """A reason on one line: how the engine ended, and the last line of its log."""
    first, *log = reason.splitlines()
    ending = first.partition("; end of ")[0]
    return f"{ending}: {log[-1].strip(' |')}" if log else ending
