"""Solve a batch of cases in this process, check what comes out, and write records and tables.

On request, also the files of one of these cases, like those in an engine's folder.
"""

import importlib
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.engines.results import NODE_COLUMNS, force_to_stress
from sidmacib.engines.scripts.records import HISTORY, NODES
from sidmacib.errors import (
    DOES_NOT_STAND,
    CapacityError,
    NoStiffnessError,
    ResultError,
    UnboundedError,
)
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.model import Ability
from sidmacib.models import MODELS
from sidmacib.problem import Outcome, Problem
from workflow.case import Case, JointCase
from workflow.results import (
    BATCH_HISTORY,
    BATCH_NODES,
    CASE,
    RECORD,
    Record,
    read_records,
    record_of,
    record_without_result,
)
from workflow.step import Arguments, Files, step

Solve = Callable[[Problem], Outcome]
Solved = tuple[Record[Any], Assembly, Outcome]
LOADS = ("failed_load_N", "first_failure_load_N", "mode", "peak_spread", "error")


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write records, nodes and histories; the record of a case without a result has the reason."""
    solve: Solve = importlib.import_module(arguments["module"]).solve
    records: list[Record[Any]] = []
    nodes: list[pd.DataFrame] = []
    histories: list[pd.DataFrame] = []
    for data in arguments["cases"]:
        case: Case[Any] = Case.from_json(data)
        found = solved_or_not(case, solve)
        if isinstance(found, Record):
            records.append(found)
            continue
        record, assembly, outcome = found
        records.append(record)
        nodes += node_table(case, assembly, outcome)
        histories.append(history_table(case, outcome))
    outputs["records"].write_text("".join(record.to_json() + "\n" for record in records))
    for tables, path in ((nodes, outputs["nodes"]), (histories, outputs["history"])):
        whole = pd.concat(tables) if tables else pd.DataFrame()
        whole.to_parquet(path, compression="zstd", index=False)
    failed = [record for record in records if record.error]
    return "\n".join(f"{record.name}: {record.error}" for record in failed) or None


def solved_or_not(case: Case[Any], solve: Solve) -> Solved | Record[Any]:
    """What `solved` returns, or a record with the reason why there is no result."""
    try:
        problem = case.subject.problem()
        reason = problem.assembly.without_stiffness
        if reason and Ability.CONDENSED not in MODELS[case.model].abilities:
            stops = NoStiffnessError(reason)
            return record_without_result(case, refused=f"{case.model}: {reason}", raised=stops)
        return solved(case, solve, problem)
    except UnboundedError as error:
        if never := problem.loads.raised.endless:
            return record_without_result(case, refused=f"{case.model}: {never}")
        key = "refused" if case.subject.demands else "error"  # any load is an answer to a demand
        return record_without_result(case, **{key: f"{case.model}: {error}"}, raised=error)
    except (CapacityError, ResultError, ValueError, MemoryError) as error:
        reason = str(error) or "out of memory"
        key = "refused" if DOES_NOT_STAND in reason else "error"  # that it falls is an answer
        return record_without_result(case, **{key: f"{case.model}: {reason}"}, raised=error)


def solved(case: Case[Any], solve: Solve, problem: Problem | None = None) -> Solved:
    """The checked record of ``case``, its assembly and the model's outcome.

    ``problem``: of its subject, if known already.
    """
    problem = case.subject.problem() if problem is None else problem
    outcome = solve(problem)
    record = record_of(case, problem, outcome, {})
    return record, outcome.cells or problem.assembly, outcome


def node_table(case: Case[Any], assembly: Assembly, outcome: Outcome) -> list[pd.DataFrame]:
    """Stresses at the load that counts, one row per node, in the columns of an engine's nodes.csv.

    No table if the model computes no stresses.
    """
    nodes, state = assembly.nodes, outcome.state
    if state.force is None or state.bonded is None:
        return []
    stress = force_to_stress(nodes, face_frames(assembly), state.force)
    values: Floats = np.column_stack([nodes.position, nodes.area, stress])
    columns = {
        "case": case.name,
        "face": np.array([face.name for face in assembly.faces])[nodes.face],
        "kind": np.array([str(face.kind) for face in assembly.faces])[nodes.face],
        **dict(zip(NODE_COLUMNS[2:], values.T, strict=False)),
        "bonded": state.bonded.astype(np.int8),
    }
    return [pd.DataFrame(columns)]


def history_table(case: Case[Any], outcome: Outcome) -> pd.DataFrame:
    """Load and displacement of each equilibrium on the way, one row each; nan where unknown."""
    rows = [(state.load, state.displacement) for state in outcome.path]
    table = pd.DataFrame(rows, columns=["load_N", "displacement_m"], dtype=float)
    table.insert(0, "case", case.name)
    return table


def write_case_files(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the description, nodes, history, loads and record of the case."""
    case, records = JointCase.from_json(arguments["case"]), inputs["records"]
    result, folder = outputs["result"], outputs["result"].parent
    (record,) = (each for each in read_records([records]) if each.name == case.name)
    (folder / CASE).write_text(case.to_json())
    for source, target in ((BATCH_NODES, NODES), (BATCH_HISTORY, HISTORY)):
        rows = pd.read_parquet(records.with_name(source), filters=[("case", "==", case.name)])
        rows.drop(columns="case").to_csv(folder / target, index=False, float_format="%.10g")
    loads = {"peak_load_N": record.load_N} | {name: getattr(record, name) for name in LOADS}
    result.write_text(json.dumps(loads, indent=1) + "\n")
    (folder / RECORD).write_text(record.to_json() + "\n")


if __name__ == "__main__":
    step(run, case_files=write_case_files)
