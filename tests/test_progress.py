"""Progress of a run: counts, messages and the remaining time."""

import io
import json
import logging
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from workflow.run import waiting
from workflow.run.progress import LogHandler, Run, when_planned


def record(event: LogEvent | None, level: int = logging.INFO, text: str = "", **fields: Any) -> Any:
    made = logging.LogRecord("snakemake", level, __file__, 1, text, None, None)
    vars(made).update(fields, **({"event": event} if event else {}))
    return made


def begin(job: int, name: str, output: str = "x", log: str = "x.log") -> Any:
    fields = {"jobid": job, "rule_msg": name, "rule_name": "rule", "output": [output], "log": [log]}
    return record(LogEvent.JOB_INFO, **fields)


def end(job: int) -> Any:
    return record(LogEvent.JOB_FINISHED, job_id=job)


def started(total: int = 4) -> Run:
    run = Run()
    run.heard(record(LogEvent.RUN_INFO, stats={"a": total, "total": total}), 0.0)
    return run


def test_jobs_are_counted_and_what_runs_is_named() -> None:
    run = started()
    run.heard(begin(1, "one"), 0.0)
    run.heard(begin(2, "two"), 0.0)
    run.heard(end(1), 30.0)
    assert run.words(30.0) == "1 of 4 jobs done; running: two; about 90 s left"


@pytest.mark.parametrize(
    ("done", "now", "words"),
    [(0, 9.0, ""), (1, 100.0, "5 min"), (1, 9000.0, "7.5 h"), (4, 9.0, "")],
)
def test_time_left_is_in_proportion(done: int, now: float, words: str) -> None:
    run = started()
    run.done = done
    assert run.left(now) == words


def test_many_jobs_that_run_are_cut_short() -> None:
    run = started(9)
    for job in range(5):
        run.heard(begin(job, f"job{job}"), 0.0)
    assert "running: job0, job1 and 3 more" in run.words(1.0)


def test_a_case_without_a_result_is_named_once_with_its_reason_and_log(tmp_path: Path) -> None:
    path = tmp_path / "record.json"
    path.write_text(json.dumps({"error": "it diverged"}))
    run = started()
    run.heard(begin(1, "yade: n3", str(path), "logs/n3.log"), 0.0)
    assert run.heard(end(1), 1.0) == ["No result: yade: n3: it diverged; log: logs/n3.log"]
    assert run.failed == ["yade: n3"]
    path.write_text(json.dumps({"error": None}))
    run.heard(begin(2, "yade: n5", str(path)), 0.0)
    assert run.heard(end(2), 1.0) == []


def test_a_job_that_ends_badly_is_named_with_the_last_of_its_log(tmp_path: Path) -> None:
    log = tmp_path / "job.log"
    log.write_text("Traceback\n\nValueError: no\n")
    run = started()
    run.heard(begin(1, "Sum up", log=str(log)), 0.0)
    found = run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="summary"), 1.0)
    assert found == [f"Failed: Sum up: ValueError: no; log: {log}"]
    assert run.running == {}
    assert "1 failed" in run.words(1.0)


def test_warnings_are_shown_and_chatter_is_not() -> None:
    run = started()
    assert run.heard(record(None, logging.WARNING, "disk is full"), 0.0) == ["disk is full"]
    assert run.heard(record(None, logging.INFO, "Building DAG of jobs..."), 0.0) == []


def test_a_file_gets_few_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    handler = LogHandler(None, None)  # type: ignore[arg-type]
    handler.emit(record(LogEvent.RUN_INFO, stats={"a": 1000, "total": 1000}))
    for job in range(1000):
        handler.emit(begin(job, f"job{job}"))
        handler.emit(end(job))
    lines = stream.getvalue().splitlines()
    assert len(lines) <= 12
    assert lines[-1] == "1000 of 1000 jobs done"
    handler.close()


def test_a_job_that_was_stopped_is_not_a_failure(tmp_path: Path) -> None:
    run, log = started(), tmp_path / "job.log"
    log.write_text("at work\nstopped\n")
    run.heard(begin(1, "one", log=str(log)), 0.0)
    assert run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="rule"), 1.0) == []
    assert run.failed == []
    assert run.running == {}


