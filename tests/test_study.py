"""The configuration: defaults, and one clear line for every fault."""

import math
from typing import Any

import pytest
import yaml
from conftest import ROOT
from workflow.schema import Study

from sidmacib.contact_points import OPTIONS
from sidmacib.joint import Failure, Joint
from workflow.cases import Case, cases_of
from workflow.configuration import ConfigError, installed_engines, read_study
from workflow.engines import ENGINES

ONE: dict[str, Any] = {"samples": {"n3": {"locks": 3}}}


def merged(**change: Any) -> dict[str, Any]:
    return {**ONE, **change}


def test_config_yaml_spells_out_the_defaults() -> None:
    config = yaml.safe_load((ROOT / "config.yaml").read_text())
    study = read_study(config)
    default = read_study({"samples": config["samples"], "variants": config["variants"]})
    assert study == default
    assert set(config) == set(type(study).model_fields)
    assert study.joint("n3") == Joint(3)
    assert {k: o.contact_option() for k, o in study.sidmacib.options.items()} == OPTIONS


def test_scientific_notation_without_a_point_is_a_number() -> None:
    study = read_study(yaml.safe_load("{samples: {n3: {locks: 3}}, geometry: {a: 6e-2}}"))
    assert study.joint("n3").a == 0.06


def test_a_sample_may_have_sizes_of_its_own() -> None:
    study = read_study({"samples": {"n3": {"locks": 3}, "wide": {"locks": 5, "b": 0.08}}})
    assert study.joint("wide") == Joint(5, b=0.08)


def test_eccentricities_are_over_the_length_of_each_samples_own_locks() -> None:
    study = read_study({"samples": {"long": {"locks": 3, "a": 0.1}}, "eccentricities": [0.5]})
    assert {case.loading.eccentricity for case in cases_of(study).values()} == {0.05}


def test_another_results_folder_may_be_a_number_or_badly_spelled() -> None:
    assert read_study(merged(results=2024)).results == "2024"
    assert read_study(merged(results="./out//x/")).results == "out/x"


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ({}, "samples: missing"),
        (merged(geomtry={}), r"geomtry: unknown key; allowed here are results, samples, .*"),
        (merged(geometry={"A": 1}), "geometry.A: unknown key; allowed here are a, b, h, H"),
        (merged(geometry={"a": -1}), "geometry.a: got -1, input should be greater than 0"),
        (
            merged(geometry={"a": "long"}),
            "geometry.a: got 'long', input should be a valid number.*",
        ),
        (merged(meshes=[0.06]), "meshes: got 0.06 m, allowed is less than 0.05 m, .* sample n3"),
        (merged(meshes=[0.02, 0.02]), "meshes: got .*, allowed is each value once"),
        (merged(eccentricities=["twist"]), r"eccentricities.0: got 'twist', allowed are .*torsion"),
        (merged(eccentricities=[-0.1]), r"eccentricities.0: got -0.1, allowed are .*"),
        (
            {"samples": {"n4": {"locks": 4}}},
            r"samples.n4.locks: got 4, allowed are odd numbers while .* half, .*",
        ),
        (
            {"samples": {"n1": {"locks": 1}}},
            "samples.n1.locks: got 1, .* greater than or equal to 2",
        ),
        (
            merged(dem={"engines": ["3dec"]}),
            "dem.engines.0: got '3dec', input should be 'yade' or 'liggghts'",
        ),
        (
            merged(assembly={"failure": "soft"}),
            "assembly.failure: got 'soft', .* 'brittle' or 'ductile'",
        ),
        (
            merged(dem={"numerics": {"tolerance": 0.1}}),
            "dem.numerics.tolerance: got 0.1, .* less than or equal to 0.0025",
        ),
        (
            merged(sidmacib={"options": {"o": {"positions": [0.1], "portions": [0.4]}}}),
            "sidmacib.options.o: portions: got .* add up to 1",
        ),
        (
            merged(sidmacib={"reductions": ["quarter"]}),
            "sidmacib.reductions.0: got 'quarter', input should be 'none', .*",
        ),
        (
            merged(variants={"v": {"failur": "ductile"}}),
            "variants.v.failur: unknown key; allowed here are failure, load_share, .*",
        ),
        (merged(results=" "), "results: got nothing, allowed is the name of a folder"),
        (
            merged(dem={"engines": []}, models=["limit"]),
            r"models: got \['limit'\], allowed without an engine .* are lists with static",
        ),
        (
            merged(materials={"inner": {"shear_stiffness": 5e9}}),
            "materials.inner.shear_stiffness: got 5e.09 Pa/m, allowed with liggghts is",
        ),
        (
            merged(models=["static", "static"]),
            r"models: got \['static', 'static'\], allowed is each name once",
        ),
        (merged(models=["magic"]), "models.0: got 'magic', input should be 'static' or 'limit'"),
        (
            merged(assembly={"failure": "ductile"}),
            "models: got static, allowed with assembly.failure ductile are: limit",
        ),
        (
            merged(assembly={"failure": "ductile"}, models=["limit"]),
            "assembly.failure: got ductile, allowed with liggghts is brittle",
        ),
        (merged(sidmacib={"options": {}}), "sidmacib.options: got {}, .* at least 1 item .*"),
        (
            merged(variants={"v": {"eccentricities": [0.1, 0.10000001]}}),
            "variants.v: got n3-.*-v twice, allowed is once",
        ),
        (merged(variants={"reference": {}}), "variants: got reference, .*"),
        (merged(figures={"mesh": 0.03}), r"figures.mesh: got 0.03, allowed are meshes: .*"),
        (merged(overrides={"x": {}}), "overrides: got x, allowed are cases: n3-mesh.*"),
        (
            merged(overrides={"n3-mesh0.02-torson": {}}),
            "overrides: got n3-mesh0.02-torson, allowed are .*, such as n3-mesh0.02-torsion",
        ),
        (merged(meshes=0.01), "meshes: got 0.01, input should be a list"),
        (
            {"samples": {"my-joint": {"locks": 3}}},
            "samples: got 'my-joint', allowed are letters, digits, _ and . in a name",
        ),
    ],
)
def test_a_fault_is_told_in_one_line_with_key_value_and_what_is_allowed(
    config: dict[str, Any], message: str
) -> None:
    with pytest.raises(ConfigError, match=f"^{message}") as error:
        cases_of(read_study(config))
    assert len(str(error.value).splitlines()) == 1


