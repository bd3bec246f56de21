"""Samples with other faces and models than the study, in tables, figures and words."""

import math

import pandas as pd
import pytest
from made_up_results import record_with, tables_of
from small import SMALL

from analysis.published import comparisons, difference_text, read_published
from analysis.summary.summary import leading_models
from analysis.tables.capacity import sidmacib_rows
from analysis.tables.collect import weights_table
from workflow.case import JointCase
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results.joint_part import JointRecord
from workflow.schema import Study
from workflow.schema.sections import PartSection

pytestmark = pytest.mark.study

PUBLISHED = read_published()


@pytest.fixture
def study() -> Study:
    fits = {"locks": 3, "dry": {"friction": 0.005236}, "models": ["static"]}
    samples = {"n3": {"locks": 3}, "n3_fits": fits}
    return read_study(SMALL | {"samples": samples, "dem": {"engines": ["yade"]}})


@pytest.fixture
def results(study: Study) -> list[JointRecord]:
    """Peaks that fall with the mesh and with the friction."""

    def peak(case: JointCase) -> float:
        return 240.0 * (1.0 + 5.0 * case.subject.mesh) - 10.0 * (case.subject.sample != "n3")

    return [record_with(case, 0.5, peak(case)) for case in cases_of(study).values()]


@pytest.fixture
def tables(study: Study, results: list[JointRecord]) -> dict[str, pd.DataFrame]:
    return tables_of(study, results)


# --- what is compared with what ------------------------------------------------------------------
def test_the_papers_numbers_belong_to_samples_of_any_friction_as_stated(study: Study) -> None:
    assert PUBLISHED.samples(study) == {"n3": 3, "n3_fits": 3}
    assert PUBLISHED.as_printed(study, "n3")
    assert not PUBLISHED.as_printed(study, "n3_fits")


def test_each_sample_is_fitted_to_models_that_run_on_it(tables: dict[str, pd.DataFrame]) -> None:
    found = tables["fit"].groupby("sample")["model"].unique()
    assert {sample: set(models) for sample, models in found.items()} == {
        "n3": {"yade", "static"},
        "n3_fits": {"static"},
    }
    assert leading_models(tables["fit"]) == {"n3": "yade", "n3_fits": "static"}


def test_sidmacib_is_fitted_to_no_part_of_a_sample(
    study: Study, results: list[JointRecord]
) -> None:
    part = {"yade": PartSection(eccentricities=(0.0,))}
    sample = study.samples["n3"].model_copy(update={"only": part})
    changed = study.model_copy(update={"samples": {**study.samples, "n3": sample}})
    weights = weights_table(results)
    rows = pd.DataFrame(sidmacib_rows(changed, weights))
    assert set(rows[rows["sample"] == "n3"]["weights_from"]) == {"static"}


def test_cases_for_the_mesh_error_are_in_no_fit(tables: dict[str, pd.DataFrame]) -> None:
    assert set(tables["cases"]["mesh_m"]) == {0.02, 0.01}
    assert set(tables["fit"]["mesh_m"]) == set(tables["best_fit"]["mesh_m"]) == {0.02}
    assert (tables["fit"]["directions"] == 3).all()
    assert set(tables["validation"]["mesh_m"].dropna()) == {0.02}


def test_validation_states_friction_and_mesh_error(tables: dict[str, pd.DataFrame]) -> None:
    rows = tables["validation"].query("quantity == 'dem_pure_shear_N' and model == 'static'")
    rows = rows.set_index("sample")
    assert rows.loc["n3", ["friction", "setting"]].tolist() == [0.3, "as printed"]
    assert rows.loc["n3_fits", ["friction", "setting"]].tolist() == [0.005236, "not as printed"]
    change, cells = 5.0 * 0.01 / (1 + 5 * 0.01), math.sqrt(30.0)  # along a side; 3 at 0.02 m
    expected = change + change / (cells / 3 - 1) + 0.02 / cells
    assert rows.loc["n3", "mesh_error"] == pytest.approx(expected)


# --- beside each other ---------------------------------------------------------------------------
def test_samples_of_the_same_locks_stand_side_by_side(tables: dict[str, pd.DataFrame]) -> None:
    (found,) = comparisons(tables["validation"], leading_models(tables["fit"]))
    assert found.samples == {
        "n3": ("friction 0.3, as printed", "yade"),
        "n3_fits": ("friction 0.005236, not as printed", "static"),
    }
    (peak,) = (line for line in found.lines if line.quantity == "dem_pure_shear_N")
    assert (peak.mesh, peak.published) == ("0.02", 240.76)
    computed = {sample: row.computed for sample, row in peak.rows.items()}
    assert computed == {"n3": 264.0, "n3_fits": 254.0}
    assert difference_text(peak.rows["n3"]) == "+9.65 %"
