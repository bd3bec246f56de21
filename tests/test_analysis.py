"""From stresses to weights, fits and tables, on results made up for the purpose."""

import math

import numpy as np
from dataclasses import replace

import pandas as pd
import pytest

from analysis.balance import unbalanced_share
from analysis.capacity import pure_shear_weights, sidmacib_rows
from analysis.fit import best_pair, best_table, fit_table, misfit, winner
from analysis.reading import CaseResult, read_published
from analysis.summary import summary
from analysis.validation import validation_table
from analysis.weights import case_columns, lock_weights, tabulate, weight_sums
from sidmacib.contact_points import ContactOption
from sidmacib.joint import Direction
from sidmacib.programme import Sidmacib, capacities
from sidmacib.revision import active
from workflow.cases import Case, cases_of
from workflow.configuration import read_study
from workflow.schema import Study


def result_with(case: Case, shear_x: float, shear_y: float, peak: float = 100.0) -> CaseResult:
    """A result with the same shear stress (Pa) on all nodes."""
    model = assemble(case.joint, case.mesh)
    faces = [model.faces[face] for face in model.nodes.face]
    nodes = pd.DataFrame(
        {
            "face": [face.name for face in faces],
            "kind": [str(face.kind) for face in faces],
            "lock": [face.lock for face in faces],
            **dict(zip(("x_m", "y_m", "z_m"), model.nodes.position.T, strict=True)),
            "area_m2": model.nodes.area,
            "normal_Pa": 0.0,
            "shear_x_Pa": shear_x,
            "shear_y_Pa": shear_y,
            "shear_z_Pa": 0.0,
            "bonded": 1,
        }
    )
    return CaseResult(case, peak, 1.001 * peak, None, nodes, pd.DataFrame())


@pytest.fixture
def study() -> Study:
    return read_study(
        {"samples": {"n3": {"locks": 3}}, "meshes": [0.02], "eccentricities": [0, 0.5, "torsion"]}
    )


@pytest.fixture
def results(study: Study) -> list[CaseResult]:
    """A joint of which one lock carries load, on contact points at 0.3 a, 96 % of T0."""
    joint = study.joint("n3")
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    model = Sidmacib(joint, ContactOption.pair(0.3), (0.96, 0.0, 0.0), friction=False)
    points = capacities(model, [case.direction for case in cases])
    return [
        result_with(case, 0.0, -0.5 * joint.inner.cohesion, point.load)
        for case, point in zip(cases, points, strict=True)
    ]


def capacity_of(study: Study, results: list[CaseResult], weights: pd.DataFrame) -> pd.DataFrame:
    rows = [
        case_columns(r)
        | {
            "shear_N": r.shear,
            "torque_Nm": r.torque,
            "load_N": r.peak_load,
            "failed_load_N": r.failed_load,
            "unbalanced_share": 0.0,
        }
        for r in results
    ]
    return pd.DataFrame([*rows, *sidmacib_rows(study, weights)])


# --- weights -------------------------------------------------------------------------------------
def test_a_uniform_stress_gives_equal_weights_of_all_three_kinds(results) -> None:
    weights = lock_weights(results[0])
    for column in ("weight", "mean_shear_ratio", "max_shear_ratio"):
        assert weights[column].tolist() == pytest.approx([0.5] * 3)
    assert weights["block"].tolist() == ["upper", "lower", "upper"]
    assert weights["shear_y_N"].tolist() == pytest.approx([-120.0] * 3)


def test_a_pure_torque_has_no_resultant_but_a_mean_and_a_largest_value(results) -> None:
    result = results[0]
    nodes = result.nodes.copy()
    for lock in (1, 2, 3):
        own = nodes["lock"] == lock
        y = nodes.loc[own, "y_m"] - (lock - 0.5) * 0.05
        nodes.loc[own, "shear_x_Pa"] = -1e6 * y
        nodes.loc[own, "shear_y_Pa"] = 1e6 * nodes.loc[own, "x_m"]
    weights = lock_weights(CaseResult(result.case, 1.0, 1.1, None, nodes, result.history))
    assert weights["weight"].max() < 1e-12
    assert (weights["mean_shear_ratio"] > 0.1).all()
    assert (weights["max_shear_ratio"] > weights["mean_shear_ratio"]).all()


def test_sums_are_of_all_locks_rounded_down_and_of_the_lower_locks(results) -> None:
    (row,) = weight_sums(lock_weights(results[0])).itertuples()
    assert (row.weight_sum, row.weight_sum_floor) == (pytest.approx(1.5), 1)
    assert row.lower_weight_sum == pytest.approx(0.5)


def test_weights_for_reductions_are_those_in_pure_shear(results) -> None:
    weights = tabulate(results)
    weights.loc[weights["eccentricity_m"] > 0, "weight"] = 9.0
    assert pure_shear_weights(weights, "n3") == {("yade", 0.02): pytest.approx([0.5] * 3)}


def test_stresses_that_do_not_balance_the_load_are_noticed(results) -> None:
    assert unbalanced_share(results[0]) > 0.1


# --- fit -----------------------------------------------------------------------------------------
def test_errors_are_unsafe_where_the_model_promises_more() -> None:
    found = misfit(np.array([110.0, 95.0]), np.array([100.0, 100.0]))
    assert found.largest_unsafe_error == pytest.approx(0.10)
    assert found.largest_safe_error == pytest.approx(0.05)
    assert found.misfit == pytest.approx(math.sqrt((0.1**2 + 0.05**2) / 2))


