"""Samples with other faces and models than the study, in tables, figures and words."""

import math
from collections.abc import Callable

import pandas as pd
import pytest
from made_up_results import record_with, tables_of

from analysis.figures.catalogue import FigureSpec, figures_of
from analysis.figures.curves import mesh_error_words, meshes
from analysis.figures.material import FigureData
from analysis.figures.side_by_side import side_by_side
from analysis.published import read_published
from analysis.summary.summary import leading_models, summary
from analysis.tables.capacity import sidmacib_rows
from analysis.tables.collect import weights_table
from analysis.tables.validation import comparisons, difference_text
from sidmacib.models import detailed
from workflow.configuration import read_study
from workflow.planning.cases import cases_of
from workflow.results.joint_part import JointRecord
from workflow.schema import Study
from workflow.schema.joint import PartSection
from workflow.threedec import decks

pytestmark = pytest.mark.study

PUBLISHED = read_published()


@pytest.fixture
def study() -> Study:
    fits = {"locks": 3, "dry": {"friction": 0.005236}, "models": ["static"]}
    return read_study(
        {
            "samples": {"n3": {"locks": 3}, "n3_fits": fits},
            "meshes": [0.02],
            "eccentricities": [0, 0.5, "torsion"],
            "models": ["static"],
            "dem": {"engines": ["yade"]},
        }
    )


@pytest.fixture
def results(study: Study) -> list[JointRecord]:
    """Peaks that fall with the mesh and with the friction."""
    return [
        record_with(
            case,
            0.5,
            240.0 * (1.0 + 5.0 * case.subject.mesh) - 10.0 * (case.subject.sample != "n3"),
        )
        for case in cases_of(study).values()
    ]


@pytest.fixture
def tables(study: Study, results: list[JointRecord]) -> dict[str, pd.DataFrame]:
    return tables_of(study, results)


@pytest.fixture
def material(study: Study, tables: dict[str, pd.DataFrame]) -> Callable[[FigureSpec], FigureData]:
    def of(spec: FigureSpec) -> FigureData:
        columns = ["model", "sample", "case"]
        shown = (tables["capacity"], tables["validation"], tables["cases"][columns], pd.DataFrame())
        return FigureData(
            spec, study, detailed(study.model_names), *shown, variants=pd.DataFrame(), stresses=None
        )

    return of


# --- what is compared with what ------------------------------------------------------------------
def test_the_papers_numbers_belong_to_a_sample_of_any_friction_which_is_stated(
    study: Study,
) -> None:
    assert PUBLISHED.samples(study) == {"n3": 3, "n3_fits": 3}
    assert PUBLISHED.as_printed(study, "n3")
    assert not PUBLISHED.as_printed(study, "n3_fits")


def test_every_sample_is_fitted_to_the_models_that_run_on_it(
    tables: dict[str, pd.DataFrame],
) -> None:
    found = tables["fit"].groupby("sample")["model"].unique()
    assert {sample: set(models) for sample, models in found.items()} == {
        "n3": {"yade", "static"},
        "n3_fits": {"static"},
    }
    assert leading_models(tables["fit"]) == {"n3": "yade", "n3_fits": "static"}


