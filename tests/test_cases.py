"""The cases of a study: which there are, their names, and that they survive being written."""

import json
import math
import time
from dataclasses import replace
from typing import Any

import pytest
import yaml
from conftest import ROOT, with_subject
from hypothesis import given
from hypothesis import strategies as st
from small import BOTH, ONE, merged

from sidmacib.engines import Numerics
from sidmacib.joint import DRY, Direction, HoldDown, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Loading, LoadShare, Push
from sidmacib.mechanics.assembly import Failure, NodeLayout
from sidmacib.models import SOLVED
from workflow.case import Case, JointCase, JointSubject
from workflow.cases import case_count, cases_of, find_case
from workflow.configuration import ConfigError, read_study


# --- which there are -----------------------------------------------------------------------------
def test_the_papers_study_has_every_sample_mesh_and_direction() -> None:
    study = read_study(yaml.safe_load((ROOT / "config.yaml").read_text()))
    reference = [case for case in cases_of(study).values() if case.variant == "reference"]
    printed = [case for case in reference if case.subject.sample in ("n3", "n5")]
    assert len(printed) == 4 * 2 * 2 * 9
    assert {case.model for case in printed} == {"yade", "liggghts", "static", "limit"}
    fitted = [case for case in reference if case.subject.sample in ("n3_fits", "n5_fits")]
    assert len(fitted) == len(reference) - len(printed) == 3 * 2 * 2 * 9 + 2 * 2 * 2
    partly = [case for case in fitted if case.model == "liggghts"]
    assert {case.subject.direction.eccentricity for case in partly} == {0, 0.5}
    assert {case.model for case in fitted} == {"yade", "liggghts", "static", "limit"}
    assert {case.subject.joint.dry.friction for case in fitted} == {0.005236}
    assert {case.subject.joint.dry.friction for case in printed} == {0.3}
    directions = {0, 0.05, 0.1, 0.2, 0.35, 0.5, 1, 2, math.inf}
    assert {case.subject.direction.eccentricity for case in reference} == directions


def test_a_direction_is_carried_exactly_as_configured_whatever_the_locks_length() -> None:
    ratios = [0.1, 1 / 3, 0.30000000000000004]
    samples = {"long": {"locks": 3, "a": 0.07}, "short": {"locks": 3, "a": 0.03}}
    config = {"samples": samples, "eccentricities": ratios, "meshes": [0.02]}
    cases = cases_of(read_study(config)).values()
    for sample in samples:
        selected = [c for c in cases if c.subject.sample == sample and c.model == "yade"]
        assert [case.subject.direction.eccentricity for case in selected] == ratios
        expected = [ratio * samples[sample]["a"] for ratio in ratios]
        assert [case.subject.eccentricity_m for case in selected] == expected


def test_a_variant_changes_what_it_names_where_it_says() -> None:
    variants = {"soft": {"failure": "ductile", "meshes": [0.02], "eccentricities": [0]}}
    cases = cases_of(read_study(merged(variants=variants, **BOTH)))
    assert {key for key, case in cases.items() if case.variant == "soft"} == {
        (model, "n3-mesh0.02-e0a-soft")
        for model in ("yade", "static", "limit")  # liggghts knows brittle faces only
    } | {(model, "n3-mesh0.01-e0a-soft") for model in ("static", "limit")}  # for the mesh error
    soft = cases["yade", "n3-mesh0.02-e0a-soft"]
    whole = cases["yade", "n3-mesh0.02-e0a"]
    ductile = replace(whole.subject.joint, failure=Failure.DUCTILE)
    assert soft == replace(with_subject(whole, joint=ductile), name=soft.name, variant="soft")


def test_where_there_is_one_mesh_the_quick_models_run_at_half_of_it_too() -> None:
    study = read_study(merged(meshes=[0.02], eccentricities=[0]))
    found = {(model, case.subject.mesh) for (model, _), case in cases_of(study).items()}
    engines = {(engine, 0.02) for engine in study.dem.engines}
    assert found == engines | {(model, mesh) for model in SOLVED for mesh in (0.02, 0.01)}
    assert case_count(study) == len(cases_of(study))


