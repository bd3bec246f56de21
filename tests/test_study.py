"""The schema and what must hold between its sections: defaults, and one clear line for a fault."""

import json
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest
import yaml
from conftest import DISTINCT, ROOT
from hypothesis import given
from hypothesis import strategies as st

from sidmacib.contact_points.options import OPTIONS, READY_OPTIONS
from sidmacib.engines import ENGINES
from sidmacib.engines.numerics import Numerics
from sidmacib.joint.joint import Joint, OwnLock, UpperBody
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.reading import Section
from workflow.configuration import ConfigError, read_study, with_installed_engines
from workflow.consistency import node_estimate, notes
from workflow.planning.cases import cases_of
from workflow.schema import Study
from workflow.schema.dem import NumericsChanges, NumericsSection
from workflow.schema.joint import (
    DryChanges,
    DryFaceSection,
    GeometrySection,
    InnerChanges,
    InnerFaceSection,
    LockSection,
    SampleSection,
)

ONE: dict[str, Any] = {"samples": {"n3": {"locks": 3}}}
BOTH: dict[str, Any] = {"dem": {"engines": ["yade", "liggghts"]}}


def merged(**change: Any) -> dict[str, Any]:
    return {**ONE, **change}


# --- defaults ------------------------------------------------------------------------------------
def left_out(section: type[Section], given: dict[str, Any], path: str = "") -> Iterator[str]:
    """Keys of ``section`` and those below it that ``given`` has not, but none of named entries."""
    for key, field in section.model_fields.items():
        kind = field.annotation
        if key not in given:
            yield f"{path}{key}"
        elif isinstance(kind, type) and issubclass(kind, Section):
            yield from left_out(kind, given[key], f"{path}{key}.")


def test_config_yaml_spells_out_the_defaults() -> None:
    config = yaml.safe_load((ROOT / "config.yaml").read_text())
    study = read_study(config)
    default = read_study({key: config[key] for key in ("samples", "variants")} | BOTH)
    assert study == default.model_copy(update={"nodes": NodeLayout.VERTICES})  # 3DEC's
    assert [*left_out(Study, config)] == ["samplings", "campaign", "measured", "structures"]
    del config["dem"]["numerics"]["damping"]
    assert "dem.numerics.damping" in left_out(Study, config)
    assert study.joint("n3") == Joint(3)
    assert {k: o.contact_option() for k, o in study.sidmacib.options.items()} == OPTIONS


def test_sections_have_the_keys_of_what_they_describe_and_changes_have_them_too() -> None:
    numerics = [field.name for field in fields(Numerics)]
    assert [*NumericsSection.model_fields] == [*NumericsChanges.model_fields] == numerics
    assert NumericsSection().numerics() == Numerics()
    extra = {"locks", "first", "different", "inner", "dry", "models", "only"}
    assert {*SampleSection.model_fields} == {*GeometrySection.model_fields, *extra}
    assert [*LockSection.model_fields] == [field.name for field in fields(OwnLock)]
    for changes, section in ((InnerChanges, InnerFaceSection), (DryChanges, DryFaceSection)):
        assert [*changes.model_fields] == [*section.model_fields]


def test_changes_are_held_to_the_same_ranges() -> None:
    for change in ({"tolerance": 0.1}, {"ranks": 1.5}, {"damping": 1}):
        (key,) = change
        for place in (
            {"dem": {"numerics": change}},
            {"variants": {"v": {"numerics": change}}},
            {"overrides": {"n3-mesh0.02-e0a": change}},
        ):
            with pytest.raises(ConfigError, match=rf"\.{key}: .* is not allowed; it must be "):
                read_study(merged(**place))


def test_a_sample_may_have_sizes_of_its_own() -> None:
    study = read_study({"samples": {"n3": {"locks": 3}, "wide": {"locks": 5, "b": 0.08}}})
    assert study.joint("wide") == Joint(5, b=0.08)


def test_another_results_folder_may_be_a_number_or_badly_spelled() -> None:
    assert read_study(merged(results=2024)).results == "2024"
    assert read_study(merged(results="./out//x/")).results == "out/x"


