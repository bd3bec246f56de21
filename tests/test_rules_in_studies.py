"""Law, safe rule, SiDMACIB, measured loads and variants in a study."""

import math
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import outputs_of
from made_up_results import capacity_of, record_with
from scipy.stats import norm
from small import SMALL, TWO_MESHES

from analysis.__main__ import describe_rule, run_case
from analysis.tables.capacity import law_rows
from analysis.tables.collect import weight_sums, weights_table
from analysis.tables.comparisons import measured_table, variants_table
from sidmacib import Direction, Reliability, characteristic, design_resistance, law, safe
from sidmacib.mechanics.assembly import Failure
from studies.measured.specimens import LEAST, POWER, SIGNIFICANCE, specimens
from workflow.case import JointCase
from workflow.cases import cases_of, find_place
from workflow.configuration import ConfigError, read_study
from workflow.schema import MeasuredLoad, Study


def study_of(**change: Any) -> Study:
    config = {"samples": {"n3": {"locks": 3}}, "meshes": [0.02], "eccentricities": [0, 0.5]}
    return read_study({**config, "dem": {"engines": []}, **change})


def test_law_and_safe_rule_are_models_of_a_study_that_names_none() -> None:
    study = study_of()
    assert study.models == ("static", "limit", "law", "safe")
    rows = pd.DataFrame(law_rows(study)).set_index(["model", "eccentricity_m"])
    for name, rule in (("law", law), ("safe", safe)):
        for ratio in (0.0, 0.5):
            found = rule(study.joint("n3"), Direction(ratio))
            row = rows.loc[(name, ratio * 0.06)]
            assert (row["shear_N"], row["torque_Nm"]) == (found.shear, found.torque)


def test_a_study_has_the_resistances_that_its_scatter_and_its_partial_factor_ask_for() -> None:
    study = study_of(models=["static", "safe"], reliability={"scatter": 0.2, "gamma_m": 1.5})
    assert study.models == ("static", "safe", "characteristic", "design")
    rows = pd.DataFrame(law_rows(study)).set_index(["model", "eccentricity_m"])
    joint, direction = study.joint("n3"), Direction(0.5)
    weak, last = characteristic(joint, direction, 0.2).capacity, rows.loc[("design", 0.03)]
    assert rows.loc[("characteristic", 0.03)]["shear_N"] == weak.shear
    found = design_resistance(joint, direction, Reliability(0.2, 1.5))
    assert (last["shear_N"], last["torque_Nm"]) == (found.shear, found.torque)
    assert study_of(models=["static"], reliability={"gamma_m": 1.5}).models == ("static", "design")
    with pytest.raises(ConfigError, match="models: 'design' is not allowed; it must be"):
        study_of(models=["static", "design"])


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"samples": {"n3": {"locks": 40}}}, "locks: 40 is not allowed; it must be from 2 to 31"),
        (
            {"assembly": {"upper_body": "joined"}},
            "assembly.upper_body: joined is not allowed with law; it must be columns or",
        ),
        (
            {"assembly": {"load_share": "body"}},
            "assembly.load_share: body is not allowed with law; it must be face",
        ),
    ],
)
def test_a_joint_that_the_law_refuses_has_the_reason(change: dict[str, Any], reason: str) -> None:
    study = study_of(**change, sidmacib={"reductions": ["none"]})
    results = [record_with(each, 0.5) for each in cases_of(study).values()]
    table = capacity_of(study, results)
    (message,) = table[table["model"] == "law"]["error"].unique()
    assert message.startswith(reason)
    assert table[table["model"] == "law"]["load_N"].isna().all()


def test_a_case_of_a_rule_is_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = tmp_path / "study.yaml"
    config.write_text("samples: {n3: {locks: 3}}\nvariants: {one: {upper_body: columns}}\n")
    study = read_study({"samples": {"n3": {"locks": 3}}, "variants": {"one": {}}})
    expected = safe(study.joint("n3"), Direction(0.1))
    assert run_case(config, str(tmp_path / "results"), "n3-mesh0.02-e0.1a", "safe") is None
    output = capsys.readouterr().out
    assert f"V = {expected.shear:.2f} N, M = {expected.torque:.4f} N m" in output
    assert run_case(config, None, "n3-mesh0.02-e0.1a-one", "safe") is None
    assert output.partition("V")[2] != capsys.readouterr().out.partition("V")[2]
    assert not (tmp_path / "results").exists()


def test_sidmacib_is_printed_by_the_rules_that_need_no_weights() -> None:
    study = study_of()
    lines = describe_rule(study, "sidmacib", find_place(study, "n3-mesh0.02-e0a")).splitlines()
    assert len(lines) == 1 + 2 * 4 * 2
    assert "  Option 4, no friction, every lock counts: V = 720.00 N, M = 0.0000 N m" in lines
    assert "  Option 4, no friction, (n - 1) / 2 locks count: V = 240.00 N, M = 0.0000 N m" in lines


def test_a_rule_that_refuses_a_case_says_why(tmp_path: Path) -> None:
    config = tmp_path / "study.yaml"
    config.write_text("samples: {n3: {locks: 3, dry: {friction: 0.9}}}\n")
    found = run_case(config, None, "n3-mesh0.02-e0a", "law")
    assert "n3-mesh0.02-e0a (law): no result: friction: 0.9 is not allowed" in found


def test_a_case_that_no_rule_has_is_refused_with_what_is_near(tmp_path: Path) -> None:
    words = r"^CASE: 'n3-mesh0.2-e0a' is not a case; .* n3-mesh0.02-e0a"
    with pytest.raises(ConfigError, match=words):
        find_place(study_of(), "n3-mesh0.2-e0a")


