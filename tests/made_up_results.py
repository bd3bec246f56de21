"""Results made up for tests of tables, figures and texts, and the tables of them."""

from collections.abc import Sequence
from dataclasses import replace

import pandas as pd

from analysis.published import read_published
from analysis.tables.capacity import capacity_table
from analysis.tables.collect import cases_table, weights_table
from analysis.tables.comparisons import best_table, fit_table, validation_table
from sidmacib.joint.pieces import LockWeight
from workflow.case import JointCase
from workflow.results import record_without_result
from workflow.results.joint_part import JointRecord
from workflow.schema import Study


def record_with(case: JointCase, weight: float, peak: float = 100.0) -> JointRecord:
    """A record with the same uniform stress along -y on all inner faces."""
    joint = case.subject.joint
    weights = tuple(
        LockWeight(
            lock,
            "upper" if joint.is_upper(lock) else "lower",
            *(weight, weight, weight),
            *(0.0, -weight * joint.T0),
        )
        for lock in range(1, joint.locks + 1)
    )
    record = record_without_result(case)
    return replace(
        record,
        load_N=peak,
        failed_load_N=1.001 * peak,
        unbalanced_share=0.0,
        part=replace(
            record.part,
            shear_N=peak * case.subject.direction.shear,
            torque_Nm=peak * case.subject.direction.torque * joint.a,
            weights=weights,
        ),
    )


def capacity_of(study: Study, records: Sequence[JointRecord]) -> pd.DataFrame:
    return capacity_table(study, cases_table(records, records), weights_table(records))


def tables_of(study: Study, records: Sequence[JointRecord]) -> dict[str, pd.DataFrame]:
    """The tables that a summary needs."""
    capacity = capacity_of(study, records)
    fit, weights = fit_table(capacity), weights_table(records)
    return {
        "validation": validation_table(study, capacity, weights, fit, read_published()),
        "fit": fit,
        "best_fit": best_table(study, capacity),
        "capacity": capacity,
        "cases": cases_table(records, records),
    }
