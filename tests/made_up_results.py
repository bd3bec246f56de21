"""Results made up for tests of tables, figures and texts, and the tables of them."""

from collections.abc import Sequence
from dataclasses import replace

import pandas as pd

from analysis.published import read_published
from analysis.tables.capacity import capacity_table
from analysis.tables.collect import cases_table, weights_table
from analysis.tables.fit import best_table, fit_table
from analysis.tables.validation import validation_table
from sidmacib.joint.weights import LockWeight
from workflow.joints.case import Case
from workflow.results.record import CaseRecord, failed_record
from workflow.schema import Study


def record_with(case: Case, weight: float, peak: float = 100.0) -> CaseRecord:
    """A record with the same uniform stress along -y on all inner faces."""
    joint = case.joint
    weights = tuple(
        LockWeight(
            lock,
            "upper" if joint.is_upper(lock) else "lower",
            *(weight, weight, weight),
            *(0.0, -weight * joint.T0),
        )
        for lock in range(1, joint.locks + 1)
    )
    return replace(
        failed_record(case, "made up"),
        error=None,
        load_N=peak,
        shear_N=peak * case.direction.shear,
        torque_Nm=peak * case.direction.torque * joint.a,
        failed_load_N=1.001 * peak,
        unbalanced_share=0.0,
        weights=weights,
    )


def capacity_of(study: Study, records: Sequence[CaseRecord]) -> pd.DataFrame:
    return capacity_table(study, cases_table(records, records), weights_table(records))


def tables_of(
    study: Study, records: Sequence[CaseRecord], cases: pd.DataFrame | None = None
) -> dict[str, pd.DataFrame]:
    """The tables that a summary needs; ``cases``: in place of those of the records."""
    capacity = capacity_of(study, records)
    fit, weights = fit_table(capacity), weights_table(records)
    return {
        "validation": validation_table(study, capacity, weights, fit, read_published()),
        "fit": fit,
        "best_fit": best_table(study, capacity),
        "capacity": capacity,
        "cases": cases_table(records, records) if cases is None else cases,
    }