def test_an_even_number_of_locks_is_welcome_without_the_rule_that_needs_an_odd_one() -> None:
    study = read_study({"samples": {"n4": {"locks": 4}}, "sidmacib": {"reductions": ["none"]}})
    assert study.joint("n4").locks == 4


@pytest.mark.parametrize("options", [["option1", "bilinear"], {"option1": None, "bilinear": None}])
def test_a_ready_option_is_taken_by_its_name(options: Any) -> None:
    found = read_study(merged(sidmacib={"options": options})).sidmacib.options
    ready = {name: READY_OPTIONS[name] for name in ("option1", "bilinear")}
    assert {name: option.contact_option() for name, option in found.items()} == ready


# --- faults --------------------------------------------------------------------------------------
DUCTILE: dict[str, Any] = {"assembly": {"failure": "ductile"}}


def differing(locks: dict[Any, Any]) -> dict[str, Any]:
    """A study of a joint whose ``locks`` differ."""
    return {
        "samples": {"n": {"locks": 3, "different": locks}},
        "sidmacib": {"reductions": ["none"]},
    }


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ({}, "samples: missing; it must name at least one, unless structures does"),
        ({"samples": {"n": {}}}, r"samples\.n\.locks: missing; this key is required"),
        (merged(geomtry={}), "geomtry: unknown key; allowed keys: results, samples, .*"),
        (merged(geometry={"A": 1}), "geometry.A: unknown key; allowed keys: a, b, h, H"),
        (
            merged(geometry={"a": -1}),
            r"geometry.a: -1 is not allowed; it must be greater than 0 \(m\)",
        ),
        (
            merged(geometry={"a": "long"}),
            r"geometry.a: 'long' is not a number; it must be a number greater than 0 \(m\)",
        ),
        (
            merged(materials={"inner": {"cohesion": 0}}),
            r"materials.inner.cohesion: 0 is not allowed; it must be greater than 0 \(Pa\)",
        ),
        (
            merged(materials={"dry": {"cohesion": 5}}),
            r"materials.dry.cohesion: 5 is not allowed; it must be 0 \(Pa\)",
        ),
        (
            merged(meshes=[0.06]),
            "meshes: 0.06 m is too coarse for sample n3; it must be less than 0.05 m, "
            "the shorter side of an inner face",
        ),
        (
            merged(variants={"v": {"meshes": [0.06]}}),
            r"variants\.v\.meshes: 0.06 m is too coarse for sample n3; .*",
        ),
        (
            merged(meshes=[0.02, 0.02]),
            "meshes: 0.02 and 0.02 are the same in the names of cases; .* first six digits",
        ),
        (
            merged(variants={"v": {"eccentricities": [0.1, 0.10000001]}}),
            r"variants\.v\.eccentricities: 0.1 and 0.10000001 are the same in .*",
        ),
        (
            merged(eccentricities=["twist"]),
            r"eccentricities.1: 'twist' is not allowed; it must be .* \(e / a\), or torsion",
        ),
        (merged(eccentricities=[-0.1]), r"eccentricities.1: -0.1 is not allowed; .*"),
        (
            {"samples": {"n4": {"locks": 4}}},
            r"samples.n4.locks: 4 is not allowed while sidmacib.reductions has half \(.*\)",
        ),
        (
            {"samples": {"n1": {"locks": 1}}, "models": ["static", "limit"]},
            "samples.n1.locks: 1 is not allowed with limit; it must be at least 2",
        ),
        (
            {"samples": {"n0": {"locks": 0}}},
            "samples.n0.locks: 0 is not allowed; it must be a whole number from 1 to 101",
        ),
        (
            {"samples": {"n": {"locks": 3, "first": "left"}}},
            "samples.n.first: 'left' is not allowed; it must be upper or lower",
        ),
        (
            differing({4: {"width": 0.06}}),
            "samples.n: different: 4 is not allowed; it must be the number of a lock, 1 to 3",
        ),
        (
            differing({"last": {"width": 0.06}}),
            "samples.n.different: 'last' is not a number; it must be a whole number from 1 to 101",
        ),
        (
            differing({"2": {"b": 0.06}}),
            "samples.n.different.2.b: unknown key; allowed keys: width, density, inner",
        ),
        (
            differing({"2": {"inner": {"cohesion": 0}}}),
            r"samples.n.different.2.inner.cohesion: 0 is not allowed; .* greater than 0 \(Pa\)",
        ),
        (
            {**differing({2: {"width": 0.04}}), "meshes": [0.04]},
            "meshes: 0.04 m is too coarse for sample n; it must be less than 0.04 m, .*",
        ),
        (
            {**differing({2: {"width": 0.06}}), "sidmacib": {"reductions": ["half"]}},
            "samples.n.different: a strength from 240 to 288 N is not allowed while "
            r"sidmacib.reductions has half \(.* it must be the same for all\)",
        ),
        (
            {**differing({2: {"inner": {"shear_stiffness": 5e9}}}), **BOTH},
            r"samples.n.different.2.inner.shear_stiffness: 5e\+09 Pa/m is not allowed with "
            r"liggghts; it must be the same as normal_stiffness, 1e\+10 Pa/m",
        ),
        (
            merged(assembly={"hold_down": "rope"}),
            "assembly.hold_down: 'rope' is not allowed; it must be plate, weight, "
            r"{force: a number \(N\)} or {pressure: a number \(Pa\)}",
        ),
        (
            merged(assembly={"hold_down": {"rope": 1, "force": 2}}),
            "assembly.hold_down: a mapping of 'rope', 'force' is not allowed; it must be plate, .*",
        ),
        (
            merged(variants={"v": {"hold_down": {"force": -5}}}),
            r"variants.v.hold_down.force: -5 is not allowed; it must be at least 0 \(N\)",
        ),
        (
            merged(sidmacib={"options": ["option9"]}),
            "sidmacib.options: 'option9' needs positions and portions; without them it must be "
            "one of option1, option2, option3, option4, bilinear",
        ),
        (
            merged(sidmacib={"options": ["bilinear", "bilinear"]}),
            "sidmacib.options: 'bilinear' appears twice; each name must appear only once",
        ),
        (
            merged(dem={"engines": ["3dec"]}),
            f"dem.engines: '3dec' is not allowed; it must be {' or '.join(ENGINES)}",
        ),
        (
            merged(models=["magic", "static"]),
            "models: 'magic' is not allowed; it must be static or limit or law or safe",
        ),
        (
            merged(models=["static", "static"]),
            "models: static appears twice; each name must appear only once",
        ),
        (
            merged(assembly={"failure": "soft"}),
            "assembly.failure: 'soft' is not allowed; it must be brittle, softening or ductile",
        ),
        (
            merged(dem={"numerics": {"tolerance": 0.1}}),
            "dem.numerics.tolerance: 0.1 is not allowed; it must be from 1e-05 to 0.0025",
        ),
        (
            merged(sidmacib={"options": {"o": {"positions": [0.1], "portions": [0.4]}}}),
            "sidmacib.options.o.portions: .* add up to 1",
        ),
        (
            merged(sidmacib={"reductions": ["quarter"]}),
            "sidmacib.reductions.1: 'quarter' is not allowed; it must be one of none, .*",
        ),
        (
            merged(variants={"v": {"failur": "ductile"}}),
            "variants.v.failur: unknown key; allowed keys: pieces, failure, .*",
        ),
        (
            merged(dem={"engines": []}, models=["limit"]),
            "models: limit has no model that follows failure while dem.engines is empty; it "
            "must have static",
        ),
        (
            merged(materials={"inner": {"shear_stiffness": 5e9}}, **BOTH),
            r"materials.inner.shear_stiffness: 5e\+09 Pa/m is not allowed with liggghts; it must "
            r"be the same as normal_stiffness, 1e\+10 Pa/m",
        ),
        (
            {"samples": {"n": {"locks": 3, "inner": {"shear_stiffness": 5e9}}}, **BOTH},
            r"samples.n.inner.shear_stiffness: 5e\+09 Pa/m is not allowed with liggghts; .*",
        ),
        (
            {"samples": {"n": {"locks": 3, "dry": {"cohesion": 1}}}},
            r"samples.n.dry.cohesion: 1 is not allowed; it must be 0 \(Pa\)",
        ),
        (
            {"samples": {"n": {"locks": 3, "models": ["magic"]}}},
            "samples.n.models: 'magic' is not allowed; it must be yade or .* or limit or law .*",
        ),
        (
            {"samples": {"n": {"locks": 3, "models": ["limit"]}}, **BOTH},
            "samples.n.models: limit is not enough; it must have yade or liggghts or static",
        ),
        (
            {"samples": {"n": {"locks": 3, "only": {"law": {}}}}},
            "samples.n.only: 'law' is not allowed; it must be yade or .* or limit",
        ),
        (
            {"samples": {"n": {"locks": 3, "only": {"yade": {"meshes": [0.01]}}}}},
            "samples.n.only.yade.meshes: 0.01 is not allowed; it must be one of meshes: 0.02, .*",
        ),
        (
            {"samples": {"n": {"locks": 3, "only": {"yade": {"variants": ["v"]}}}}},
            "samples.n.only.yade.variants: 'v' is not allowed; .* one of variants: nothing",
        ),
        (
            {
                "samples": {"n": {"locks": 3, "only": {"static": {"eccentricities": [0]}}}},
                "dem": {"engines": []},
            },
            "samples.n.only: static run only parts of the study; one of them must run at all "
            "meshes and .*",
        ),
        (
            merged(
                assembly={"failure": "softening"}, dem={"engines": []}, models=["static", "limit"]
            ),
            "assembly.failure: softening is not allowed with limit; it must be brittle or ductile",
        ),
        (
            merged(**DUCTILE, models=["limit"], **BOTH),
            "assembly.failure: ductile is not allowed with liggghts; it must be brittle",
        ),
        (merged(sidmacib={"options": {}}), "sidmacib.options: an empty mapping is not allowed; .*"),
        (merged(variants={"reference": {}}), "variants: the name reference is reserved; .*"),
        (
            merged(figures={"mesh": 0.03}),
            "figures.mesh: 0.03 m is not allowed; it must be one of meshes: 0.02, 0.005",
        ),
        (
            merged(overrides={"x": {}}),
            "overrides: 'x' is not a case; it must be a case of the study, such as n3-mesh.*",
        ),
        (
            merged(overrides={"n3-mesh0.02-torson": {}}),
            "overrides: 'n3-mesh0.02-torson' is not a case; .*, such as n3-mesh0.02-torsion.*",
        ),
        (
            merged(meshes=0.01),
            "meshes: 0.01 is not allowed; it must be a list",
        ),
        (merged(meshes=[]), "meshes: an empty list is not allowed; .* at least one value"),
        (
            {"samples": {"my-joint": {"locks": 3}}},
            "samples: 'my-joint' is not allowed as a name; it must be made of letters, digits, .*",
        ),
        (
            merged(geometry={"a": 1e-170, "b": 1e-170, "h": 1e-170, "H": 1e-170}, meshes=[5e-171]),
            "samples.n3: .* 0 N, .* must be greater than 0 and finite",
        ),
        (
            merged(calibration={"a": [0.01 + 1e-6 * i for i in range(1000)]}),
            "calibration: 630,000 joints .* are too many; at most 100,000 are allowed",
        ),
    ],
)
def test_a_fault_is_reported_in_one_line_with_key_value_and_what_is_allowed(
    config: dict[str, Any], message: str
) -> None:
    with pytest.raises(ConfigError, match=f"^{message}$") as error:
        cases_of(read_study(config))
    assert len(str(error.value).splitlines()) == 1