def test_an_even_number_of_locks_is_welcome_without_the_rule_that_needs_an_odd_one() -> None:
    study = read_study({"samples": {"n4": {"locks": 4}}, "sidmacib": {"reductions": ["none"]}})
    assert study.joint("n4").locks == 4


# --- cases ---------------------------------------------------------------------------------------
def test_the_papers_study_has_every_sample_mesh_and_direction() -> None:
    study = read_study(yaml.safe_load((ROOT / "config.yaml").read_text()))
    reference = [case for case in cases_of(study).values() if case.variant == "reference"]
    assert len(reference) == 4 * 2 * 2 * 9
    assert {case.model for case in reference} == {"yade", "liggghts", "static", "limit"}
    assert {case.loading.eccentricity for case in reference} == {
        0.06 * ratio for ratio in (0, 0.05, 0.1, 0.2, 0.35, 0.5, 1, 2, math.inf)
    }


def test_a_case_survives_json_pure_torsion_included() -> None:
    for case in cases_of(read_study(ONE)).values():
        assert Case.model_validate_json(case.model_dump_json()) == case


def test_a_variant_changes_what_it_names_where_it_says() -> None:
    variants = {"soft": {"failure": "ductile", "meshes": [0.02], "eccentricities": [0]}}
    cases = cases_of(read_study(merged(variants=variants)))
    assert {key for key, case in cases.items() if case.variant == "soft"} == {
        (model, "n3-mesh0.02-e0a-soft")
        for model in ("yade", "limit")  # the others are brittle only
    }
    soft = cases["yade", "n3-mesh0.02-e0a-soft"]
    assert soft.joint.failure is Failure.DUCTILE
    reference = cases["yade", "n3-mesh0.02-e0a"]
    assert soft.model_copy(update={"joint": reference.joint}).loading == reference.loading


def test_a_variant_of_the_numerics_is_for_engines_only() -> None:
    cases = cases_of(read_study(merged(variants={"slow": {"numerics": {"ramp_periods": 80}}})))
    assert {case.model for case in cases.values() if case.variant == "slow"} == {*ENGINES}
    assert all((case.numerics is None) == (case.model not in ENGINES) for case in cases.values())


def test_without_engines_the_static_model_leads() -> None:
    study = read_study(merged(dem={"engines": []}))
    assert study.references == ("static",)
    assert {model for model, _ in cases_of(study)} == {"static", "limit"}


@pytest.mark.parametrize(
    "config",
    [
        {"samples": {"n": {"locks": 4}}, "sidmacib": {"reductions": ["none"]}},
        merged(assembly={"failure": "ductile"}, models=["limit"], dem={"engines": ["yade"]}),
        merged(materials={"inner": {"shear_stiffness": 5e9}}, dem={"engines": []}),
        {"samples": {"n": {"locks": 3, "b": 0.02}}, "meshes": [0.005]},
    ],
)
def test_the_parts_that_steps_get_are_valid_studies_too(config: dict[str, Any]) -> None:
    study = read_study(config)
    for part in ("tables", "pieces", "figures", "calibration"):
        again = Study.model_validate_json(getattr(study, f"{part}_json")())
        assert (again.assembly, again.samples) == (study.assembly, study.samples)


def test_an_override_may_be_for_an_engine_that_is_left_out() -> None:
    variants = {"slow": {"numerics": {"ramp_periods": 80}}}
    overrides = {"n3-mesh0.02-e0a-slow": {"tolerance": 0.002}}
    config = merged(variants=variants, overrides=overrides, dem={"engines": []})
    assert cases_of(read_study(config))


def test_only_an_engine_that_can_gets_several_ranks() -> None:
    cases = cases_of(read_study(merged(dem={"numerics": {"ranks": 2}})))
    ranks = {m: c.numerics.ranks for (m, _), c in cases.items() if c.numerics is not None}
    assert ranks == {"yade": 1, "liggghts": 2}


def test_an_engine_that_is_not_installed_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    study = read_study(ONE)
    assert installed_engines(study) == ["yade", "liggghts"]
    monkeypatch.setenv("PATH", "")
    assert installed_engines(study) == []
    assert "yade: not installed; on Debian: apt-get install yade" in capsys.readouterr().err


def test_an_override_changes_one_case_only() -> None:
    before = cases_of(read_study(ONE))
    after = cases_of(read_study(merged(overrides={"n3-mesh0.02-torsion": {"ramp_periods": 50}})))
    changed = [key for key in before if before[key] != after[key]]
    assert changed == [(engine, "n3-mesh0.02-torsion") for engine in ENGINES]
    assert after[changed[0]].numerics.ramp_periods == 50
