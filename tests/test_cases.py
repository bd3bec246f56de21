"""The cases of a study: which there are, their names, and that they survive being written."""

import json
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from conftest import ROOT, a_case, with_subject
from hypothesis import given
from hypothesis import strategies as st
from joints import sawn
from small import BOTH, COARSE, ONE, merged

from sidmacib.engines import FOREIGN, Numerics, engine_environment
from sidmacib.engines.run import EngineKilledError
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint import DRY, Direction, HoldDown, Joint, OwnLock, Side, UpperBody
from sidmacib.joint.loading import Loading, LoadShare, Push
from sidmacib.mechanics.assembly import Failure, NodeLayout
from sidmacib.models import SOLVED
from workflow import engine as engine_step
from workflow.__main__ import forget_failures
from workflow.case import Case, JointCase, JointSubject
from workflow.cases import case_count, cases_of, find_case
from workflow.command import lock, profile_named
from workflow.configuration import CallError, ConfigError, read_study, read_study_file
from workflow.jobs import (
    BATCH,
    BATCH_TIME,
    batches,
    case_jobs,
    engine_resources,
    nodes_of,
    solved_resources,
)
from workflow.results import BROKE_DOWN, RECORD, record_without_result
from workflow.step import KilledError

# --- which there are -----------------------------------------------------------------------------


def test_a_variant_changes_what_it_names_where_it_says() -> None:
    variants = {"soft": {"failure": "ductile", "meshes": [0.02], "eccentricities": [0]}}
    cases = cases_of(read_study(merged(variants=variants, **BOTH)))
    assert {key for key, case in cases.items() if case.variant == "soft"} == {
        f"cases/{model}/n3-mesh0.02-e0a-soft"
        for model in ("yade", "static", "limit")  # liggghts knows brittle faces only
    } | {
        f"cases/{model}/n3-mesh0.01-e0a-soft" for model in ("static", "limit")
    }  # for the mesh error
    soft = cases["cases/yade/n3-mesh0.02-e0a-soft"]
    whole = cases["cases/yade/n3-mesh0.02-e0a"]
    ductile = replace(whole.subject.joint, failure=Failure.DUCTILE)
    assert soft == replace(with_subject(whole, joint=ductile), name=soft.name, variant="soft")


def test_where_there_is_one_mesh_the_quick_models_run_at_half_of_it_too() -> None:
    study = read_study(merged(meshes=[0.02], eccentricities=[0]))
    found = {(case.model, case.subject.mesh) for case in cases_of(study).values()}
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
    found = {
        model: [case.name for case in cases.values() if case.model == model]
        for model in ("yade", "liggghts")
    }
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
    models = {case.model for case in cases.values() if case.subject.sample == "own"}
    assert models == {"static", "yade"}
    changed, plain = cases["cases/static/own-mesh0.02-e0a"].subject.joint, study.joint("n3")
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
    case = cases["cases/yade/n3-mesh0.02-e0a"]
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


def test_many_cases_are_built_at_once_and_too_many_are_refused_before() -> None:
    config = {"meshes": [0.02, 0.01], "models": ["static"], "dem": {"engines": []}}
    config["eccentricities"] = [0.001 * i for i in range(500)]
    few, many = (
        read_study(
            config | {"samples": {f"s{i}": {"locks": 3, "a": 0.05 + 1e-4 * i} for i in part}}
        )
        for part in (range(10), range(1001))
    )
    start = time.process_time()
    cases = cases_of(few)
    words = r"^study: 1,001,000 cases .* are too many; at most 1,000,000 are allowed$"
    with pytest.raises(ConfigError, match=words):
        cases_of(many)
    assert time.process_time() - start < 2.0
    assert len(cases) == case_count(few) == 10_000
    assert len({id(case.subject.joint) for case in cases.values()}) == 10  # which they share


# --- batches and jobs, what they ask of a cluster, one run at a time -----------------------------
def test_every_case_is_in_one_batch_and_batches_have_the_size_that_is_asked_for() -> None:
    config = {**COARSE, "eccentricities": [round(0.001 * n, 3) for n in range(1500)]}
    cases = list(cases_of(read_study(config)).values())
    found = batches(cases)
    assert sorted(c.name for b in found.values() for c in b) == sorted(c.name for c in cases)
    assert max(map(len, found.values())) <= BATCH
    assert len(found) == 8
    assert BATCH / 2 < len(cases) / len(found) <= BATCH


def test_cases_that_take_long_are_in_small_batches() -> None:
    found = batches(list(cases_of(read_study_file(ROOT / "studies/elastic/config.yaml")).values()))
    times = [solved_resources(cases).time for cases in found.values()]
    assert BATCH_TIME / 2 < np.mean(times) <= BATCH_TIME
    assert sum(map(len, found.values())) > 500


