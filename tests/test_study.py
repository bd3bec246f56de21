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
from joints import sawn
from small import BOTH, ONE, merged

from sidmacib import OPTIONS, READY_OPTIONS, NodeLayout, OwnLock, UpperBody, assemble
from sidmacib.engines import Numerics
from sidmacib.reading import Section
from workflow.cases import cases_of
from workflow.configuration import ConfigError, read_study, with_installed_engines
from workflow.consistency import node_estimate, notes
from workflow.schema import Study
from workflow.schema.sections import (
    DryChanges,
    DryFaceSection,
    GeometrySection,
    InnerChanges,
    InnerFaceSection,
    LockSection,
    NumericsChanges,
    NumericsSection,
    SampleSection,
)


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
    cut = default.assembly.model_copy(update={"upper_body": UpperBody.COLUMNS})
    as_published = {"nodes": NodeLayout.VERTICES, "assembly": cut}  # 3DEC's
    assert study == default.model_copy(update=as_published)
    assert [*left_out(Study, config)] == [
        "samplings",
        "campaign",
        "measured",
        "demand",
        "structures",
        "earthquakes",
    ]
    del config["dem"]["numerics"]["damping"]
    assert "dem.numerics.damping" in left_out(Study, config)
    assert study.joint("n3") == sawn(3)
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


@pytest.mark.parametrize("options", [["option1", "bilinear"], {"option1": None, "bilinear": None}])
def test_a_ready_option_is_taken_by_its_name(options: Any) -> None:
    found = read_study(merged(sidmacib={"options": options})).sidmacib.options
    ready = {name: READY_OPTIONS[name] for name in ("option1", "bilinear")}
    assert {name: option.contact_option() for name, option in found.items()} == ready


# --- faults --------------------------------------------------------------------------------------
DUCTILE: dict[str, Any] = {"assembly": {"failure": "ductile"}}


DIFFER = {"locks": 3, "different": {2: {"width": 0.06, "inner": {"cohesion": 1e5}}}}
REFUSED = yaml.safe_load((ROOT / "tests/cases/refused_studies.yaml").read_text())


@pytest.mark.parametrize("refused", REFUSED, ids=lambda each: each["says"][:60])
def test_a_fault_is_one_line_with_key_value_and_what_is_allowed(refused: dict[str, Any]) -> None:
    with pytest.raises(ConfigError, match=f"^{refused['says']}$") as error:
        cases_of(read_study(refused["study"]))
    assert len(str(error.value).splitlines()) == 1
    assert len(str(error.value)) < 400


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
    joint = sawn(locks, h=h, upper_body=body, different={1: OwnLock(width=width)})
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
        {"samples": {"n": DIFFER}, "sidmacib": {"reductions": ["none"]}},
        merged(assembly={"hold_down": {"pressure": 1e5}}, sidmacib={"options": ["bilinear"]}),
        merged(variants={"v": {"upper_body": "monolithic", "eccentricities": ["torsion"]}}),
    ],
)
def test_the_parts_that_steps_get_are_valid_studies_too(config: dict[str, Any]) -> None:
    study = read_study(config)
    for sections in ((), ("variants",), ("variants", "figures", "measured")):
        again = Study.model_validate_json(study.part(*sections))
        assert (again.assembly, again.samples) == (study.assembly, study.samples)
        assert again.eccentricities == study.eccentricities
    assert read_study(json.loads(study.model_dump_json())) == study


def test_a_part_does_not_change_with_what_it_leaves_out() -> None:
    study = read_study(ONE)
    other = read_study(merged(figures={"eccentricity": 1}, calibration={"confirmed": 1}))
    slow = read_study(merged(dem={"numerics": {"ramp_periods": 80}, "time_limit": 5}))
    assert other.part() == slow.part() == study.part()
    assert other.part("variants") == slow.part("variants") == study.part("variants")
    assert other.part("figures") != study.part("figures") == slow.part("figures")
