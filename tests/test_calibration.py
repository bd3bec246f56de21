"""Which geometry fits the published numbers."""

import math

import numpy as np
import pandas as pd
import pytest

from analysis.calibration import (
    GeometryMisfit,
    TwoParts,
    best_rows,
    engine_study,
    geometries,
    geometry_study,
    misfit_table,
)
from analysis.collect import cases_table, weights_table
from analysis.figures.calibration import calibration
from analysis.published import read_published
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.schema import Study
from workflow.solvers.static import solve
from workflow.steps.solve import solved

PUBLISHED = read_published()


@pytest.fixture(scope="module")
def study() -> Study:
    grid = {"a": [0.05, 0.06], "height_share": [0.2, 0.23], "height_over_b": [0.7, 0.9]}
    samples = {"n3": {"locks": 3}, "n5": {"locks": 5}, "n7": {"locks": 7}}
    return read_study({"samples": samples, "calibration": {**grid, "mesh": 0.02}})


@pytest.fixture(scope="module")
def table(study: Study) -> pd.DataFrame:
    chosen = {f"g{n}": g for n, g in enumerate(geometries(study, PUBLISHED))}
    config = geometry_study(study, PUBLISHED.samples(study), chosen, "there")
    own = read_study(config)
    records = [solved(case, solve)[0] for case in cases_of(own).values()]
    return misfit_table(own, cases_table(records, records), weights_table(records), PUBLISHED)


def test_every_geometry_has_the_published_area_and_the_studys_own_is_last(study: Study) -> None:
    found = list(geometries(study, PUBLISHED))
    assert len(found) == 2 * 2 * 2 + 1
    assert all(math.isclose(g.a * g.b, 0.003) for g in found)
    assert found[-1] == study.geometry
    assert {round(g.h / (g.h + g.H), 9) for g in found[:-1]} == {0.2, 0.23}
    assert {round((g.h + g.H) / g.b, 9) for g in found[:-1]} == {0.7, 0.9}


def test_published_values_themselves_have_no_misfit_in_their_order() -> None:
    peaks = {3: 240.76, 5: 408.26}
    printed = {3: [0.99, 0.77, 0], 5: [0.99, 0.57, 0.68, 0.68, 0]}
    swapped = {3: [0.77, 0.99, 0], 5: [0.57, 0.99, 0.68, 0.68, 0]}
    assert GeometryMisfit.of(peaks, printed, PUBLISHED, 0.02).printed == 0.0
    assert GeometryMisfit.of(peaks, swapped, PUBLISHED, 0.02).swapped == 0.0
    assert GeometryMisfit.of(peaks, printed, PUBLISHED, 0.02).swapped > 5.0


def test_peaks_count_in_percent_and_weights_in_steps_of_two_hundredths() -> None:
    weights = {3: [0.77, 0.99, 0.02]}
    found = GeometryMisfit.of({3: 1.01 * 240.76}, weights, PUBLISHED, 0.02).swapped
    assert found == pytest.approx(math.sqrt((1 + 1) / 4))


def test_no_geometry_fits_the_weights_as_printed(table: pd.DataFrame) -> None:
    assert (table["misfit_printed"] > 4 * table["misfit_swapped"]).all()


def test_samples_that_are_not_published_are_left_out(table: pd.DataFrame) -> None:
    assert {"peak_n3_N", "peak_n5_N"} <= set(table) and "peak_n7_N" not in set(table)


def test_there_is_one_best_geometry_for_each_length(table: pd.DataFrame) -> None:
    best = best_rows(table.iloc[:-1])
    assert sorted(best["a_m"]) == [0.05, 0.06]
    assert best["misfit_swapped"].is_monotonic_increasing
    assert best["misfit_swapped"].min() == table.iloc[:-1]["misfit_swapped"].min()


def test_two_straight_parts_are_found_where_they_meet() -> None:
    shear = np.array([100.0, 90.0, 80.0, 70.0, 35.0, 0.0])
    torque = np.interp(shear, [0.0, 70.0, 100.0], [5.0, 3.0, 0.0])
    found = TwoParts.of(np.column_stack([shear, torque]))
    first, second = math.hypot(0.3, 0.6), math.hypot(0.7, 0.4)
    assert found.turn == pytest.approx(first / (first + second), abs=0.01)
    assert found.slopes == pytest.approx((2.0, 0.4 / 0.7), rel=0.05)
    assert found.residual < 0.01


def test_the_confirmation_is_a_study_of_the_chosen_geometries(study: Study) -> None:
    chosen = list(geometries(study, PUBLISHED))[:2]
    ranked = {f"rank{rank}": geometry for rank, geometry in enumerate(chosen)}
    own = read_study(engine_study(study, PUBLISHED.samples(study), ranked, "there"))
    assert list(own.samples) == ["rank0_n3", "rank0_n5", "rank1_n3", "rank1_n5"]
    assert own.joint("rank1_n5").h == pytest.approx(chosen[1].h)
    assert own.results == "there"
    assert own.dem.engines == study.dem.engines
    elastic = read_study(
        {"samples": {"n3": {"locks": 3}}, "assembly": {"pieces": "elastic"}, "meshes": [0.005]}
    )
    assert elastic.dem.engines == ("calculix",)  # the confirmation's pieces are rigid
    of_elastic = engine_study(elastic, {"n3": 3}, ranked, "there")
    assert read_study(of_elastic).dem.engines == ()


def test_the_figure_shows_the_map_three_profiles_and_a_curve_for_each_sample(
    table: pd.DataFrame,
) -> None:
    row = table.iloc[-1][["a_m", "height_share", "height_over_b"]].to_dict()
    shape = {"turn_from_shear": 0.4}
    points = [(100.0, 0.0), (50.0, 2.0), (0.0, 3.0)]
    curves = pd.DataFrame(
        row | {"locks": n, "shear_N": v, "torque_Nm": m} | shape for n in (3, 5) for v, m in points
    )
    titles = [axes.get_title(loc="left") for axes in calibration(table, curves).axes]
    assert [title for title in titles if title] == [
        *("misfit, a = 0.06 m", "least misfit", "3 locks", "5 locks")
    ]
