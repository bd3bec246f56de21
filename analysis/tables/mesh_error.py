"""Mesh errors of the results of a study, estimated from other meshes of the same joint."""

from collections.abc import Iterable
from dataclasses import dataclass

from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mesh_error import LoadKind, kind_of, mesh_errors
from workflow.models import SOLVED
from workflow.results.record import CaseRecord


@dataclass(frozen=True)
class MeshErrors:
    """Relative mesh errors of a result's load and of its first failure; None: not known."""

    load: float | None = None
    first_failure: float | None = None


def errors_of(records: Iterable[CaseRecord]) -> dict[tuple[str, str], MeshErrors]:
    """Mesh errors of results by model and name of the case; results without an error are left out.

    A model with one mesh takes the errors of the same joint, nodes and load from a model that is
    solved in this process: from the static model where possible.
    """
    records = [record for record in records if record.load_N is not None]
    series: dict[tuple[str, str, str], list[CaseRecord]] = {}
    for r in records:
        series.setdefault((r.model, r.variant, r.series), []).append(r)
    by_series = {key: _errors_of_one(rows) for key, rows in series.items()}
    lendable: dict[tuple[str, float], MeshErrors] = {}
    for lender in SOLVED:
        for (model, _, joint), errors in by_series.items():
            if model == lender:
                lendable |= {
                    (joint, mesh): e for mesh, e in errors.items() if (joint, mesh) not in lendable
                }
    by_case = {
        (r.model, r.name): by_series[r.model, r.variant, r.series].get(
            r.mesh_m, lendable.get((r.series, r.mesh_m))
        )
        for r in records
    }
    return {case: errors for case, errors in by_case.items() if errors is not None}


def _errors_of_one(records: Iterable[CaseRecord]) -> dict[float, MeshErrors]:
    """Mesh errors of results of one joint and model, by mesh (m).

    Where peaks spread too far the load is the first failure, and so is its error.
    """
    records = list(records)
    layout = NodeLayout(records[0].nodes)
    loads = {r.cells: r.load_N for r in records if r.load_N is not None}
    kind = kind_of((r.load_N, r.first_failure_load_N) for r in records if r.load_N is not None)
    load = mesh_errors(loads, layout, kind)
    known = {r.cells: r.first_failure_load_N for r in records if r.first_failure_load_N}
    first = mesh_errors(known, layout, LoadKind.FIRST_FAILURE) if known else {}
    return {
        r.mesh_m: MeshErrors((load if r.is_peak else first).get(r.cells), first.get(r.cells))
        for r in records
        if r.cells in load
    }
