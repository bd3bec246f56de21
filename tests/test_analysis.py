"""From the cases' records to fits, tables and a summary, on results made up for the purpose."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_results import capacity_of, record_with, tables_of
from small import ONE, TWO_MESHES, merged

from analysis.published import read_published
from analysis.summary import answers, rule_errors
from analysis.summary.summary import leading_models, summary
from analysis.tables import load_errors, winner
from analysis.tables.capacity import demand_rows, envelope_rows
from analysis.tables.collect import (
    cases_table,
    displacements_at,
    friction_share,
    weight_sums,
    weights_table,
)
from analysis.tables.comparisons import best_pair, fit_table
from sidmacib import Direction, safe
from sidmacib.contact_points import ContactOption, active
from sidmacib.contact_points.programme import Sidmacib, capacities
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results import record_without_result
from workflow.results.joint_part import JointRecord
from workflow.results.tables import CAPACITY, CASES, WEIGHTS, TableError, read_table, write_table
from workflow.schema import DemandSection, Study


@pytest.fixture
def study() -> Study:
    return read_study(merged(meshes=[0.02], eccentricities=[0, 0.5, "torsion"]))


@pytest.fixture
def results(study: Study) -> list[JointRecord]:
    """A joint of which one lock carries load, on contact points at 0.3 a, 96 % of T0."""
    return results_of(study, 0.3, (0.96, 0.0, 0.0))


def results_of(study: Study, distance: float, strength: tuple[float, ...]) -> list[JointRecord]:
    """Results of YADE that are those of SiDMACIB, with strengths of locks over T0."""
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    pair = ContactOption.pair(distance)
    model = Sidmacib(study.joint("n3"), pair, strength, friction=False)
    points = capacities(model, [case.subject.direction for case in cases])
    return [record_with(c, 0.5, point.load) for c, point in zip(cases, points, strict=True)]


# --- weights -------------------------------------------------------------------------------------
def test_sums_are_of_all_and_of_lower_locks_and_friction_is_what_these_do_not_carry(
    results,
) -> None:
    (row,) = weight_sums(weights_table(results[:1])).itertuples()
    assert (row.weight_sum, row.weight_sum_floor) == (pytest.approx(1.5), 1)
    assert row.lower_weight_sum == pytest.approx(0.5)
    assert friction_share(results[0]) == pytest.approx(1.0 - 120.0 / results[0].part.shear_N)
    assert math.isnan(friction_share(results[-1]))


def test_displacements_are_read_between_the_loads_on_the_path(results) -> None:
    record = replace(results[0], path=((0.0, 0.0), (100.0, 2e-6), (200.0, 6e-6)))
    assert displacements_at(record, [50.0, 150.0]) == pytest.approx([1e-6, 4e-6])
    rigid = replace(results[0], path=((100.0, None),))
    assert math.isnan(displacements_at(rigid, [50.0])[0])


# --- cases ---------------------------------------------------------------------------------------
def test_every_engines_case_is_held_against_the_static_model_on_the_same_nodes(results) -> None:
    witness = [replace(r, model="static", load_N=r.load_N * 1.02) for r in results[:1]]
    table = cases_table(results, witness)
    assert table["difference_to_static"].iloc[0] == pytest.approx(1 / 1.02 - 1)
    assert table["difference_to_static"].iloc[1:].isna().all()
    others = [replace(each, physics="other") for each in witness]  # cases of another joint
    assert cases_table(results, others)["difference_to_static"].isna().all()


def test_a_first_failure_is_held_against_the_static_models_first_failure(results) -> None:
    found = [replace(r, model="calculix", first_failure_load_N=r.load_N) for r in results[:1]]
    first = 0.98 * results[0].load_N
    witness = [replace(results[0], model="static", first_failure_load_N=first)]
    table = cases_table([*found, *results[:1]], witness)
    assert table["difference_to_static"].tolist() == pytest.approx([1 / 0.98 - 1, 0.0])
    assert table["static_load_N"].tolist() == pytest.approx([first, results[0].load_N])


@pytest.mark.long
def test_a_case_without_a_result_is_a_hole_that_tables_name(study, results, tmp_path: Path) -> None:
    case = next(c for c in cases_of(study).values() if c.name == results[1].name)
    reason = "yade: out of time after 1 s"
    holed = [results[0], record_without_result(case, error=reason), results[2]]
    cases = cases_table(holed, holed)
    write_table(CASES, cases, tmp_path / "cases.csv")
    assert read_table(CASES, tmp_path / "cases.csv")["error"].notna().tolist() == [0, 1, 0]
    capacity = capacity_of(study, holed)
    write_table(CAPACITY, capacity, tmp_path / "capacity.csv")
    (row,) = capacity[capacity["error"].notna()].itertuples()
    assert (row.case, row.error) == (holed[1].part.case, reason)
    assert math.isnan(row.load_N)
    fit = fit_table(capacity)
    assert set(fit["directions"]) == {2}
    text = summary("there", tables_of(study, holed), [0.02])
    assert text.startswith("WITHOUT A RESULT: 1 of 3 cases\n  n3-mesh0.02-e0.5a (yade): yade: out")


# --- fit -----------------------------------------------------------------------------------------
def test_the_best_pair_finds_distance_and_strength_of_a_made_up_curve(study, results) -> None:
    points = [(r.part.eccentricity_over_a, r.load_N) for r in results]
    curve = pd.DataFrame(points, columns=["eccentricity_over_a", "load_N"])
    best = best_pair(study.joint("n3"), 1000.0, False, curve)
    assert best["distance_over_a"] == pytest.approx(0.3, abs=1e-3)
    assert best["locks_that_count"] == pytest.approx(0.96, abs=2e-3)
    assert best["misfit"] < 1e-3


@pytest.mark.long
def test_every_combination_is_ranked_and_the_winner_is_the_closest(study, results) -> None:
    capacity = capacity_of(study, results)
    fit = fit_table(capacity)
    assert len(fit) == 4 * 2 * 5  # options, friction, reductions
    assert set(capacity["eccentricity_m"]) == {0.0, 0.5 * 0.06, math.inf}
    first = fit[fit["rank"] == 1].iloc[0]
    assert first["misfit"] == fit["misfit"].min()
    # 0.3 a lies between options 2 (a / 3) and 3 (0.289 a), one lock counts.
    best = winner(fit, "n3", 0.02, reduction="half", friction=False)
    assert best["option"] in ("option2", "option3")
    same = results_of(study, 0.25, active(study.joint("n3"), 1))  # those of a combination itself
    best = winner(fit_table(capacity_of(study, same)), "n3", 0.02)
    found = (best["option"], best["friction"], best["misfit"])
    assert found == ("option4", False, pytest.approx(0))


# --- tables --------------------------------------------------------------------------------------
def test_validation_holds_published_and_computed_side_by_side(study, results) -> None:
    table = tables_of(study, results)["validation"]
    assert table.columns[:6].tolist() == [
        *("quantity", "locks", "mesh_m", "published", "computed", "relative_difference")
    ]
    rows = table.set_index("quantity")
    assert rows.loc["dem_pure_shear_N", "published"] == 240.76
    assert rows.loc["dem_pure_shear_N", "relative_difference"] == pytest.approx(230.4 / 240.76 - 1)
    assert rows.loc["sidmacib_pure_shear_option1_frictionless_N", "computed"] == pytest.approx(720)
    assert rows.loc["weight_lock1", "published"] == 0.99
    assert rows.loc["weight_lock1_swapped", "published"] == 0.77
    assert math.isnan(rows.loc["weight_lock3", "relative_difference"])
    assert rows.loc["weight_lock3", "absolute_difference"] == pytest.approx(0.5)


def test_envelopes_hold_every_option_with_and_without_friction(study) -> None:
    rows = pd.DataFrame(envelope_rows(study))
    assert set(rows["option"]) == set(study.sidmacib.options)
    frictionless = rows[~rows["friction"] & (rows["option"] == "option4")]
    assert frictionless["torque_Nm"].max() == pytest.approx(0.25 * 0.06 * 720)


def test_a_table_reads_as_it_was_written(results, tmp_path: Path) -> None:
    path = tmp_path / "weights.csv"
    weights = weights_table(results)
    write_table(WEIGHTS, weights, path)
    pd.testing.assert_frame_equal(read_table(WEIGHTS, path), weights, rtol=1e-9)
    printed = pd.read_csv(path)
    assert printed.columns.tolist() == list(WEIGHTS.columns)
    assert printed["eccentricity_m"].max() == math.inf


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.drop(columns="weight"), "weights: no column weight"),
        (lambda t: t.assign(mass=1.0), "weights: unknown column mass"),
        (lambda t: pd.concat([t, t[:1]]), "weights: more than one row for"),
        (lambda t: t.assign(weight=math.inf), "weights: weight is infinite"),
    ],
)
def test_a_faulty_table_is_not_written(results, tmp_path: Path, change, message: str) -> None:
    with pytest.raises(TableError, match=message):
        write_table(WEIGHTS, change(weights_table(results)), tmp_path / "weights.csv")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("change", "covered"),
    [
        ({}, True),
        ({"samples": {"n": {"locks": 5}}}, True),
        ({"geometry": {"a": 0.1, "b": 0.03}}, True),  # the same a * b
        ({"geometry": {"a": 0.1}}, False),
        ({"samples": {"n": {"locks": 7}}}, False),
        ({"eccentricities": [0.5]}, False),
        ({"assembly": {"push": "-y"}}, False),
        ({"assembly": {"hold_down": {"force": 1000}}}, False),
        ({"samples": {"n": {"locks": 3, "different": {2: {"density": 1}}}}}, False),
    ],
)
def test_only_what_the_paper_has_is_held_to_it(change: dict[str, object], covered: bool) -> None:
    config = {**ONE, "samples": {"n": {"locks": 3}}, "meshes": [0.02], **change}
    assert read_published().covers(read_study(config), "n") is covered


# --- errors of a model's loads -------------------------------------------------------------------
REFERENCE = np.array([100.0, 200.0, 400.0])


@pytest.mark.parametrize(
    ("shares", "unsafe", "safe"),
    [([0.9, 0.7, 1.0], 0.0, 0.3), ([1.1, 1.4, 1.0], 0.4, 0.0), ([1.1, 0.6, 1.0], 0.1, 0.4)],
)
def test_loads_above_the_reference_are_unsafe_and_below_it_safe(
    shares: list[float], unsafe: float, safe: float
) -> None:
    found = load_errors(REFERENCE * shares, REFERENCE)
    assert found["largest_unsafe_error"] == pytest.approx(unsafe)
    assert found["largest_safe_error"] == pytest.approx(safe)


@given(st.floats(-0.9, 3.0))
def test_the_same_relative_error_everywhere_is_the_misfit(error: float) -> None:
    found = load_errors(REFERENCE * (1 + error), REFERENCE)
    assert found["misfit"] == pytest.approx(abs(error), abs=1e-12)


# --- the summary ---------------------------------------------------------------------------------
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


def test_each_answer_of_an_incomplete_study_says_so(tables: dict[str, pd.DataFrame]) -> None:
    cases = tables["cases"].copy()
    cases["error"] = cases["error"].astype(object)
    cases.loc[cases.index[0], "error"] = "timed out"
    found = answers({**tables, "cases": cases}, leading_models(tables["fit"]), 0.01)
    words = f"(incomplete: 1 of {len(cases)} cases have no result)"
    assert found and all(each.question.endswith(words) for each in found)


def test_of_joints_of_ones_own_what_they_carry_is_answered_first() -> None:
    study = study_of(samples={"mine": {"locks": 4, "a": 0.08}})
    first, *others = summary("there", tables_for(study), [0.02, 0.01]).splitlines()
    shear = safe(study.joint("mine"), Direction(0)).shear
    known = "What does each joint carry? By the safe rule, V (N) or M (N m): mine V "
    assert first.startswith(f"{known}{shear:.4g}, M ")
    assert not any(line.startswith("What does") for line in others)


@pytest.mark.long
def test_a_study_says_first_whether_its_joints_carry_the_load_it_asks_for() -> None:
    """With the numbers of `multilock capacity` for the same joint and load."""
    demand = {"shear": 200.0, "eccentricity": 0.2}
    samples = {"mine": {"locks": 4, "a": 0.08}, "small": {"locks": 3}}
    study = study_of(samples=samples, demand=demand)
    rows = pd.DataFrame(demand_rows(study, DemandSection(**demand))).set_index("sample")
    carried = {name: safe(study.joint(name), Direction(0.2)).shear / 200.0 for name in samples}
    assert rows["factor"].to_dict() == pytest.approx(carried)
    assert rows["required_torque_Nm"].to_dict() == {"mine": pytest.approx(3.2), "small": 2.4}
    tables = {**tables_for(study), "demands": rows.reset_index()}
    first, second, *_ = summary("there", tables, [0.02, 0.01]).splitlines()
    assert first == "Does each joint carry the load? No: small does not"
    words = f"with a factor of {carried['mine']:.3g} by the safe rule"
    assert f"mine Yes: it carries V = 200 N, M = 3.2 N m {words}" in second


@pytest.mark.parametrize(
    ("demand", "why"),
    [({}, "must be given"), ({"torque": 2.0, "eccentricity": 0.1}, "beside shear alone")],
)
def test_a_load_that_contradicts_itself_is_refused(demand: dict[str, float], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        study_of(demand=demand)


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


@pytest.mark.long
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