def test_equal_curves_have_no_error() -> None:
    found = misfit(np.array([1.0, 2.0]), np.array([1.0, 2.0]))
    assert (found.misfit, found.largest_unsafe_error, found.largest_safe_error) == (0, 0, 0)


def test_the_best_pair_finds_distance_and_strength_of_a_made_up_curve(study, results) -> None:
    curve = pd.DataFrame(
        {
            "eccentricity_m": [r.case.loading.eccentricity for r in results],
            "load_N": [r.peak_load for r in results],
        }
    )
    best = best_pair(study.joint("n3"), 1000.0, False, curve)
    assert best["distance_over_a"] == pytest.approx(0.3, abs=1e-3)
    assert best["locks_that_count"] == pytest.approx(0.96, abs=2e-3)
    assert best["misfit"] < 1e-3


def test_every_combination_is_ranked_and_the_winner_is_the_closest(study, results) -> None:
    fit = fit_table(capacity_of(study, results, tabulate(results)))
    assert len(fit) == 4 * 2 * 5  # options, friction, reductions
    capacity = capacity_of(study, results, tabulate(results))
    assert set(capacity["eccentricity_m"]) == {0.0, 0.5 * 0.06, math.inf}
    first = fit[fit["rank"] == 1].iloc[0]
    assert first["misfit"] == fit["misfit"].min()
    # 0.3 a lies between options 2 (a / 3) and 3 (0.289 a), one lock counts.
    best = winner(fit, "n3", 0.02, reduction="half", friction=False)
    assert best["option"] in ("option2", "option3")


def test_a_direction_without_a_reference_is_an_error(study, results) -> None:
    capacity = capacity_of(study, results, tabulate(results))
    with pytest.raises(ValueError, match=r"yade: .* loads of SiDMACIB, but .* to compare"):
        fit_table(capacity.drop(index=0))


def test_two_references_are_each_fitted_with_their_own_weights(study, results) -> None:
    others = [
        CaseResult(
            r.replace(case, model="static"),
            *(r.peak_load, r.failed_load, None, r.nodes.assign(shear_y_Pa=-2e4), r.history),
        )
        for r in results
    ]
    alone = fit_table(capacity_of(study, results, tabulate(results)))
    both = fit_table(capacity_of(study, results + others, tabulate(results + others)))
    columns = ["option", "friction", "reduction", "misfit"]
    pd.testing.assert_frame_equal(
        both.loc[both["model"] == "yade", columns].reset_index(drop=True),
        alone[columns].reset_index(drop=True),
    )


def test_a_curve_that_is_the_model_itself_is_won_without_misfit(study) -> None:
    joint = study.joint("n3")
    cases = [case for case in cases_of(study).values() if case.model == "yade"]
    model = Sidmacib(joint, ContactOption.pair(0.25), active(joint, 1), friction=False)
    points = capacities(model, [case.direction for case in cases])
    results = [result_with(c, 0, -4e4, p.load) for c, p in zip(cases, points, strict=True)]
    best = winner(fit_table(capacity_of(study, results, tabulate(results))), "n3", 0.02)
    assert (best["option"], best["friction"], best["misfit"]) == (
        "option4",
        False,
        pytest.approx(0),
    )


# --- tables --------------------------------------------------------------------------------------
def test_validation_holds_published_and_computed_side_by_side(study, results) -> None:
    weights = tabulate(results)
    capacity = capacity_of(study, results, weights)
    table = validation_table(study, capacity, weights, fit_table(capacity), read_published())
    assert table.columns[:6].tolist() == [
        *("quantity", "locks", "mesh_m", "published", "computed", "relative_difference")
    ]
    rows = table.set_index("quantity")
    assert rows.loc["dem_pure_shear_N", "published"] == 240.76
    assert rows.loc["dem_pure_shear_N", "relative_difference"] == pytest.approx(230.4 / 240.76 - 1)
    assert rows.loc["sidmacib_pure_shear_option1_frictionless_N", "relative_difference"] == 0
    assert rows.loc["weight_lock1", "published"] == 0.99
    assert rows.loc["weight_lock1_swapped", "published"] == 0.77
    assert math.isnan(rows.loc["weight_lock3", "relative_difference"])
    assert rows.loc["weight_lock3", "absolute_difference"] == pytest.approx(0.5)


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
    ],
)
def test_only_the_papers_samples_and_loads_are_held_against_the_paper(
    change: dict[str, object], covered: bool
) -> None:
    config = {"samples": {"n": {"locks": 3}}, "meshes": [0.02], **change}
    assert read_published().covers(read_study(config), "n") is covered


def test_the_summary_tells_the_findings_and_where_everything_is(study, results) -> None:
    weights = tabulate(results)
    capacity = capacity_of(study, results, weights)
    fit = fit_table(capacity)
    text = summary(
        "there",
        {
            "validation": validation_table(study, capacity, weights, fit, read_published()),
            "fit": fit,
            "best_fit": best_table(study, capacity),
            "capacity": capacity,
        },
    )
    assert "Tables:  there/tables" in text
    assert "Assumed: a, b, h and H" in text
    assert "-4.3 %" in text  # 230.4 N against 240.76 N


def test_torsion_alone_has_an_infinite_eccentricity_in_the_tables(study, results) -> None:
    weights = tabulate(results)
    assert weights["eccentricity_m"].max() == math.inf
    rows = pd.DataFrame(sidmacib_rows(study, weights))
    torsion = rows[rows["eccentricity_m"] == math.inf]
    assert (torsion["shear_N"] == 0).all()
    assert Direction.at_eccentricity(math.inf, 0.06).shear == 0