def test_a_model_runs_a_part_of_a_sample_and_the_reference_variant_always() -> None:
    only = {
        "yade": {"variants": []},
        "liggghts": {"meshes": [0.02], "eccentricities": [0], "variants": ["half"]},
    }
    study = read_study(
        {
            "samples": {"n3": {"locks": 3, "only": only}},
            "eccentricities": [0, 0.5],
            "variants": {"half": {"numerics": {"ramp_periods": 80}, "meshes": [0.02]}},
        }
    )
    cases = cases_of(study)
    found = {model: [n for m, n in cases if m == model] for model in ("yade", "liggghts")}
    assert found["liggghts"] == ["n3-mesh0.02-e0a", "n3-mesh0.02-e0a-half"]
    assert found["yade"] == [f"n3-mesh{mesh}-e{e}a" for mesh in (0.02, 0.005) for e in (0, 0.5)]
    assert case_count(study) == len(cases)
    whole = study.models_of_whole("n3")
    assert "yade" in whole
    assert "liggghts" not in whole


def test_a_sample_has_faces_of_its_own_and_models_that_can_run_them() -> None:
    faces = {"dry": {"friction": 0.01}, "inner": {"shear_stiffness": 5e9}}  # not for liggghts
    own = {"locks": 3, **faces, "models": ["static", "yade"]}
    study = read_study({**BOTH, "samples": {**ONE["samples"], "own": own}, "eccentricities": [0]})
    cases = cases_of(study)
    models = {model for (model, _), case in cases.items() if case.subject.sample == "own"}
    assert models == {"static", "yade"}
    changed, plain = cases["static", "own-mesh0.02-e0a"].subject.joint, study.joint("n3")
    assert changed.dry == replace(plain.dry, friction=0.01)
    assert changed.inner == replace(plain.inner, shear_stiffness=5e9)
    assert case_count(study) == len(cases) == 2 * (4 + 2)


def test_a_case_is_found_by_its_name_and_others_are_refused_in_one_line() -> None:
    study = read_study(merged(dem={"engines": []}))
    assert find_case(study, "n3-mesh0.02-e0a").model == "static"
    assert find_case(study, "n3-mesh0.02-e0a", "limit").model == "limit"
    words = r"^MODEL: 'yade' is not allowed; .* static or limit or law .*"
    with pytest.raises(ConfigError, match=words):
        find_case(study, "n3-mesh0.02-e0a", "yade")
    words = r"^CASE: 'n3-mesh0.2-e0a' is not a case of static; it must"
    with pytest.raises(ConfigError, match=words):
        find_case(study, "n3-mesh0.2-e0a")


@pytest.mark.parametrize(
    ("spelled", "meant"),
    [
        ("plate", HoldDown()),
        ("weight", HoldDown.weight()),
        ({"force": 500}, HoldDown.force(500.0)),
        ({"pressure": "1e5"}, HoldDown.pressure(1e5)),
    ],
)
def test_what_holds_a_joint_down_is_set_in_study_or_variant(spelled: Any, meant: HoldDown) -> None:
    study = read_study(merged(assembly={"hold_down": spelled}))
    assert {case.subject.joint.hold_down for case in cases_of(study).values()} == {meant}
    assert read_study(json.loads(study.model_dump_json())) == study
    other = read_study(merged(variants={"v": {"hold_down": spelled, "eccentricities": [0]}}))
    hold_downs = {c.subject.joint.hold_down for c in cases_of(other).values() if c.variant == "v"}
    assert hold_downs == {meant}


# --- names and identity --------------------------------------------------------------------------
def test_a_key_is_the_same_for_all_models_and_variants_and_apart_from_others() -> None:
    variants = {"body": {"load_share": "body"}}
    cases = [*cases_of(read_study(merged(variants=variants))).values()]
    subjects = [case.subject for case in cases]
    places = {(each.key, each.sample, each.mesh, each.direction) for each in subjects}
    assert len(places) == len({case.subject.key for case in cases}) == 2 * 9
    assert all(case.name == case.subject.key for case in cases if case.variant == "reference")
    assert all(c.name == f"{c.subject.key}-body" for c in cases if c.variant == "body")


