"""Jobs, their receipts, and what has to be done again."""

import json
import os
import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

from workflow.configuration import read_study, read_study_file
from workflow.engines.execute import EngineError, EngineNoAnswerError
from workflow.engines.scripts.assembly import Guide
from workflow.joints.case import Case
from workflow.joints.problem import problem_of
from workflow.planning.batches import BATCH, BATCH_TIME, batches
from workflow.planning.cases import cases_of
from workflow.planning.plan import Job, prepared
from workflow.planning.receipts import STALE, fault, read_receipt, write_receipt
from workflow.planning.resources import solved_resources
from workflow.planning.results_folder import LockedError, lock
from workflow.planning.snakefile import plan_of
from workflow.run.job import run_job
from workflow.schema import Study
from workflow.steps import guides as guides_step
from workflow.steps.engine import find_guide

SMALL = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.03],
    "eccentricities": [0, 0.5],
    "dem": {"engines": []},
    "models": ["static"],
}


@pytest.fixture
def study(tmp_path: Path) -> Study:
    return read_study({**SMALL, "results": str(tmp_path)})


@pytest.fixture
def done(study: Study, tmp_path: Path) -> Job:
    """The batch of the study, done."""
    job = plan_of(study).jobs["static/batch"]
    run_job(json.loads(json.dumps(job.plan(job.digest(), tmp_path))))
    return job


def reason(job: Job, results: Path) -> str | None:
    return fault(
        read_receipt(results / job.receipt), job.name, job.digest(), results, job.receipted
    )


def test_what_was_made_holds(done: Job, tmp_path: Path) -> None:
    assert reason(done, tmp_path) is None


def test_moving_the_results_changes_nothing(done: Job, tmp_path: Path) -> None:
    moved = tmp_path.with_name("moved")
    shutil.copytree(tmp_path, moved)
    assert reason(done, moved) is None


@pytest.mark.parametrize("number", range(3))
def test_an_output_that_is_deleted_edited_or_cut_is_noticed(
    done: Job, tmp_path: Path, number: int
) -> None:
    path = tmp_path / done.written[number]
    whole = path.read_bytes()
    path.unlink()
    assert reason(done, tmp_path) == f"{done.written[number]} is gone"
    for content in (whole[:-1], whole + b"\n", b""):
        path.write_bytes(content)
        assert reason(done, tmp_path) == f"{done.written[number]} was changed"
    path.write_bytes(whole)
    assert reason(done, tmp_path) is None


def test_a_receipt_that_is_lost_garbled_or_anothers_does_not_count(
    done: Job, tmp_path: Path
) -> None:
    path = tmp_path / done.receipt
    text = path.read_text()
    for garbled in ("", "{", "[]", "null", '{"job": 1}', text.replace("static/", "limit/")):
        path.write_text(garbled)
        assert reason(done, tmp_path) in ("never made", "made by another job")
    path.unlink()
    assert reason(done, tmp_path) == "never made"


@pytest.mark.parametrize("number", [0, 2])
def test_a_receipt_that_names_too_few_or_too_many_files_does_not_count(
    done: Job, tmp_path: Path, number: int
) -> None:
    path = tmp_path / done.receipt
    receipt = json.loads(path.read_text())
    some = dict([*receipt["outputs"].items()][:number])
    for outputs in (
        some,
        receipt["outputs"] | {"\0": "x"},
        receipt["outputs"] | {"/dev/zero": "x"},
    ):
        path.write_text(json.dumps({**receipt, "outputs": outputs}))
        (tmp_path / done.written[2]).write_text("forged")
        assert reason(done, tmp_path) == "a receipt of other files"
    path.write_text("[" * 100_000)
    assert reason(done, tmp_path) == "never made"


