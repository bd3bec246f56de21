"""Runs that are asked to end: they leave nothing behind and print one line."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml
from campaigns.faults import processes_in
from conftest import ROOT
from test_execute import becomes_true
from workflow.run.process import STOPPED

LONG = {  # a case of an engine that takes minutes
    "samples": {"n5": {"locks": 5}},
    "meshes": [0.005],
    "eccentricities": [0],
    "models": ["limit"],  # no report without the engine first, as that needs static
    "dem": {"engines": ["yade"]},
    "sidmacib": {"reductions": ["none"]},
}


def make_study(folder: Path) -> subprocess.Popen[str]:
    """`make study` of a long study, started in a separate session."""
    config = folder / "study.yaml"
    config.write_text(yaml.safe_dump(LONG))
    # As it is installed: nothing is installed here.
    ready = ("--old-file=.venv/study.ready", f"BIN={Path(sys.executable).parent}")
    return subprocess.Popen(
        ["make", *ready, "study", f"CONFIG={config}", f"RESULTS={folder / 'results'}"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


@pytest.mark.study
@pytest.mark.engine
@pytest.mark.parametrize(
    ("number", "to_all", "times"),
    [
        (signal.SIGTERM, False, 1),
        (signal.SIGINT, False, 1),
        (signal.SIGHUP, False, 1),
        (signal.SIGKILL, False, 1),
        (signal.SIGINT, True, 2),  # ^C on a terminal, pressed twice
        (signal.SIGHUP, True, 1),  # a terminal that is closed
    ],
)
def test_a_study_ends_with_make_and_its_engines_with_it(
    tmp_path: Path, number: signal.Signals, to_all: bool, times: int
) -> None:
    run = make_study(tmp_path)
    assert becomes_true(lambda: any("joint.py" in each for each in processes_in(tmp_path)), 90.0)
    for _ in range(times):
        (os.killpg if to_all else os.kill)(run.pid, number)
        time.sleep(0.1)
    assert becomes_true(lambda: not processes_in(tmp_path), 15.0), processes_in(tmp_path)
    output, _ = run.communicate(timeout=10.0)
    assert STOPPED in output
    assert "Traceback" not in output


@pytest.mark.parametrize("delay", [0.02, 0.1, 0.25, 0.5, 1.0])
def test_a_study_that_is_interrupted_at_once_ends_with_a_line(tmp_path: Path, delay: float) -> None:
    run = make_study(tmp_path)
    time.sleep(delay)
    for _ in range(2):
        os.killpg(run.pid, signal.SIGINT)
        time.sleep(0.05)
    output, _ = run.communicate(timeout=30.0)
    assert run.returncode != 0
    assert "Traceback" not in output
    assert not processes_in(tmp_path)