def test_the_digest_covers_what_the_results_depend_on_and_nothing_else() -> None:
    cases = cases_of(read_study(ONE))
    case = cases["yade", "n3-mesh0.02-e0a"]
    assert replace(with_subject(case, sample="y"), name="x", variant="z").digest() == case.digest()
    others = [
        replace(case, model="liggghts"),
        with_subject(case, joint=replace(case.subject.joint, h=case.subject.joint.h * (1 + 1e-15))),
        with_subject(case, joint=replace(case.subject.joint, first=Side.LOWER)),
        with_subject(case, joint=replace(case.subject.joint, different={2: OwnLock(density=1.0)})),
        with_subject(case, joint=replace(case.subject.joint, hold_down=HoldDown.weight())),
        with_subject(case, mesh=0.021),
        with_subject(case, loading=Loading(Direction(1e-12))),
        with_subject(case, loading=replace(case.subject.loading, push=Push.MINUS_Y)),
        replace(case, numerics=replace(case.numerics, damping=0.3)),
        replace(case, numerics=None),
    ]
    assert len({other.digest() for other in [case, *others]}) == 1 + len(others)
    assert len({case.digest() for case in cases.values()}) == len(cases)


# --- written and read ----------------------------------------------------------------------------
SIZE = st.floats(1e-300, 1e300)


@given(
    joint=st.builds(
        Joint,
        locks=st.integers(2, 101),
        **dict.fromkeys(("a", "b", "h", "H", "density"), SIZE),
        failure=st.sampled_from(Failure),
        upper_body=st.sampled_from(UpperBody),
        first=st.sampled_from(Side),
        different=st.dictionaries(
            st.integers(1, 2),
            st.builds(OwnLock, st.none() | SIZE, st.none() | SIZE, st.none() | st.just(DRY)),
        ),
        hold_down=st.one_of(st.just(HoldDown()), st.builds(HoldDown.pressure, SIZE)),
    ),
    mesh=SIZE,
    loading=st.builds(
        Loading,
        st.builds(Direction, st.floats(allow_nan=False)),
        st.sampled_from(LoadShare),
        st.sampled_from(Push),
    ),
    numerics=st.one_of(st.none(), st.builds(Numerics, tolerance=SIZE)),
)
def test_a_case_survives_json_exactly(
    joint: Joint, mesh: float, loading: Loading, numerics: Numerics | None
) -> None:
    subject = JointSubject("s", joint, mesh, NodeLayout.CENTRES, loading)
    case = Case("n", "yade", "reference", subject, numerics)
    again = JointCase.from_json(case.to_json())
    assert again == case
    assert again.digest() == case.digest()
    assert type(again.subject.loading.push) is Push
    json.loads(case.to_json(), parse_constant=pytest.fail)  # what other readers know as JSON


# --- many ----------------------------------------------------------------------------------------
def many(samples: int, ratios: int) -> dict[str, Any]:
    return {
        "samples": {f"s{i}": {"locks": 3, "a": 0.05 + 1e-4 * i} for i in range(samples)},
        "meshes": [0.02, 0.01],
        "eccentricities": [0.001 * i for i in range(ratios)],
        "models": ["static"],
        "dem": {"engines": []},
    }


def test_ten_thousand_cases_are_built_at_once_and_share_their_joints() -> None:
    study = read_study(many(10, 500))
    start = time.process_time()
    cases = cases_of(study)
    assert time.process_time() - start < 2.0
    assert len(cases) == case_count(study) == 10_000
    assert len({id(case.subject.joint) for case in cases.values()}) == 10


def test_more_cases_than_can_be_handled_are_refused_before_they_are_built() -> None:
    study = read_study(many(1001, 500))
    start = time.process_time()
    words = r"^study: 1,001,000 cases .* are too many; at most 1,000,000 are allowed$"
    with pytest.raises(ConfigError, match=words):
        cases_of(study)
    assert time.process_time() - start < 2.0