def test_all_faults_are_reported_at_once() -> None:
    with pytest.raises(ConfigError) as error:
        read_study(merged(meshes=[0.06], models=["magic"], figures={"mesh": 0.03}))
    keys = [line.split(":")[0] for line in error.value.args]
    assert keys == ["meshes", "models", "figures.mesh"]


@given(
    mesh=st.floats(0.004, 0.03),
    locks=st.integers(2, 6),
    h=st.floats(0.001, 0.1),
    layout=st.sampled_from(NodeLayout),
    body=st.sampled_from(UpperBody),
    width=st.floats(0.04, 0.2),
)
def test_the_estimate_of_nodes_is_never_low_and_of_the_right_order(
    mesh: float, layout: NodeLayout, locks: int, h: float, body: UpperBody, width: float
) -> None:
    joint = Joint(locks, h=h, upper_body=body, different={1: OwnLock(width=width)})
    nodes = len(assemble(joint, mesh, layout).nodes.face)
    assert nodes <= node_estimate(joint, mesh, layout) < 8 * nodes


# --- engines -------------------------------------------------------------------------------------
def test_an_engine_that_is_not_installed_is_left_out_and_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    study = read_study(ONE)
    assert with_installed_engines(study) == study
    assert study.dem.engines == DISTINCT
    monkeypatch.setenv("PATH", "")
    assert with_installed_engines(study).dem.engines == ()
    assert "yade: not installed; on Debian: apt-get install yade" in capsys.readouterr().err


