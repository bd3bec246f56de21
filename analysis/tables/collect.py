"""Collect the records of all cases in tables."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mechanics.solution import Mode
from sidmacib.mesh_error import LoadKind, kind_of, mesh_errors
from sidmacib.models import REFERENCE_MODEL, SOLVED, first_failure_only
from sidmacib.problem import UNKNOWN, MeshErrors
from workflow.case import REFERENCE
from workflow.results import read_records
from workflow.results.joint_part import JointRecord
from workflow.results.tables import CASES, MODELS, WEIGHT_SUMS, WEIGHTS, write_tables
from workflow.step import Arguments, FileLists, Files, step

SHARES = (0.25, 0.5, 0.75)  # given loads over the leading model's first failure load


def weights_table(records: Iterable[JointRecord]) -> pd.DataFrame:
    """One row per lock of every case whose model gives stresses."""
    return WEIGHTS.frame(
        record.columns() | asdict(weight) for record in records for weight in record.part.weights
    )


def weight_sums(weights: pd.DataFrame) -> pd.DataFrame:
    """One row per case: W_sum, W_sum rounded down, and the sum over the lower locks."""
    case = [column for column in WEIGHT_SUMS.columns if column in weights]
    lower = weights["weight"].where(weights["block"] == "lower", 0.0)
    groups = weights.assign(lower=lower).groupby(case, sort=False)
    sums = groups.agg(weight_sum=("weight", "sum"), lower_weight_sum=("lower", "sum"))
    return sums.assign(weight_sum_floor=np.floor(sums["weight_sum"]).astype(int)).reset_index()


def cases_table(records: Sequence[JointRecord], all_records: Sequence[JointRecord]) -> pd.DataFrame:
    """One row per case; failed ones have the reason.

    ``all_records``: these and those on further meshes. Each record is compared with that of the
    static model for the same joint, nodes and load, see `_compared`; mesh errors come from all
    meshes.
    """
    mesh_errors = errors_of([*all_records, *records])
    static = {record.physics: record for record in all_records if record.model == REFERENCE_MODEL}
    rows = []
    for record in records:
        load, compared = record.load_N, _compared(record, static.get(record.physics))
        row = record.columns()
        row["peak_N"] = None if first_failure_only(record.model) else record.peak_N
        row["static_load_N"] = compared
        row["difference_to_static"] = load / compared - 1.0 if compared and load else None
        row["error"] = record.error or record.refused
        errors = mesh_errors.get(record.folder, UNKNOWN)
        row |= {"mesh_error": errors.peak, "first_failure_mesh_error": errors.first}
        rows.append(row)
    return CASES.frame(rows)


def _compared(record: JointRecord, static: JointRecord | None) -> float | None:
    """The load (N) of the static model that a record's is compared with."""
    if record.model == REFERENCE_MODEL or static is None:
        return None
    return static.first_failure_load_N if first_failure_only(record.model) else static.load_N


def friction_share(record: JointRecord) -> float:
    """Share of V that reaches the lower body other than by its locks; nan in pure torsion."""
    by_locks = abs(math.fsum(w.shear_y_N for w in record.part.weights if w.block == "lower"))
    shear = record.part.shear_N
    return 1.0 - by_locks / shear if shear else float("nan")


def displacements_at(record: JointRecord, loads: Iterable[float]) -> list[float]:
    """Displacement (m) on which the load does work, at given loads (N); nan where unknown."""
    path = sorted((load, moved) for load, moved in record.path if moved is not None)
    if not path:
        return [float("nan") for _ in loads]
    return np.interp([*loads], *np.array(path).T).tolist()


def models_table(
    records: Sequence[JointRecord], all_records: Iterable[JointRecord] = ()
) -> pd.DataFrame:
    """One row for each result of the reference variant, with the models of a case together.

    The given loads are shares of the first failure load in the first of these models.
    """
    mesh_errors = errors_of([*all_records, *records])
    rows: list[dict[str, Any]] = []
    more: dict[str, float] = {}  # columns beside those of `MODELS`
    given: dict[str, float] = {}
    for record in records:
        if record.variant != REFERENCE or record.load_N is None or not record.part.weights:
            continue
        failure = record.first_failure_load_N
        load = given.setdefault(record.part.case, failure if failure is not None else record.load_N)
        moved = displacements_at(record, [share * load for share in SHARES])
        own = {
            f"displacement_at_{100 * share:g}_percent_m": value
            for share, value in zip(SHARES, moved, strict=True)
        } | {f"weight_lock{each.lock}": each.weight for each in record.part.weights}
        more |= own
        errors = mesh_errors.get(record.folder, UNKNOWN)
        found = {"mesh_error": errors.peak, "friction_share": friction_share(record)}
        rows.append({**record.columns(), **found, "given_load_N": load, **own})
    table = pd.DataFrame(rows, columns=[*MODELS.columns, "case", *more])
    for column in ("first_failure_load_N", "mesh_error", "peak_spread"):
        table[column] = table[column].astype(float)
    order = table.groupby("case", sort=False).ngroup()
    return table.iloc[np.argsort(order, kind="stable")]


def run(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Read all records and write the tables, in the order of the study's cases."""
    every = read_records(inputs["records"])
    found = {record.folder: record for record in every}
    records = [found[case] for case in arguments["cases"]]
    weights = weights_table(records)
    tables = {
        "weights": weights,
        "weight_sums": weight_sums(weights),
        "cases": cases_table(records, every),
        "models": models_table(records, every),
    }
    write_tables(tables, outputs)


def errors_of(records: Iterable[JointRecord]) -> dict[str, MeshErrors]:
    """Mesh errors of results by the folder of the case; results without an error are left out.

    A model with one mesh takes the errors of the same joint, nodes and load from a model that is
    solved in this process: from the static model where possible.
    """
    records = [record for record in records if record.load_N is not None]
    series: dict[tuple[str, str, str], list[JointRecord]] = {}
    for r in records:
        series.setdefault((r.model, r.variant, r.part.series), []).append(r)
    by_series = {key: _errors_of_one(rows) for key, rows in series.items()}
    lendable: dict[tuple[str, float], MeshErrors] = {}
    for lender in SOLVED:
        for (model, _, joint), errors in by_series.items():
            if model == lender:
                for mesh, each in errors.items():
                    lendable.setdefault((joint, mesh), each)
    by_case = {
        r.folder: by_series[r.model, r.variant, r.part.series].get(
            r.part.mesh_m, lendable.get((r.part.series, r.part.mesh_m))
        )
        for r in records
    }
    return {case: errors for case, errors in by_case.items() if errors is not None}


def _errors_of_one(records: Sequence[JointRecord]) -> dict[float, MeshErrors]:
    """Mesh errors of results of one joint and model, by mesh (m)."""
    layout = NodeLayout(records[0].part.nodes)
    loads = {r.part.cells: r.load_N for r in records if r.load_N is not None}
    moves = any(r.mode not in (None, Mode.BONDS) for r in records)
    both = [(r.load_N, r.first_failure_load_N) for r in records if r.load_N is not None]
    load = mesh_errors(loads, layout, kind_of(both, moves=moves))
    known = {r.part.cells: r.first_failure_load_N for r in records if r.first_failure_load_N}
    first = mesh_errors(known, layout, LoadKind.FIRST_FAILURE) if known else {}
    return {
        r.part.mesh_m: MeshErrors(first.get(r.part.cells), load.get(r.part.cells))
        for r in records
        if r.part.cells in load
    }


if __name__ == "__main__":
    step(run)
