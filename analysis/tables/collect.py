"""Collect the records of all cases in tables."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
import pandas as pd

from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mesh_error import LoadKind, kind_of, mesh_errors
from sidmacib.models import REFERENCE_MODEL, SOLVED, first_failure_only
from sidmacib.problem import UNKNOWN, MeshErrors
from workflow.case import REFERENCE
from workflow.results import read_records
from workflow.results.joint_part import JointRecord
from workflow.results.tables import CASES, MODELS, WEIGHT_SUMS, WEIGHTS, write_table
from workflow.step import Arguments, FileLists, Files, step

SHARES = (0.25, 0.5, 0.75)  # given loads over the leading model's first failure load
SHARED = (
    *("model", "variant", "sample", "case", "locks", "mesh_m", "eccentricity_m"),
    "eccentricity_over_a",
)


def weights_table(records: Iterable[JointRecord]) -> pd.DataFrame:
    """One row per lock of every case whose model gives stresses."""
    return WEIGHTS.frame(
        _shared(record) | asdict(weight) for record in records for weight in record.part.weights
    )


def weight_sums(weights: pd.DataFrame) -> pd.DataFrame:
    """One row per case: W_sum, W_sum rounded down, and the sum over the lower locks."""
    lower = weights["weight"].where(weights["block"] == "lower", 0.0)
    sums = weights.assign(lower=lower).groupby(list(SHARED), sort=False)[["weight", "lower"]].sum()
    sums = sums.rename(columns={"weight": "weight_sum", "lower": "lower_weight_sum"})
    sums.insert(1, "weight_sum_floor", np.floor(sums["weight_sum"]).astype(int))
    return sums.reset_index()


def cases_table(records: Sequence[JointRecord], all_records: Iterable[JointRecord]) -> pd.DataFrame:
    """One row per case; failed ones have the reason.

    ``all_records``: these and those on further meshes. Each record is compared with that of the
    static model for the same joint, nodes and load, see `_compared`; mesh errors come from all
    meshes.
    """
    all_records = list(all_records)
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
        errors = mesh_errors.get((record.model, record.name), UNKNOWN)
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
    places, moved = np.array(path).T
    return [float(np.interp(load, places, moved)) for load in loads]


def models_table(
    records: Sequence[JointRecord], all_records: Iterable[JointRecord] = ()
) -> pd.DataFrame:
    """One row for each result of the reference variant, with the models of a case together.

    The given loads are shares of the first failure load in the first of these models.
    """
    mesh_errors = errors_of([*all_records, *records])
    rows: list[dict[str, Any]] = []
    given: dict[str, float] = {}
    for record in records:
        if record.variant != REFERENCE or record.load_N is None or not record.part.weights:
            continue
        failure = record.first_failure_load_N
        load = given.setdefault(record.part.case, failure if failure is not None else record.load_N)
        moved = displacements_at(record, [share * load for share in SHARES])
        columns = _shared(record)
        columns.pop("variant")
        rows.append(
            columns
            | {
                "load_N": record.load_N,
                "mesh_error": mesh_errors.get((record.model, record.name), UNKNOWN).peak,
                "first_failure_load_N": failure,
                "peak_spread": record.peak_spread,
                "friction_share": friction_share(record),
                "given_load_N": load,
            }
            | {
                f"displacement_at_{100 * share:g}_percent_m": value
                for share, value in zip(SHARES, moved, strict=True)
            }
            | {f"weight_lock{each.lock}": each.weight for each in record.part.weights}
        )
    if not rows:
        return pd.DataFrame(columns=[*MODELS.columns, "case"])
    table = pd.DataFrame(rows)
    for column in ("first_failure_load_N", "mesh_error", "peak_spread"):
        table[column] = table[column].astype(float)
    order = table.groupby("case", sort=False).ngroup()
    return table.iloc[np.argsort(order, kind="stable")]


def _shared(record: JointRecord) -> dict[str, Any]:
    columns = record.columns()
    return {name: columns[name] for name in SHARED}


def ordered(
    records: Iterable[JointRecord], names: Sequence[Sequence[str]]
) -> Iterator[JointRecord]:
    """The records of the study's cases, ``names`` being (model, name), in its order."""
    by_case = {(record.model, record.name): record for record in records}
    return (by_case[model, name] for model, name in names)


def run(arguments: Arguments, inputs: FileLists, outputs: Files) -> None:
    """Read all records and write the tables."""
    every = read_records(inputs["records"])
    records = list(ordered(every, arguments["cases"]))
    weights = weights_table(records)
    write_table(WEIGHTS, weights, outputs["weights"])
    write_table(WEIGHT_SUMS, weight_sums(weights), outputs["weight_sums"])
    write_table(CASES, cases_table(records, every), outputs["cases"])
    write_table(MODELS, models_table(records, every), outputs["models"])


def errors_of(records: Iterable[JointRecord]) -> dict[tuple[str, str], MeshErrors]:
    """Mesh errors of results by model and name of the case; results without an error are left out.

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
                lendable |= {
                    (joint, mesh): e for mesh, e in errors.items() if (joint, mesh) not in lendable
                }
    by_case = {
        (r.model, r.name): by_series[r.model, r.variant, r.part.series].get(
            r.part.mesh_m, lendable.get((r.part.series, r.part.mesh_m))
        )
        for r in records
    }
    return {case: errors for case, errors in by_case.items() if errors is not None}


def _errors_of_one(records: Iterable[JointRecord]) -> dict[float, MeshErrors]:
    """Mesh errors of results of one joint and model, by mesh (m)."""
    records = list(records)
    layout = NodeLayout(records[0].part.nodes)
    loads = {r.part.cells: r.load_N for r in records if r.load_N is not None}
    kind = kind_of((r.load_N, r.first_failure_load_N) for r in records if r.load_N is not None)
    load = mesh_errors(loads, layout, kind)
    known = {r.part.cells: r.first_failure_load_N for r in records if r.first_failure_load_N}
    first = mesh_errors(known, layout, LoadKind.FIRST_FAILURE) if known else {}
    return {
        r.part.mesh_m: MeshErrors(first.get(r.part.cells), load.get(r.part.cells))
        for r in records
        if r.part.cells in load
    }


if __name__ == "__main__":
    step(run)
