"""Mesh errors of the results of a study, each told from those of the same joint on other meshes."""

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
    """Mesh errors of results by model and name of the case; results without any are left out.

    A model that has one mesh only takes the errors of a model that is solved in this process, the
    static one if there is one, of the same joint on the same nodes under the same load.
    """
    records = [record for record in records if record.load_N is not None]
    series: dict[tuple[str, str, str], list[CaseRecord]] = {}
    for r in records:
        series.setdefault((r.model, r.variant, r.series), []).append(r)
    own = {key: _errors_of_one(rows) for key, rows in series.items()}
    lent: dict[tuple[str, float], MeshErrors] = {}
    for lender in SOLVED:
        for (model, _, joint), errors in own.items():
            if model == lender:
                lent |= {
                    (joint, mesh): e for mesh, e in errors.items() if (joint, mesh) not in lent
                }
    found = {
        (r.model, r.name): own[r.model, r.variant, r.series].get(
            r.mesh_m, lent.get((r.series, r.mesh_m))
        )
        for r in records
    }
    return {case: errors for case, errors in found.items() if errors is not None}


def _errors_of_one(records: Iterable[CaseRecord]) -> dict[float, MeshErrors]:
    """Mesh errors of results of one joint and model, by mesh (m).

    Where peaks spread too far the load is the first failure, and so is its error.
    """
    records = list(records)
    layout = NodeLayout(records[0].nodes)
    told = {r.cells: r.load_N for r in records if r.load_N is not None}
    kind = kind_of((r.load_N, r.first_failure_load_N) for r in records if r.load_N is not None)
    load = mesh_errors(told, layout, kind)
    known = {r.cells: r.first_failure_load_N for r in records if r.first_failure_load_N}
    first = mesh_errors(known, layout, LoadKind.FIRST_FAILURE) if known else {}
    return {
        r.mesh_m: MeshErrors((load if r.is_peak else first).get(r.cells), first.get(r.cells))
        for r in records
        if r.cells in load
    }
