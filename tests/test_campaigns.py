"""Short parts of `make faults`, `make fuzz` and `make bench`, and runs that are asked to end."""

import os
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import yaml
from campaigns import faults, fuzz
from campaigns.faults import descendants, processes_in
from conftest import INSTALLED
from joints import sawn
from processes import started
from test_execute import becomes_true

from benchmarks import used
from benchmarks.peers import furthest_by_highs, standard_form
from sidmacib import OPTIONS
from sidmacib.contact_points.programme import Sidmacib, SupportFunction
from workflow.command import STOPPED, lock


@pytest.mark.engine
def test_whatever_happens_the_next_run_ends_as_if_nothing_had() -> None:
    with faults.begun(seed=7) as campaign:
        campaign.kills = 1
        faults.held(campaign, faults.killed)


@pytest.mark.long
def test_whatever_comes_in_is_an_answer_or_a_clear_no() -> None:
    with fuzz.begun(seed=11) as begun:
        fuzz.tried(begun, 600)
    assert min(begun.accepted.values()) > 0 < min(begun.refused.values())
    assert begun.accepted.keys() == begun.refused.keys()


LONG = {  # a case of an engine that takes minutes
    "samples": {"n5": {"locks": 5}},
    "meshes": [0.005],
    "eccentricities": [0],
    "models": ["limit"],
    "dem": {"engines": ["yade"]},
    "sidmacib": {"reductions": ["none"]},
}


@pytest.mark.study
@pytest.mark.engine
@pytest.mark.parametrize(
    ("number", "whom", "words"),
    [
        (signal.SIGKILL, "make", ""),
        (signal.SIGTERM, "main", ""),
        (signal.SIGINT, "all", STOPPED),  # ^C on a terminal, pressed twice
        (signal.SIGINT, "all at once", ""),
    ],
)
def test_a_study_that_is_stopped_leaves_nothing_alive_and_no_lock(
    tmp_path: Path, number: signal.Signals, whom: str, words: str
) -> None:
    config = tmp_path / "study.yaml"
    config.write_text(yaml.safe_dump(LONG))
    asked = ("study", f"CONFIG={config}", f"RESULTS={tmp_path / 'results'}")
    run = started(*INSTALLED, *asked, start_new_session=True)
    if whom == "all at once":
        time.sleep(0.25)
    else:
        assert becomes_true(lambda: any("joint.py" in e for e in processes_in(tmp_path)), 90.0)
    pid = descendants(run.pid)[0] if whom == "main" else run.pid
    for _ in range(2):
        with suppress(ProcessLookupError):
            (os.killpg if whom.startswith("all") else os.kill)(pid, number)
        time.sleep(0.1)
    try:
        assert becomes_true(lambda: not processes_in(tmp_path), 15.0), processes_in(tmp_path)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(run.pid, signal.SIGKILL)
    output, _ = run.communicate(timeout=10.0)
    assert words in output
    lock(tmp_path / "results").close()


# --- what `make bench` measures ------------------------------------------------------------------
@pytest.mark.parametrize("way", [(1.0, 0.0), (0.3, 0.7), (-0.2, -0.9)])
def test_highs_of_scipy_solves_the_same_programme(way: tuple[float, float]) -> None:
    model, along = Sidmacib(sawn(5), OPTIONS["option4"]), np.array(way)
    ours = SupportFunction(model)(along)
    theirs = furthest_by_highs(standard_form(model), along)
    assert along @ theirs == pytest.approx(along @ ours, rel=1e-9)


def test_memory_is_that_of_the_command_alone(tmp_path: Path) -> None:
    held = np.ones(30_000_000)  # 240 MB in the process that measures
    code = "held = b'1' * int({}e6)"
    little, much = (
        used([sys.executable, "-c", code.format(megabytes)], tmp_path).memory
        for megabytes in (0.0, 100.0)
    )
    assert little < held.nbytes / 1e6 / 2.0
    assert much - little == pytest.approx(100.0 * 1e6 / 2**20, rel=0.1)
