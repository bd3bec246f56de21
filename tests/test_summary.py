"""What the summary of a study says, and in which order."""

from typing import Any

import numpy as np
import pandas as pd
import pytest
from made_up_results import record_with, tables_of
from small import TWO_MESHES

from analysis.summary import rule_errors
from analysis.summary.summary import leading_models, summary
from sidmacib import ContactOption, Direction, Sidmacib, capacities, safe
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.schema import Study

COUNTED = {"weak": 0.75, "strong": 1.25}  # locks that count in results made up for each sample
COUNT = "Is it safe to count (n - 1) / 2 of the n locks of a joint?"


def study_of(**change: Any) -> Study:
    samples = {"weak": {"locks": 3}, "strong": {"locks": 3}}
    models = {"models": ["static", "law", "safe"]}
    return read_study({**TWO_MESHES, "samples": samples, **models, **change})


def tables_for(study: Study) -> dict[str, pd.DataFrame]:
    """Results made up: contact points of Option 4, and locks that count by `COUNTED`."""
    records = []
    for case in cases_of(study).values():
        strength = (COUNTED.get(case.subject.sample, 1.0), *(0.0,) * (case.subject.joint.locks - 1))
        model = Sidmacib(case.subject.joint, ContactOption.pair(0.25), strength, friction=False)
        (point,) = capacities(model, [case.subject.direction])
        records.append(record_with(case, 0.5, point.load))
    return tables_of(study, records)


@pytest.fixture(scope="module")
def tables() -> dict[str, pd.DataFrame]:
    return tables_for(study_of())


@pytest.fixture(scope="module")
def lines(tables: dict[str, pd.DataFrame]) -> list[str]:
    return summary("there", tables, [0.02, 0.01]).splitlines()


def test_whether_half_of_the_locks_may_be_counted_is_answered_first(lines: list[str]) -> None:
    assert lines[0].startswith(f"{COUNT} No: unsafe by 33.3 % (weak, ")
    assert lines[1] == "  strong safe (Option 3); weak unsafe by 33.3 % (Option 4)"


def test_half_of_the_locks_may_be_counted_where_an_option_is_safe() -> None:
    study = study_of(samples={"strong": {"locks": 3}})
    lines = summary("there", tables_for(study), [0.02, 0.01]).splitlines()
    assert lines[0] == f"{COUNT} Yes, for these joints"
    assert lines[1] == "  strong safe (Option 3)"


def test_the_first_ten_lines_tell_what_to_design_for(lines: list[str]) -> None:
    joint = study_of().joint("weak")
    shear, torque = safe(joint, Direction(0)).shear, safe(joint, Direction(np.inf)).torque
    answer = f"weak V {shear:.4g}, M {torque:.4g}; strong V {shear:.4g}, M {torque:.4g}"
    assert f"  {answer}" in lines[:10]
    assert "" in lines[:10]  # the rest is below


def test_loads_are_printed_as_shear_and_torque_for_each_ratio_of_eccentricity(
    lines: list[str], tables: dict[str, pd.DataFrame]
) -> None:
    start = lines.index("Static model, mesh 0.01 m: V (N) and M (N m)")
    head, *rows = (line.split() for line in lines[start + 1 : start + 5])
    assert head == ["e/a", "weak", "strong"]
    assert [row[0] for row in rows] == ["0", "0.5", "torsion"]
    expected = tables["capacity"].query("model == 'static' and mesh_m == 0.01 and sample == 'weak'")
    for row, (shear, torque) in zip(
        rows, expected[["shear_N", "torque_Nm"]].itertuples(index=False), strict=True
    ):
        assert row[1:3] == [f"{shear:.5g}", f"{torque:.5g}"]


def test_a_rule_that_refuses_says_why_in_the_summary() -> None:
    samples = {"long": {"locks": 33}, "weak": {"locks": 3}}
    study = study_of(samples=samples, eccentricities=[0, "torsion"])
    text = summary("there", tables_for(study), [0.02, 0.01])
    assert "long no answer, see below; weak V " in text
    assert text.count("  - long: locks: 33 is not allowed; it must be from 2 to 31") == 2


def test_errors_of_rules_are_those_of_the_fit(tables: dict[str, pd.DataFrame]) -> None:
    fit, leading = tables["fit"], leading_models(tables["fit"])
    errors = [error for error in rule_errors(tables, leading, 0.01) if error.option is not None]
    assert {error.rule for error in errors} == set(fit["reduction"])
    for error in errors:
        rows = fit[fit["reduction"].eq(error.rule) & fit["sample"].eq(error.sample)]
        rows = rows[rows["option"].eq(error.option) & rows["friction"].eq(error.friction)]
        (unsafe,) = rows.loc[np.isclose(rows["mesh_m"], 0.01), "largest_unsafe_error"]
        assert max(error.error, 0.0) == pytest.approx(unsafe, abs=1e-9)