def test_a_case_that_is_added_stays_out_of_the_other_batches() -> None:
    ratios = [round(0.001 * n, 3) for n in range(500)]
    one, two = (
        batches(list(cases_of(read_study({**COARSE, "eccentricities": values})).values()))
        for values in (ratios, [*ratios, 7.0])
    )
    changed = [name for name in two if two[name] != one.get(name)]
    assert len(changed) <= 2  # of the case, and of the one at half its mesh


def test_engines_cases_are_held_against_the_static_model_even_if_no_one_asked() -> None:
    config = {**COARSE, "models": ["limit"], "dem": {"engines": ["yade"]}, "eccentricities": [0]}
    jobs = case_jobs(read_study(config))
    names = [case.name for case in jobs.batches["cases/static/batch"]]
    assert names == ["n3-mesh0.03-e0a", "n3-mesh0.015-e0a"]  # for the mesh error
    assert {case.model for case in jobs.joints.values()} == {"yade", "limit"}


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_lives(tmp_path: Path) -> None:
    first = lock(tmp_path)
    with pytest.raises(CallError, match=r"another run is using this folder \(process \d+\)"):
        lock(tmp_path)
    first.close()
    lock(tmp_path).close()


@pytest.mark.parametrize(
    ("error", "each_time", "on_request"),
    [(None, False, False), ("yade: no answer: it drifts", False, True), ("exit 7", True, True)],
)
def test_an_engine_that_broke_down_is_tried_again_and_one_without_an_answer_on_request(
    tmp_path: Path, error: str | None, each_time: bool, on_request: bool
) -> None:
    case = case_on(mesh=0.02)
    path = tmp_path / case.folder / RECORD
    path.parent.mkdir(parents=True)
    for every, gone in ((False, each_time), (True, on_request)):
        path.write_text(record_without_result(case, error=error).to_json() + "\n")
        if each_time:  # as its step leaves it
            path.with_name(BROKE_DOWN).touch()
        forget_failures(tmp_path, every=every)
        assert path.exists() is not gone


def test_records_of_other_cases_and_damaged_ones_are_made_again(tmp_path: Path) -> None:
    case = case_on(mesh=0.02)
    other = replace(case, name="other")
    text = record_without_result(case).to_json() + "\n"
    for place, content, kept in (
        (case, text, True),
        (other, text, False),
        (case, text.replace('"kind"', '"k\0nd"'), False),
        (case, text[:-20], False),
        (case, "", False),
    ):
        path = tmp_path / place.folder / RECORD
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
        forget_failures(tmp_path, every=False)
        assert path.exists() is kept
        path.unlink(missing_ok=True)


def case_on(mesh: float) -> JointCase:
    return a_case("yade", sawn(locks=3), Loading(Direction(0.0)), mesh)


def test_more_nodes_ask_for_more_but_no_longer_than_the_time_limit_of_the_engine() -> None:
    coarse, fine = case_on(mesh=0.02), case_on(mesh=0.005)
    assert nodes_of(fine.subject) > 5 * nodes_of(coarse.subject)
    for one, other in (
        (engine_resources(coarse, 3600), engine_resources(fine, 3600)),
        (solved_resources([coarse]), solved_resources([fine])),
    ):
        assert one.time < other.time
        assert one.memory <= other.memory
    assert engine_resources(case_on(mesh=0.001), 60).time == 60


def test_the_profile_tries_as_often_as_jobs_expect() -> None:
    profile = yaml.safe_load((ROOT / "profiles/slurm/config.yaml").read_text())
    rules = (ROOT / "workflow/rules/common.smk").read_text()
    assert f"RETRIES = {profile['retries']} " in rules
    assert profile_named("slurm") == ["--profile", str(ROOT / "profiles/slurm")]
    assert profile_named("") == []
    with pytest.raises(ConfigError, match="PROFILE: 'slrum' is not allowed; it must be"):
        profile_named("slrum")


def test_an_engine_that_lacked_memory_has_no_result_while_there_are_tries(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def killed(*_: object) -> None:
        raise EngineKilledError("killed by signal 9; end of engine.log:")

    monkeypatch.setattr(engine_step, "engine_outcome", killed)
    outputs = {"record": tmp_path / RECORD, "result": tmp_path / RESULT}
    case = case_on(mesh=0.02)
    arguments = {"case": case.to_json(), "time_limit": 60, "last_try": 0}
    with pytest.raises(KilledError, match="killed by signal 9"):
        engine_step.run(arguments, {}, outputs)
    assert not any(path.exists() for path in outputs.values())
    arguments["last_try"] = 1
    assert "killed" in str(engine_step.run(arguments, {}, outputs))
    assert all(path.exists() for path in outputs.values())


def test_engines_do_not_see_the_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SLURM_JOB_ID", "1")
    monkeypatch.setenv("PMI_RANK", "0")
    environment = engine_environment(OMP_NUM_THREADS="1")
    assert not [name for name in environment if name.startswith(FOREIGN)]
    assert environment["OMP_NUM_THREADS"] == "1"
    assert environment["PATH"] == os.environ["PATH"]
