"""How far capacities are from those at an ever finer mesh, told from two meshes."""

from collections.abc import Iterable, Mapping

from workflow.case import APART
from workflow.models import Obtained, obtained_by
from workflow.results.record import CaseRecord

DIGITS = 9  # after the decimal point, of a relative error; less is rounding


def mesh_errors(loads: Mapping[float, float]) -> dict[float, float]:
    """Relative error of the loads (N) at some meshes (m), by mesh; empty if they cannot tell.

    Errors are taken as proportional to the mesh. That of the finest mesh then follows from the
    next one that is `APART` from it; those of the others are their differences to the finest and
    its error.
    """
    finest = min(loads)
    coarser = [mesh for mesh in loads if mesh >= APART * finest]
    if not coarser:
        return {}
    change = {mesh: abs(load / loads[finest] - 1.0) for mesh, load in loads.items()}
    error = change[min(coarser)] / (min(coarser) / finest - 1.0)
    return {mesh: round(own + error, DIGITS) for mesh, own in change.items()}


def errors_of(records: Iterable[CaseRecord]) -> dict[tuple[str, str], float]:
    """Mesh errors of results by model and name of the case.

    A model that has one mesh only takes the error of a model that is solved in this process, the
    static one if there is one, of the same joint on the same nodes under the same load.
    """
    records = [record for record in records if record.load_N is not None]
    series: dict[tuple[str, str, str], dict[float, float]] = {}
    for r in records:
        assert r.load_N is not None
        series.setdefault((r.model, r.variant, r.series), {})[r.mesh_m] = r.load_N
    own = {key: mesh_errors(loads) for key, loads in series.items()}
    lent: dict[tuple[str, float], float] = {}
    for lender in obtained_by(Obtained.SOLVED):
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
    return {case: error for case, error in found.items() if error is not None}