def test_sidmacib_is_not_fitted_to_a_model_that_runs_a_part_of_a_sample(
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


def test_decks_are_written_for_the_studys_meshes_and_for_every_sample(study: Study) -> None:
    found = decks(study, cases_of(study).values()).values()
    assert {case.subject.mesh for case in found} == {0.02}
    assert {case.subject.sample for case in found} == {"n3", "n3_fits"}


def test_validation_states_friction_and_mesh_error(tables: dict[str, pd.DataFrame]) -> None:
    rows = tables["validation"].query("quantity == 'dem_pure_shear_N' and model == 'static'")
    rows = rows.set_index("sample")
    assert rows.loc["n3", ["friction", "setting"]].tolist() == [0.3, "as printed"]
    assert rows.loc["n3_fits", ["friction", "setting"]].tolist() == [0.005236, "not as printed"]
    change, cells = 5.0 * 0.01 / (1 + 5 * 0.01), math.sqrt(30.0)  # along a side; 3 at 0.02 m
    expected = change + change / (cells / 3 - 1) + 0.02 / cells
    assert rows.loc["n3", "mesh_error"] == pytest.approx(expected)


def test_published_numbers_have_no_mesh_error_and_sidmacibs_neither(
    tables: dict[str, pd.DataFrame],
) -> None:
    capacity = tables["capacity"]
    known = capacity.groupby("model")["mesh_error"].apply(lambda errors: errors.notna().all())
    assert known.to_dict() == {
        **{"published": False, "sidmacib": False, "static": True, "yade": True}
    }


# --- beside each other ---------------------------------------------------------------------------
def test_samples_with_the_same_locks_stand_beside_each_other(
    tables: dict[str, pd.DataFrame],
) -> None:
    (found,) = comparisons(tables["validation"], leading_models(tables["fit"]))
    assert found.samples == {
        "n3": "friction 0.3, as printed; yade",
        "n3_fits": "friction 0.005236, not as printed; static",
    }
    (peak,) = (line for line in found.lines if line.quantity == "dem_pure_shear_N")
    assert (peak.mesh, peak.published) == ("0.02", 240.76)
    assert {sample: row.computed for sample, row in peak.rows.items()} == {
        "n3": 264.0,
        "n3_fits": 254.0,
    }
    assert difference_text(peak.rows["n3"]) == "+9.65 %"


def test_no_line_holds_numbers_of_another_model(tables: dict[str, pd.DataFrame]) -> None:
    (found,) = comparisons(tables["validation"], {"n3": "yade", "n3_fits": "static"})
    names = {"n3": {"yade", "sidmacib"}, "n3_fits": {"static", "sidmacib"}}
    for line in found.lines:
        assert all(row.model in names[sample] for sample, row in line.rows.items())


# --- in words ------------------------------------------------------------------------------------
def test_the_summary_shows_both_with_their_friction_and_the_mesh_error(
    tables: dict[str, pd.DataFrame],
) -> None:
    text = summary("there", tables, [0.02])
    assert "3 locks, n3: friction 0.3, as printed; yade" in text
    assert "3 locks, n3_fits: friction 0.005236, not as printed; static" in text
    (line,) = (line for line in text.splitlines() if "peak V of the pieces" in line)
    assert line.split("(N)")[1].split() == [
        "0.02",
        "240.76",
        "264",
        "+9.65",
        "%",
        "254",
        "+5.50",
        "%",
    ]
    assert "SiDMACIB against yade and static" in text


def test_a_mesh_error_above_two_percent_is_named_with_what_helps(
    tables: dict[str, pd.DataFrame],
) -> None:
    text = summary("there", tables, [0.02])
    (line,) = (line for line in text.splitlines() if "static mesh 0.02 m:" in line)
    assert line == "  static mesh 0.02 m: 11.33 % (n3_fits-mesh0.02-e0a), ABOVE 2 %"
    assert "capacities have a mesh error above 2 %" in text
    small = tables | {"capacity": tables["capacity"].assign(mesh_error=0.01)}
    text = summary("there", small, [0.02])
    assert "static mesh 0.02 m: 1.00 %" in text
    assert "ABOVE" not in text and "capacities have a mesh error" not in text


def test_loads_at_the_mesh_for_the_error_only_are_not_listed(
    tables: dict[str, pd.DataFrame],
) -> None:
    listed = summary("there", tables, [0.02]).split("Static model, mesh 0.02 m")[1].split("\n\n")[0]
    finer = tables["capacity"].query("mesh_m == 0.01")["shear_N"].dropna()
    assert len(listed.splitlines()) == 1 + 1 + 3
    assert not any(f"{shear:.5g}" in listed for shear in finer if shear)


# --- in figures ----------------------------------------------------------------------------------
def test_stress_maps_of_a_sample_are_those_of_the_models_that_run_on_it(study: Study) -> None:
    figures = figures_of(study, detailed(study.model_names))
    assert figures["shear_stress-n3"].case.model == "yade"
    assert figures["shear_stress-n3_fits"].case.model == "static"
    assert "shear_stress-n3-static" not in figures


def test_a_figure_leads_with_a_model_that_runs_on_its_sample(material) -> None:
    assert material(FigureSpec("revised-n3", "revised", "n3")).leading == "yade"
    drawn = material(FigureSpec("revised-n3_fits", "revised", "n3_fits"))
    assert (drawn.leading, drawn.models) == ("static", ("static",))


def test_a_caption_says_what_friction_is_not_the_printed_one(material) -> None:
    drawn = material(FigureSpec("models-n3_fits", "models", "n3_fits"))
    assert "n3_fits: friction 0.005236 on dry faces, to fit, not the printed 0.3" in (
        drawn.assumed_geometry
    )
    assert "friction" not in material(FigureSpec("models-n3", "models", "n3")).assumed_geometry


def test_the_figure_of_meshes_has_a_panel_for_each_sample_and_states_the_error(material) -> None:
    drawn = material(FigureSpec("meshes", "meshes"))
    titles = [axes.get_title(loc="left") for axes in meshes(drawn).axes]
    assert titles == ["n3: 3 locks", "n3_fits: 3 locks"]
    assert (
        mesh_error_words(drawn) == "Mesh error, estimated from two meshes: up to 11.3 % at 0.02 m. "
    )


def test_the_page_that_puts_all_side_by_side_has_a_row_for_each_sample(material) -> None:
    figure = side_by_side(material(FigureSpec("side_by_side", "side_by_side")))
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert titles[0] == "n3: 3 locks, friction 0.3, peak V at e = 0 (N)"
    assert titles[2] == "n3_fits: 3 locks, friction 0.005236, peak V at e = 0 (N)"
    assert not math.isnan(figure.get_figheight())
