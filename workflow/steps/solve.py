"""Solve a batch of cases in this process, check what comes out, and write records and tables."""

import importlib
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.outcome import Outcome
from sidmacib.problem import Problem
from workflow.joints.case import Case
from workflow.joints.problem import problem_of
from workflow.results.files import NODE_COLUMNS, force_to_stress
from workflow.results.record import CaseRecord, ResultError, failed_record, record_of
from workflow.run.step import Arguments, Files, step

HISTORY_COLUMNS = ("load_N", "displacement_m")


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write records, nodes and histories; the record of a case that fails holds the reason."""
    solver = importlib.import_module(arguments["module"])
    records: list[CaseRecord] = []
    nodes: list[pa.Table] = []
    histories: list[pa.Table] = []
    for data in arguments["cases"]:
        case = Case.from_json(data)
        try:
            record, assembly, outcome = solved(case, solver.solve)
        except (CapacityError, ResultError, ValueError, MemoryError) as error:
            reason = str(error) or "out of memory"
            records.append(failed_record(case, f"{case.model}: {reason}"))
            continue
        records.append(record)
        nodes += node_table(case, assembly, outcome)
        histories.append(history_table(case, outcome))
    outputs["records"].write_text("".join(record.to_json() + "\n" for record in records))
    for tables, path in ((nodes, outputs["nodes"]), (histories, outputs["history"])):
        whole = pa.concat_tables(tables) if tables else pa.table({})
        pq.write_table(whole, path, compression="zstd")
    failed = [record for record in records if record.error]
    return "\n".join(f"{record.name}: {record.error}" for record in failed) or None


def solved(case: Case, solve: Callable[[Problem], Outcome]) -> tuple[CaseRecord, Assembly, Outcome]:
    """The checked record of ``case``, its assembly and the model's outcome."""
    problem = problem_of(case)
    outcome = solve(problem)
    return record_of(case, problem, outcome, {}), problem.assembly, outcome


def node_table(case: Case, assembly: Assembly, outcome: Outcome) -> list[pa.Table]:
    """Stresses at the peak, one row per node, in the columns of an engine's nodes.csv.

    No table if the model computes no stresses.
    """
    nodes, peak = assembly.nodes, outcome.path[-1]
    if peak.force is None or peak.bonded is None:
        return []
    stress = force_to_stress(nodes, face_frames(assembly), peak.force)
    values: Floats = np.column_stack([nodes.position, nodes.area, stress])
    columns: dict[str, Any] = {
        "case": _repeated(case.name, len(values)),
        "face": _named([face.name for face in assembly.faces], nodes.face),
        "kind": _named([str(face.kind) for face in assembly.faces], nodes.face),
    }
    columns |= dict(zip(NODE_COLUMNS[2:], values.T, strict=False))
    return [pa.table(columns | {"bonded": peak.bonded.astype(np.int8)})]


def history_table(case: Case, outcome: Outcome) -> pa.Table:
    """Load and displacement of each equilibrium on the way, one row each."""
    load, moved = HISTORY_COLUMNS
    columns = {
        "case": _repeated(case.name, len(outcome.path)),
        load: pa.array([state.load for state in outcome.path]),
        moved: pa.array([state.displacement for state in outcome.path], pa.float64()),
    }
    return pa.table(columns)


def _repeated(text: str, count: int) -> pa.Array:
    return _named([text], np.zeros(count, dtype=np.int32))


def _named(names: Iterable[str], index: Any) -> pa.Array:
    plain = pa.DictionaryArray.from_arrays(pa.array(index, pa.int32()), pa.array(list(names)))
    return plain.cast(pa.string())


if __name__ == "__main__":
    step(run)
