"""Running an external program: whatever goes wrong, nothing half-written counts."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from workflow.engines import ENGINES, Engine
from workflow.execute import EngineError, execute
from workflow.render import DATA_FILE
from workflow.results import OUTPUTS

GOOD = """
open("history.csv", "w").write("load_N")
open("nodes.csv", "w").write("face")
open("result.json", "w").write('{"peak_load_N": 12.5}')
"""


def python_engine() -> Engine:
    return replace(ENGINES["yade"], command=(sys.executable,), probe=sys.executable)


def folder_with(tmp_path: Path, text: str) -> Path:
    (tmp_path / ENGINES["yade"].script).write_text(text)
    (tmp_path / DATA_FILE).write_text("{}")
    return tmp_path


def test_a_run_that_ends_well_leaves_its_results_and_its_log(tmp_path: Path) -> None:
    execute(python_engine(), folder_with(tmp_path, GOOD + "print('hello')"), 60)
    assert json.loads((tmp_path / "result.json").read_text()) == {"peak_load_N": 12.5}
    assert (tmp_path / "engine.log").read_text() == "hello\n"
    assert not list(tmp_path.glob("running-*"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD + "raise ValueError('no good')", "ended with exit code 1; .*\n.*no good"),
        (GOOD + "import os; os.kill(os.getpid(), 9)", "killed by signal 9"),
        (
            GOOD + "print('so far', flush=True); import time; time.sleep(60)",
            "out of time after 1 s",
        ),
        ("print('nothing')", "ended without history.csv; .*\n.*nothing"),
        (GOOD.replace("12.5", "0"), "ended without a peak: load 0 N"),
        (GOOD.replace("12.5}", ""), "unreadable result.json"),
    ],
)
def test_a_run_that_ends_badly_leaves_no_result(tmp_path: Path, text: str, message: str) -> None:
    folder = folder_with(tmp_path, text)
    for name in OUTPUTS:  # of an earlier run
        (folder / name).write_text("old")
    with pytest.raises(EngineError, match=f"(?s){message}"):
        execute(python_engine(), folder, 1)
    assert not any((folder / name).exists() for name in OUTPUTS)
    assert not list(folder.glob("running-*"))


def test_a_missing_program_is_named_with_its_package(tmp_path: Path) -> None:
    engine = replace(ENGINES["yade"], probe="no-such-yade")
    with pytest.raises(EngineError, match="yade: not installed; on Debian: apt-get install yade"):
        execute(engine, folder_with(tmp_path, GOOD), 60)


def test_only_the_end_of_a_long_log_is_shown(tmp_path: Path) -> None:
    text = "for i in range(1000): print('line', i)\nraise SystemExit(3)"
    with pytest.raises(EngineError) as error:
        execute(python_engine(), folder_with(tmp_path, text), 60)
    assert "line 999" in str(error.value)
    assert "line 900" not in str(error.value)


def test_stopping_the_step_stops_the_program_and_its_children(tmp_path: Path) -> None:
    child = "import subprocess, sys, time\n" + "p = subprocess.Popen(['sleep', '300'])\n"
    text = child + "open(r'%s', 'w').write(str(p.pid)); time.sleep(300)" % (tmp_path / "pid")
    folder = folder_with(tmp_path, text)
    step = subprocess.Popen(
        [sys.executable, "-m", "workflow.execute", "yade", str(folder), "--time-limit", "300"],
        env={**os.environ, "YADE_PYTHON": sys.executable},
    )
    for _ in range(200):
        if (tmp_path / "pid").exists() and (tmp_path / "pid").read_text():
            break
        time.sleep(0.05)
    pid = int((tmp_path / "pid").read_text())
    step.send_signal(signal.SIGTERM)
    assert step.wait(20) != 0
    for _ in range(100):
        if not Path(f"/proc/{pid}").exists() or "Z" in Path(f"/proc/{pid}/stat").read_text():
            break
        time.sleep(0.05)
    else:
        pytest.fail("the program's child lives on")