def in_place_of(path: Path, kind: str, target: Path) -> None:
    """Put something that is no file where a file is."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
        (path / "mine").write_text("mine")
    else:
        path.symlink_to("/dev/zero" if kind == "device" else target)


@pytest.mark.parametrize("kind", ["pipe", "device", "link", "folder"])
@pytest.mark.parametrize("what", ["output", "receipt", "log", "plan", "index", "mark", "times"])
def test_what_is_no_file_makes_way_with_a_line_and_the_job_is_done_again(
    done: Job, tmp_path: Path, kind: str, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {
        "output": done.written[1],
        "receipt": done.receipt,
        "log": f"logs/{done.name}.log",
        "plan": str(prepared([done], tmp_path)[done.name].relative_to(tmp_path)),
        "index": ".plan/index.json",
        "mark": f".begun/{done.name}.job",
        "times": f".times/{done.name}.json",
    }
    path, mine = tmp_path / places[what], tmp_path.with_name(f"{tmp_path.name}-mine")
    mine.write_text("mine")
    in_place_of(path, kind, mine)
    prepared([done], tmp_path)
    assert capsys.readouterr().err.startswith(f"{path} was ")
    assert mine.read_text() == "mine"
    assert not path.is_dir()
    assert not path.is_symlink()
    if kind == "folder":
        assert (path.with_name(f"{path.name}.aside1") / "mine").read_text() == "mine"
    run_job(json.loads(json.dumps(done.plan(done.digest(), tmp_path))))
    assert reason(done, tmp_path) is None
    prepared([done], tmp_path)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("name", ["cases", "cases/static", "cases/static/batch", ".receipts"])
def test_what_is_no_folder_makes_way_and_a_link_is_not_written_through(
    done: Job, tmp_path: Path, name: str
) -> None:
    path, mine = tmp_path / name, tmp_path.with_name(f"{tmp_path.name}-mine")
    mine.mkdir()
    for replace_it in (lambda: path.symlink_to(mine), path.touch, lambda: os.mkfifo(path)):
        shutil.rmtree(path)
        replace_it()
        prepared([done], tmp_path)
        run_job(json.loads(json.dumps(done.plan(done.digest(), tmp_path))))
        assert reason(done, tmp_path) is None
    assert not [*mine.iterdir()]


def test_links_that_people_put_beside_decks_or_results_stay(done: Job, tmp_path: Path) -> None:
    for name in ("mine", "decks/3dec/n3/results.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).symlink_to("/etc/hostname")
    prepared([replace(done, outputs={**done.outputs, "deck": "decks/3dec/n3/joint.dat"})], tmp_path)
    assert (tmp_path / "mine").is_symlink()
    assert (tmp_path / "decks/3dec/n3/results.txt").is_symlink()


@pytest.mark.parametrize("kind", ["pipe", "device", "link", "folder"])
def test_a_lock_that_is_no_file_makes_way(
    tmp_path: Path, kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = tmp_path / "mine"
    mine.write_text("mine")
    in_place_of(tmp_path / "r/.lock", kind, mine)
    lock(tmp_path / "r").close()
    assert mine.read_text() == "mine"
    assert capsys.readouterr().err.startswith(f"{tmp_path}/r/.lock was ")


def test_other_arguments_code_or_versions_make_results_stale(done: Job, tmp_path: Path) -> None:
    receipt = read_receipt(tmp_path / done.receipt)
    for other in (
        replace(done, arguments={**done.arguments, "cases": []}),
        replace(done, step="workflow.steps.decks"),
        replace(done, versions={"yade": "2"}),
        replace(done, files=("config.yaml",)),
    ):
        assert fault(receipt, done.name, other.digest(), tmp_path, done.receipted) == STALE
    same = replace(done, settings={"time_limit": 1.0})
    assert fault(receipt, done.name, same.digest(), tmp_path, done.receipted) is None


def test_what_was_changed_by_hand_is_taken_away_before_a_run(
    done: Job, study: Study, tmp_path: Path
) -> None:
    (tmp_path / done.written[1]).write_text("mine")
    prepared(plan_of(study).jobs.values(), tmp_path)
    assert not any((tmp_path / name).exists() for name in done.written)


def test_results_that_hold_are_left_alone(done: Job, study: Study, tmp_path: Path) -> None:
    before = {name: (tmp_path / name).stat().st_mtime_ns for name in done.written}
    plans = prepared(plan_of(study).jobs.values(), tmp_path)
    assert {name: (tmp_path / name).stat().st_mtime_ns for name in done.written} == before
    again = prepared(plan_of(study).jobs.values(), tmp_path)
    assert plans == again


def test_figures_of_the_configuration_are_no_part_of_what_a_case_depends_on(study: Study) -> None:
    other = read_study({**SMALL, "results": study.results, "figures": {"eccentricity": 0.4}})
    one, two = (plan_of(each).jobs for each in (study, other))
    assert one["static/batch"].digest() == two["static/batch"].digest()
    assert one["figures"].digest() != two["figures"].digest()


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
    plan = plan_of(read_study(config))
    assert plan.jobs["static/batch"].finds == (
        ("static", "n3-mesh0.03-e0a"),
        ("static", "n3-mesh0.015-e0a"),  # for the mesh error
    )
    assert {case.model for case in plan.cases.values()} == {"yade", "limit"}


def test_guides_of_an_engine_are_found_at_once_and_used_if_they_are_of_the_same_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    variants = {"unguided": {"numerics": {"guided": False}}, "soft": {"failure": "softening"}}
    config = SMALL | {"dem": {"engines": ["yade"]}, "variants": variants, "eccentricities": [0]}
    config["materials"] = {"inner": {"fracture_energy": 10.0}}
    jobs = plan_of(read_study(config)).jobs
    job = jobs["guides/yade"]
    assert job.finds == ()
    assert "workflow.engines.guide" in jobs["yade/n3-mesh0.03-e0a"].modules
    (tmp_path / "guides").mkdir()
    guides_step.run(job.arguments, {}, {"guides": tmp_path / "guides/yade.json"})

    def find(text: str, code: str) -> Guide | None:
        case = Case.from_json(text)
        return find_guide(tmp_path, code, case, problem_of(case))

    code, cases = job.arguments["code"], job.arguments["cases"]
    assert "unguided" not in {Case.from_json(text).variant for text in cases}
    found = [find(text, code) for text in cases]
    assert found == [find(text, "of other code") for text in cases]
    (guide,) = filter(None, found)
    assert 0.0 < guide.first_failure_N <= guide.peak_N
    monkeypatch.setattr("workflow.engines.guide.guide_for", lambda *_: "found anew")
    assert [find(text, code) for text in cases] == found
    assert find(cases[0], "of other code") == "found anew"


def test_witnesses_of_an_engine_at_two_meshes_are_at_these_only() -> None:
    config = {**SMALL, "models": ["limit"], "dem": {"engines": ["yade"]}, "eccentricities": [0]}
    slow = {"slow": {"numerics": {"ramp_periods": 80}, "meshes": [0.03]}}
    plan = plan_of(read_study({**config, "meshes": [0.03, 0.02], "variants": slow}))
    assert [name for _, name in plan.jobs["static/batch"].finds] == [
        *("n3-mesh0.03-e0a", "n3-mesh0.02-e0a")
    ]


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_one_lives(
    tmp_path: Path,
) -> None:
    first = lock(tmp_path)
    with pytest.raises(LockedError, match=r"another run is using this folder \(process \d+\)"):
        lock(tmp_path)
    first.close()
    lock(tmp_path).close()


def test_a_job_without_a_result_leaves_no_receipt_and_is_tried_again(
    study: Study, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    job = plan_of(study).jobs["static/batch"]
    cases = [Case.from_json(text) for text in job.arguments["cases"]]
    bad = replace(cases[0], joint=replace(cases[0].joint, density=1e-300), mesh=0.049)
    broken = replace(bad, mesh=1.0)  # longer than a lock: there is no such assembly
    arguments = {**job.arguments, "cases": [broken.to_json(), cases[1].to_json()]}
    plan = replace(job, arguments=arguments).plan("digest", tmp_path)
    run_job(json.loads(json.dumps(plan)))
    assert "mesh" in capsys.readouterr().err
    assert not (tmp_path / job.receipt).exists()
    records = (tmp_path / job.written[0]).read_text().splitlines()
    assert len(records) == 2
    assert json.loads(records[0])["error"].startswith("static: ")
    assert json.loads(records[1])["error"] is None


def engine_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: EngineError) -> Job:
    """The job of a case whose engine ends with ``error``, done."""

    def ends(*_: object) -> None:
        raise error

    monkeypatch.setattr("workflow.steps.engine.run_engine", ends)
    monkeypatch.setattr("workflow.run.job.edited", lambda _: False)
    monkeypatch.setattr("workflow.engines.engine.Engine.version", lambda _: "1")
    config = SMALL | {"dem": {"engines": ["yade"]}, "results": str(tmp_path), "eccentricities": [0]}
    job = plan_of(read_study(config)).jobs["yade/n3-mesh0.03-e0a"]
    run_job(json.loads(json.dumps(job.plan(job.digest(), tmp_path))))
    return job


def test_an_engine_that_has_no_answer_is_asked_again_only_on_request(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = engine_job(tmp_path, monkeypatch, EngineNoAnswerError("no answer: it drifts off"))
    record = tmp_path / job.written[0]
    assert "it drifts off" in json.loads(record.read_text())["error"]
    assert reason(job, tmp_path) is None
    prepared([job], tmp_path)
    assert record.exists()
    other = replace(job, arguments={**job.arguments, "time_limit": 1.0})
    assert reason(other, tmp_path) == STALE
    prepared([job], tmp_path, retry=True)
    assert not record.exists()


def test_an_engine_that_breaks_down_is_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = engine_job(tmp_path, monkeypatch, EngineError("ended with exit code 7"))
    assert reason(job, tmp_path) == "never made"


def test_what_has_a_result_is_not_made_again_on_request(done: Job, tmp_path: Path) -> None:
    prepared([done], tmp_path, retry=True)
    assert reason(done, tmp_path) is None


@pytest.mark.parametrize("damage", ["", "{", '{"name": "another"}'])
def test_a_plan_that_was_cut_or_changed_is_written_again(tmp_path: Path, damage: str) -> None:
    study = read_study({"samples": {"n3": {"locks": 3}}, "dem": {"engines": []}})
    plans = prepared(plan_of(study).jobs.values(), tmp_path)
    whole = plans["summary"].read_text()
    plans["summary"].write_text(damage)
    prepared(plan_of(study).jobs.values(), tmp_path)
    assert plans["summary"].read_text() == whole


def test_times_in_the_future_become_now_for_results_and_plans(done: Job, tmp_path: Path) -> None:
    """Or else Snakemake finds everything that is made from them older than they are."""
    (plan,) = prepared([done], tmp_path).values()
    record, later = tmp_path / done.written[0], time.time() + 1e8
    for path in (plan, record):
        os.utime(path, (later, later))
    prepared([done], tmp_path)
    assert record.stat().st_mtime == plan.stat().st_mtime < time.time()


def test_results_that_were_moved_are_not_made_again(tmp_path: Path) -> None:
    study = read_study({"samples": {"n3": {"locks": 3}}, "dem": {"engines": []}})
    (job,) = (job for job in plan_of(study).jobs.values() if job.name == "static/batch")
    results = tmp_path / "before"
    for name in job.written:
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        (results / name).write_text("made")
    write_receipt(results / job.receipt, job.name, job.digest(), results, job.written)
    prepared([job], results)
    results.rename(tmp_path / "after")
    (path,) = prepared([job], tmp_path / "after").values()
    assert str(tmp_path / "after") in path.read_text()
    newest = (tmp_path / "after" / job.written[0]).stat().st_mtime
    assert path.stat().st_mtime < newest


def test_every_job_has_a_time_limit_that_is_longer_than_an_engines() -> None:
    config = {**SMALL, "dem": {"engines": ["yade"], "time_limit": 7200}}
    limits = {name: job.time_limit for name, job in plan_of(read_study(config)).jobs.items()}
    assert min(limits.values()) >= 3600.0
    assert limits["yade/n3-mesh0.03-e0a"] > 2 * 3600.0
