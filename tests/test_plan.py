"""Which cases a study has, how they are put into batches, and one run at a time."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from workflow.__main__ import forget_failures
from workflow.cases import cases_of
from workflow.command import lock
from workflow.configuration import CallError, read_study, read_study_file
from workflow.jobs import BATCH, BATCH_TIME, batches, case_jobs, solved_resources
from workflow.results import BROKE_DOWN

SMALL = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.03],
    "eccentricities": [0, 0.5],
    "dem": {"engines": []},
    "models": ["static"],
}


def test_every_case_is_in_one_batch_and_batches_have_the_size_that_is_asked_for() -> None:
    config = {**SMALL, "eccentricities": [round(0.001 * n, 3) for n in range(1500)]}
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
        batches(list(cases_of(read_study({**SMALL, "eccentricities": values})).values()))
        for values in (ratios, [*ratios, 7.0])
    )
    changed = [name for name in two if two[name] != one.get(name)]
    assert len(changed) <= 2  # of the case, and of the one at half its mesh


def test_engines_cases_are_held_against_the_static_model_even_if_no_one_asked() -> None:
    config = {**SMALL, "models": ["limit"], "dem": {"engines": ["yade"]}, "eccentricities": [0]}
    jobs = case_jobs(read_study(config))
    assert [case.name for case in jobs.batches["cases/static/batch"]] == [
        "n3-mesh0.03-e0a",
        "n3-mesh0.015-e0a",  # for the mesh error
    ]
    assert {case.model for case in jobs.joints.values()} == {"yade", "limit"}


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_one_lives(
    tmp_path: Path,
) -> None:
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