def test_the_command_of_a_job_that_ended_badly_is_not_repeated() -> None:
    text = "RuleException:\nCalledProcessError in file ..."
    assert started().heard(record(LogEvent.ERROR, logging.ERROR, text), 0.0) == []


def test_a_job_that_did_better_when_it_was_tried_again_did_not_fail(tmp_path: Path) -> None:
    run, log = started(), tmp_path / "job.log"
    log.write_text("no luck\n")
    run.heard(begin(1, "one", log=str(log)), 0.0)
    run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="rule"), 1.0)
    assert run.failed == ["one"]
    run.heard(end(1), 2.0)
    assert run.failed == []


def test_a_job_ended_by_a_signal_is_reported_and_logged_with_the_signal(tmp_path: Path) -> None:
    """As where memory is short: the job itself says nothing."""
    run, log = started(), tmp_path / "job.log"
    log.touch()
    text = f"RuleException:\nCommand 'python > {log} 2>&1' died with <Signals.SIGKILL: 9>."
    run.heard(begin(1, "one", log=str(log)), 0.0)
    assert run.heard(record(LogEvent.ERROR, logging.ERROR, text), 1.0) == []
    found = run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="rule"), 1.0)
    words = "killed by SIGKILL, probably because memory ran out"
    assert found == [f"Failed: one: {words}; log: {log}"]
    assert log.read_text() == f"{words}\n"


def test_a_job_that_ends_without_a_word_is_a_reason(tmp_path: Path) -> None:
    run, log = started(), tmp_path / "job.log"
    log.touch()
    run.heard(begin(1, "one", log=str(log)), 0.0)
    run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="rule"), 1.0)
    assert run.reasons == [f"Failed: one: no message; log: {log}"]


def test_a_job_whose_message_had_no_room_is_reported_with_the_full_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=512))
    run, log = started(), tmp_path / "job.log"
    log.touch()
    run.heard(begin(1, "one", log=str(log)), 0.0)
    found = run.heard(record(LogEvent.JOB_ERROR, jobid=1, rule_name="rule"), 1.0)
    assert found == [f"Failed: one: no space left on the disk; log: {log}"]


def test_that_cases_lack_results_is_a_reason_only_where_no_case_gave_one(tmp_path: Path) -> None:
    run, log = started(), tmp_path / "job.log"
    log.write_text("n3 (static): no\n")
    for job, name in ((1, "Check that every case has a result"), (2, "one")):
        run.heard(begin(job, name, log=str(log)), 0.0)
        run.heard(record(LogEvent.JOB_ERROR, jobid=job, rule_name="rule"), 1.0)
        assert [reason.split(": ")[1] for reason in run.reasons] == [name]


def test_what_was_up_to_date_or_made_in_a_run_is_its_own() -> None:
    assert not Run().is_made("summary")  # nothing is known of it
    run = Run()
    run.heard(record(LogEvent.RUN_INFO, stats={"rule": 1, "other": 1, "total": 2}), 0.0)
    assert run.is_made("summary")
    assert not run.is_made("rule")
    run.heard(begin(1, "one"), 0.0)
    run.heard(end(1), 1.0)
    assert run.is_made("rule")
    assert not run.is_made("other")


def test_what_takes_long_before_anything_else_is_shown_says_that_it_is_at_work(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(waiting, "FIRST", 0.05)
    monkeypatch.setattr(waiting, "NEXT", 0.1)
    with waiting.waiting("Planning"):
        time.sleep(0.3)
    found = capsys.readouterr().err.splitlines()
    assert found[0] == "Planning"
    assert found[1] == "Planning, 0 s so far"
    with waiting.waiting("Planning"):
        pass
    time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_planning_has_ended_when_the_jobs_are_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    ended: list[bool] = []
    when_planned(lambda: ended.append(True))
    handler = LogHandler(None, None)  # type: ignore[arg-type]
    handler.emit(begin(1, "one"))
    assert not ended
    for _ in range(2):
        handler.emit(record(LogEvent.RUN_INFO, stats={"a": 1, "total": 1}))
    assert ended == [True]
    handler.close()
