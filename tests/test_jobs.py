"""The cases of a study in batches and jobs, what jobs ask of a cluster, one run at a time."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
import yaml
from conftest import ROOT, a_case
from small import COARSE

from sidmacib import Direction, Joint, Loading
from sidmacib.engines import FOREIGN, engine_environment
from sidmacib.engines.run import EngineKilledError
from sidmacib.engines.scripts.records import RESULT
from workflow import engine as engine_step
from workflow.__main__ import forget_failures
from workflow.case import JointCase
from workflow.cases import cases_of
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
from workflow.results import BROKE_DOWN, RECORD
from workflow.step import KilledError


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
    path = tmp_path / "cases/yade/one/record.json"
    path.parent.mkdir(parents=True)
    for every, gone in ((False, each_time), (True, on_request)):
        path.write_text(json.dumps({"error": error}) + "\n")
        if each_time:  # as its step leaves it
            path.with_name(BROKE_DOWN).touch()
        forget_failures(tmp_path, every=every)
        assert path.exists() is not gone


def case_on(mesh: float) -> JointCase:
    return a_case("yade", Joint(locks=3), Loading(Direction(0.0)), mesh)


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
