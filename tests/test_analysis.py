"""From the cases' records to fits and tables, on results made up for the purpose."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from made_up_results import capacity_of, record_with, tables_of

from analysis.published import read_published
from analysis.summary.summary import summary
from analysis.tables.capacity import envelope_rows, sidmacib_rows
from analysis.tables.collect import (
    cases_table,
    displacements_at,
    friction_share,
    models_table,
    weight_sums,
    weights_table,
)
from analysis.tables.fit import best_pair, fit_table
from analysis.tables.misfit import misfit, winner
from analysis.tables.study_points import pure_shear_weights
from analysis.tables.validation import quantity_label
from sidmacib.contact_points.options import ContactOption
from sidmacib.contact_points.programme import Sidmacib, capacities
from sidmacib.contact_points.reductions import active
from workflow.configuration import read_study
from workflow.planning.cases import cases_of
from workflow.results.joint_part import JointPart, JointRecord
from workflow.results.record import record_without_result
from workflow.results.tables import (
    CAPACITY,
    CASES,
    WEIGHTS,
    TableError,
    read_table,
    write_table,
)
from workflow.schema import Study


@pytest.fixture
def study() -> Study:
    return read_study(
        {"samples": {"n3": {"locks": 3}}, "meshes": [0.02], "eccentricities": [0, 0.5, "torsion"]}
    )


@pytest.fixture
def results(study: Study) -> list[JointRecord]:
    """A joint of which one lock carries load, on contact points at 0.3 a, 96 % of T0."""
    joint = study.joint("n3")
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    model = Sidmacib(joint, ContactOption.pair(0.3), (0.96, 0.0, 0.0), friction=False)
    points = capacities(model, [case.subject.direction for case in cases])
    return [record_with(c, 0.5, point.load) for c, point in zip(cases, points, strict=True)]


# --- weights -------------------------------------------------------------------------------------
def test_sums_are_of_all_locks_rounded_down_and_of_the_lower_locks(results) -> None:
    (row,) = weight_sums(weights_table(results[:1])).itertuples()
    assert (row.weight_sum, row.weight_sum_floor) == (pytest.approx(1.5), 1)
    assert row.lower_weight_sum == pytest.approx(0.5)


def test_weights_for_reductions_are_those_in_pure_shear(study, results) -> None:
    weights = weights_table(results)
    weights.loc[weights["eccentricity_m"] > 0, "weight"] = 9.0
    found = pure_shear_weights(study, weights, "n3")
    assert found == {("yade", 0.02): pytest.approx([0.5] * 3)}


def test_friction_is_what_the_lower_locks_do_not_carry(results) -> None:
    assert friction_share(results[0]) == pytest.approx(1.0 - 120.0 / results[0].part.shear_N)
    assert math.isnan(friction_share(results[-1]))


def test_displacements_are_read_between_the_loads_on_the_path(results) -> None:
    record = replace(results[0], path=((0.0, 0.0), (100.0, 2e-6), (200.0, 6e-6)))
    assert displacements_at(record, [50.0, 150.0]) == pytest.approx([1e-6, 4e-6])
    rigid = replace(results[0], path=((100.0, None),))
    assert math.isnan(displacements_at(rigid, [50.0])[0])


def test_models_stand_beside_each_other_case_by_case(results) -> None:
    others = [replace(r, model="static") for r in results]
    table = models_table([*results, *others])
    assert table["model"].tolist() == ["yade", "static"] * 3
    assert table["case"].tolist() == [r.part.case for r in results for _ in range(2)]


# --- cases ---------------------------------------------------------------------------------------
def test_every_engines_case_is_held_against_the_static_model_on_the_same_nodes(results) -> None:
    witness = [replace(r, model="static", load_N=r.load_N * 1.02) for r in results[:1]]
    table = cases_table(results, witness)
    assert table["difference_to_static"].iloc[0] == pytest.approx(1 / 1.02 - 1)
    assert table["difference_to_static"].iloc[1:].isna().all()


def test_a_first_failure_is_held_against_the_static_models_first_failure(results) -> None:
    found = [replace(r, model="calculix", first_failure_load_N=r.load_N) for r in results[:1]]
    first = 0.98 * results[0].load_N
    witness = [replace(results[0], model="static", first_failure_load_N=first)]
    table = cases_table([*found, *results[:1]], witness)
    assert table["difference_to_static"].tolist() == pytest.approx([1 / 0.98 - 1, 0.0])
    assert table["static_load_N"].tolist() == pytest.approx([first, results[0].load_N])


def test_a_case_of_another_joint_is_no_witness(results) -> None:
    witness = [replace(r, model="static", physics="other") for r in results]
    assert cases_table(results, witness)["difference_to_static"].isna().all()


def test_a_case_without_a_result_leaves_a_hole_that_every_table_names(
    study, results, tmp_path: Path
) -> None:
    case = next(c for c in cases_of(study).values() if c.name == results[1].name)
    holed = [
        results[0],
        record_without_result(case, error="yade: out of time after 1 s"),
        results[2],
    ]
    cases = cases_table(holed, holed)
    write_table(CASES, cases, tmp_path / "cases.csv")
    assert read_table(CASES, tmp_path / "cases.csv")["error"].notna().tolist() == [0, 1, 0]
    capacity = capacity_of(study, holed)
    write_table(CAPACITY, capacity, tmp_path / "capacity.csv")
    (row,) = capacity[capacity["error"].notna()].itertuples()
    assert (row.case, row.error) == (holed[1].part.case, "yade: out of time after 1 s")
    assert math.isnan(row.load_N)
    fit = fit_table(capacity)
    assert set(fit["directions"]) == {2}
    text = summary("there", tables_of(study, holed), [0.02])
    assert text.startswith("WITHOUT A RESULT: 1 of 3 cases\n  n3-mesh0.02-e0.5a (yade): yade: out")


def test_models_that_disagree_are_named_in_the_summary(study, results) -> None:
    witness = [replace(r, model="static", load_N=r.load_N * 1.02) for r in results[:1]]
    cases = cases_table(results, witness)
    tables = tables_of(study, results, cases)
    text = summary("there", tables, [0.02])
    assert "1 cases, at most 1.96 %; 1 of them differ by more than 1 %" in text
    assert "n3-mesh0.02-e0a (yade): -1.96 %" in text


def test_limit_analysis_of_ductile_bonds_says_that_it_has_no_friction(study, results) -> None:
    cases = cases_table(results, [])
    far, near = (
        cases.iloc[[0]].assign(model="limit", variant="ductile", name=name, difference_to_static=d)
        for name, d in (("torsion", -0.4), ("shear", -0.001))
    )
    tables = tables_of(study, results, pd.concat([cases, far, near]))
    text = summary("there", tables, [0.02], ["ductile"])
    assert "no friction, differs from the static model by more than 1 % in 1 of 2 cases" in text
    assert "  torsion: -40.00 %" in text
    assert "Ductile bonds" not in summary("there", tables, [0.02])


# --- fit -----------------------------------------------------------------------------------------
def test_errors_are_unsafe_where_the_model_promises_more() -> None:
    found = misfit(np.array([110.0, 95.0]), np.array([100.0, 100.0]))
    assert found.largest_unsafe_error == pytest.approx(0.10)
    assert found.largest_safe_error == pytest.approx(0.05)
    assert found.misfit == pytest.approx(math.sqrt((0.1**2 + 0.05**2) / 2))


def test_the_best_pair_finds_distance_and_strength_of_a_made_up_curve(study, results) -> None:
    curve = pd.DataFrame(
        {
            "eccentricity_over_a": [r.part.eccentricity_over_a for r in results],
            "load_N": [r.load_N for r in results],
        }
    )
    best = best_pair(study.joint("n3"), 1000.0, False, curve)
    assert best["distance_over_a"] == pytest.approx(0.3, abs=1e-3)
    assert best["locks_that_count"] == pytest.approx(0.96, abs=2e-3)
    assert best["misfit"] < 1e-3


def test_every_combination_is_ranked_and_the_winner_is_the_closest(study, results) -> None:
    fit = fit_table(capacity_of(study, results))
    assert len(fit) == 4 * 2 * 5  # options, friction, reductions
    capacity = capacity_of(study, results)
    assert set(capacity["eccentricity_m"]) == {0.0, 0.5 * 0.06, math.inf}
    first = fit[fit["rank"] == 1].iloc[0]
    assert first["misfit"] == fit["misfit"].min()
    # 0.3 a lies between options 2 (a / 3) and 3 (0.289 a), one lock counts.
    best = winner(fit, "n3", 0.02, reduction="half", friction=False)
    assert best["option"] in ("option2", "option3")


def test_a_direction_that_the_detailed_model_lacks_is_an_error(study, results) -> None:
    capacity = capacity_of(study, results)
    with pytest.raises(ValueError, match=r"yade: .* loads of SiDMACIB, but .* to compare"):
        fit_table(capacity.drop(index=0))


def _with_weights(part: JointPart, weight: float) -> JointPart:
    return replace(part, weights=tuple(replace(each, weight=weight) for each in part.weights))


def test_two_references_are_each_fitted_with_their_own_weights(study, results) -> None:
    others = [replace(r, model="static", part=_with_weights(r.part, 0.25)) for r in results]
    alone = fit_table(capacity_of(study, results))
    both = fit_table(capacity_of(study, results + others))
    columns = ["option", "friction", "reduction", "misfit"]
    pd.testing.assert_frame_equal(
        both.loc[both["model"] == "yade", columns].reset_index(drop=True),
        alone[columns].reset_index(drop=True),
    )


def test_a_curve_that_is_the_model_itself_is_won_without_misfit(study) -> None:
    joint = study.joint("n3")
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    model = Sidmacib(joint, ContactOption.pair(0.25), active(joint, 1), friction=False)
    points = capacities(model, [case.subject.direction for case in cases])
    results = [record_with(c, 0.5, p.load) for c, p in zip(cases, points, strict=True)]
    best = winner(fit_table(capacity_of(study, results)), "n3", 0.02)
    assert (best["option"], best["friction"], best["misfit"]) == (
        "option4",
        False,
        pytest.approx(0),
    )


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


def test_a_mesh_that_no_decimal_says_exactly_joins_all_the_same() -> None:
    mesh = 0.05 / 3
    study = read_study(
        {"samples": {"n3": {"locks": 3}}, "meshes": [mesh], "eccentricities": [0, 1 / 3, "torsion"]}
    )
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    records = [record_with(case, 0.5, 100.0 + n) for n, case in enumerate(cases)]
    capacity = capacity_of(study, records)
    assert len(fit_table(capacity)) == 4 * 2 * 5
    assert pure_shear_weights(study, weights_table(records), "n3") == {
        ("yade", mesh): pytest.approx([0.5] * 3)
    }


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
def test_a_table_that_is_not_as_it_should_be_is_not_written(
    results, tmp_path: Path, change, message: str
) -> None:
    with pytest.raises(TableError, match=message):
        write_table(WEIGHTS, change(weights_table(results)), tmp_path / "weights.csv")
    assert not list(tmp_path.iterdir())


def test_numbers_have_as_many_digits_as_are_known(results, tmp_path: Path) -> None:
    table = weights_table(results).assign(weight=1 / 3)
    write_table(WEIGHTS, table, tmp_path / "weights.csv")
    assert set(read_table(WEIGHTS, tmp_path / "weights.csv")["weight"]) == {0.3333333333}


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
        ({"assembly": {"upper_body": "monolithic"}}, False),
        ({"assembly": {"hold_down": "plate"}}, True),
        ({"assembly": {"hold_down": {"force": 1000}}}, False),
        ({"samples": {"n": {"locks": 3, "first": "lower"}}}, False),
        ({"samples": {"n": {"locks": 3, "different": {2: {"density": 1}}}}}, False),
    ],
)
def test_only_the_papers_samples_and_loads_are_held_against_the_paper(
    change: dict[str, object], covered: bool
) -> None:
    config = {"samples": {"n": {"locks": 3}}, "meshes": [0.02], **change}
    assert read_published().covers(read_study(config), "n") is covered


def test_the_summary_has_the_findings_and_all_paths(study, results) -> None:
    text = summary("there", tables_of(study, results), [0.02])
    assert "Tables:  there/tables" in text
    assert "Assumed: a, b, h and H" in text
    assert "-4.30 %" in text  # 230.4 N against 240.76 N


def test_torsion_alone_has_an_infinite_eccentricity_in_the_tables(study, results) -> None:
    weights = weights_table(results)
    assert weights["eccentricity_m"].max() == math.inf
    rows = pd.DataFrame(sidmacib_rows(study, weights))
    torsion = rows[rows["eccentricity_m"] == math.inf]
    assert (torsion["shear_N"] == 0).all()


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("sidmacib_pure_shear_option4_frictionless_N", "SiDMACIB, Option 4, V (N)"),
        ("dem_pure_shear_N", "peak V of the pieces (N)"),
        ("weight_lock2_swapped", "weight of lock 2, first two swapped"),
        ("weight_sum_rounded_down", "sum of weights, rounded down"),
        ("something_else", "something_else"),
    ],
)
def test_quantities_have_names_that_people_use(quantity: str, words: str) -> None:
    assert quantity_label(quantity) == words
