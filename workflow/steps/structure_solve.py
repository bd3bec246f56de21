"""Solve the cases of one structure in this process, check them, and write their records."""

import importlib

from sidmacib.engines.scripts.assembly import NEVER_FALLS
from sidmacib.errors import CapacityError, UnboundedError
from sidmacib.model import Ability
from sidmacib.models import MODELS
from sidmacib.structure.files.structure_file import structure_of
from workflow.results.record import ResultError
from workflow.run.step import Arguments, Files, step
from workflow.structures.case import StructureCase
from workflow.structures.record import StructureRecord, record_without_result, structure_record


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write the records; that of a case without a result holds the reason."""
    module = arguments["module"]
    records = [solved(StructureCase.from_json(data), module) for data in arguments["cases"]]
    outputs["records"].write_text("".join(record.to_json() + "\n" for record in records))
    failed = [f"{record.name}: {record.error}" for record in records if record.error]
    return "\n".join(failed) or None


def solved(case: StructureCase, module: str) -> StructureRecord:
    """The record of ``case``, solved by the ``solve`` of a module."""
    try:
        problem = structure_of(case.description)
        reason = problem.assembly.without_stiffness
        if reason and Ability.CONDENSED not in MODELS[case.model].abilities:
            return record_without_result(case, refused=f"{case.model}: {reason}")
        try:
            found = importlib.import_module(module).solve(problem)
        except UnboundedError:
            if problem.loads.axis is None:
                raise
            return record_without_result(case, refused=f"{case.model}: {NEVER_FALLS}")
        return structure_record(case, problem, found, {})
    except (CapacityError, ResultError, ValueError, MemoryError) as error:
        reason = str(error) or "out of memory"
        return record_without_result(case, error=f"{case.model}: {reason}")


if __name__ == "__main__":
    step(run)