def test_what_an_engine_takes_no_notice_of_is_noted_where_a_study_changes_it() -> None:
    assert notes(read_study(ONE)) == []
    config = merged(
        dem={**BOTH["dem"], "numerics": {"ranks": 4}},
        variants={"soft": {"numerics": {"damping": 0.3}}, "same": {"numerics": {"damping": 0.4}}},
        overrides={"n3-mesh0.02-e0a": {"damping": 0.2}},
    )
    assert notes(read_study(config)) == [
        "dem.numerics.ranks: no effect in yade",
        "variants.soft.numerics.damping: no effect in liggghts",
        "overrides.n3-mesh0.02-e0a.damping: no effect in liggghts",
    ]
    assert notes(read_study({**config, "dem": {"engines": []}})) == []


# --- parts ---------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "config",
    [
        {"samples": {"n": {"locks": 4}}, "sidmacib": {"reductions": ["none"]}},
        merged(**DUCTILE, models=["limit"], dem={"engines": ["yade"]}),
        merged(materials={"inner": {"shear_stiffness": 5e9}}, dem={"engines": []}),
        {"samples": {"n": {"locks": 3, "b": 0.02}}, "meshes": [0.005]},
        differing({2: {"width": 0.06, "inner": {"cohesion": 1e5}}}),
        merged(assembly={"hold_down": {"pressure": 1e5}}, sidmacib={"options": ["bilinear"]}),
        merged(variants={"v": {"upper_body": "monolithic", "eccentricities": ["torsion"]}}),
    ],
)
def test_the_parts_that_steps_get_are_valid_studies_too(config: dict[str, Any]) -> None:
    study = read_study(config)
    for part in ("tables", "pieces", "figures", "calibration"):
        again = Study.model_validate_json(getattr(study, f"{part}_json")())
        assert (again.assembly, again.samples) == (study.assembly, study.samples)
        assert again.eccentricities == study.eccentricities
    assert read_study(json.loads(study.model_dump_json())) == study


def test_a_part_does_not_change_with_what_it_leaves_out() -> None:
    study = read_study(ONE)
    other = read_study(merged(figures={"eccentricity": 1}, calibration={"confirmed": 1}))
    slow = read_study(merged(dem={"numerics": {"ramp_periods": 80}, "time_limit": 5}))
    assert other.tables_json() == slow.tables_json() == study.tables_json()
    assert other.pieces_json() == slow.pieces_json() == study.pieces_json()
    assert other.figures_json() != study.figures_json() == slow.figures_json()
    assert read_study(merged(figures={"eccentricity": 1})).calibration_json() == (
        study.calibration_json()
    )


def test_a_campaign_that_lacks_a_section_it_requires_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"^campaign: locks needs samplings$"):
        read_study(merged(campaign="locks"))
