"""The cluster resources that a job requests, and jobs that the cluster kills."""

import os
from pathlib import Path

import pytest
import yaml
from conftest import ROOT, a_case

from sidmacib.engines.engine import FOREIGN, engine_environment
from sidmacib.engines.run import EngineKilledError
from sidmacib.engines.scripts.records import RESULT
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading
from workflow import engine as engine_step
from workflow.case import JointCase
from workflow.command import profile_named
from workflow.configuration import ConfigError
from workflow.jobs import engine_resources, nodes_of, solved_resources
from workflow.results import RECORD
from workflow.step import KilledError


def case_on(mesh: float) -> JointCase:
    return a_case("yade", Joint(locks=3), Loading(Direction(0.0)), mesh)


def test_more_nodes_ask_for_more() -> None:
    coarse, fine = case_on(mesh=0.02), case_on(mesh=0.005)
    assert nodes_of(fine.subject) > 5 * nodes_of(coarse.subject)
    for one, other in (
        (engine_resources(coarse, 3600), engine_resources(fine, 3600)),
        (solved_resources([coarse]), solved_resources([fine])),
    ):
        assert one.time < other.time
        assert one.memory <= other.memory


def test_an_engine_asks_for_no_more_than_its_own_time_limit() -> None:
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