# --- measured loads, and how many specimens a laboratory needs -----------------------------------
LOAD = {"sample": "n3", "eccentricity": 0.5, "torque": 3.0, "specimen": "A1"}
SOURCE = {"source": "a made-up campaign, for tests", "digitised": "not at all"}
CONFIG = SMALL | {
    "meshes": [0.02, 0.005],
    "models": ["static", "law"],
    "measured": SOURCE | {"loads": [LOAD]},
}


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ({"eccentricity": 0, "shear": 100.0}, (100.0, 0.0)),
        ({"eccentricity": 0.5, "shear": 100.0}, (100.0, 3.0)),
        ({"eccentricity": 0.5, "torque": 3.0}, (100.0, 3.0)),
        ({"eccentricity": "torsion", "torque": 3.0}, (0.0, 3.0)),
    ],
)
def test_a_load_is_a_shear_or_a_torque(load: dict[str, Any], expected: tuple[float, float]) -> None:
    found = MeasuredLoad.model_validate({"sample": "n3", **load}).components(a=0.06)
    assert found == pytest.approx(expected)


def test_every_model_stands_beside_a_measured_load_in_the_same_direction() -> None:
    study = read_study(CONFIG)
    fine, coarse = min(study.meshes), max(study.meshes)
    capacity = pd.DataFrame(
        [("law", fine, 115.0), ("static", fine, None), ("static", coarse, 1.0)],
        columns=["model", "mesh_m", "load_N"],
    ).assign(variant="reference", sample="n3", eccentricity_over_a=0.5)
    assert study.measured is not None
    table = measured_table(study, study.measured, capacity).set_index("model")
    assert table.loc["law", "measured_load_N"] == pytest.approx(math.hypot(100.0, 3.0 / 0.06))
    assert table.loc["law", "difference"] == pytest.approx(115.0 / math.hypot(100.0, 50.0) - 1.0)
    assert math.isnan(table.loc["static", "difference"])


@pytest.mark.study
def test_a_study_with_measured_loads_has_a_table_of_them(tmp_path: Path) -> None:
    assert "tables/measured.csv" in outputs_of(CONFIG, tmp_path)["comparisons"]


def test_so_many_specimens_find_a_difference_as_often_as_asked() -> None:
    """By simulation: samples of the difference, tested with its known deviation."""
    difference, deviation = 0.1, 0.2
    count = specimens(difference, deviation)
    means = np.random.default_rng(3).normal(difference, deviation / math.sqrt(count), 20_000)
    found = np.abs(means) > norm.isf(SIGNIFICANCE / 2) * deviation / math.sqrt(count)
    assert found.mean() == pytest.approx(POWER, abs=0.015)


def test_a_large_difference_still_takes_a_few() -> None:
    assert specimens(1.0, 0.1) == LEAST


# --- what variants change: in the joints, in a table, and in its figures -------------------------
BENDS = {"soft": {"young": 1e9}, "rigid": {"pieces": "rigid"}}


def varied(variants: Mapping[str, Any], **others: Any) -> Study:
    return read_study({**TWO_MESHES, "variants": variants, **others})


def elastic_study() -> Study:
    return varied(BENDS, assembly={"pieces": "elastic"})


def tables_of(
    study: Study, load: Callable[[JointCase], float]
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Capacities, and what variants change, of results with made-up loads."""
    results = [record_with(case, 0.5, load(case)) for case in cases_of(study).values()]
    capacity = capacity_of(study, results)
    return capacity, variants_table(study, capacity, weight_sums(weights_table(results)))


@cache
def any_capacity() -> pd.DataFrame:
    """Capacities of the elastic study: those of SiDMACIB are the same whatever its models carry."""
    return tables_of(elastic_study(), lambda case: 100.0)[0]


def test_a_variant_changes_the_fracture_energy_of_inner_faces() -> None:
    cases = cases_of(varied({"tough": {"failure": "softening", "fracture_energy": 10}}))
    tough = cases["cases/static/n3-mesh0.02-e0a-tough"].subject.joint
    assert (tough.failure, tough.inner.fracture_energy) == (Failure.SOFTENING, 10.0)
    assert cases["cases/static/n3-mesh0.02-e0a"].subject.joint.inner.fracture_energy == 0.0


@pytest.mark.long
def test_every_direction_of_every_variant_has_a_row_with_what_it_changes() -> None:
    study = elastic_study()
    _, table = tables_of(study, lambda case: 100.0 if case.variant == "soft" else 200.0)
    assert len(table) == 3 * 2 * 3
    rows = table[table["case"] == "n3-mesh0.02-e0a"].set_index("variant")
    assert rows["stiffness_ratio"].to_dict() == pytest.approx(
        {"reference": 20.0, "soft": 2.0, "rigid": math.nan}, nan_ok=True
    )
    assert rows["load_over_T0"].to_dict() == pytest.approx(
        {"reference": 200 / 240, "soft": 100 / 240, "rigid": 200 / 240}
    )
    assert (rows["lower_weight_sum"] == 0.5).all()


@pytest.mark.long
@pytest.mark.parametrize("option", ["option1", "option2", "option3", "option4"])
def test_the_option_that_a_variant_follows_is_its_best(option: str) -> None:
    study = elastic_study()
    half = any_capacity().query("option == @option and reduction == 'half' and friction == False")
    follows = half.set_index("case")["load_N"].to_dict()

    def load(case: JointCase) -> float:
        return follows[case.name.removesuffix("-soft")] if case.variant == "soft" else 1.0

    _, table = tables_of(study, load)
    soft = table[table["variant"] == "soft"]
    assert set(soft["option"]) == {option}
    assert soft["misfit"].to_numpy() == pytest.approx(0.0, abs=1e-9)
