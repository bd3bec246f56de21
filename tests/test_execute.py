"""Running an external program: whatever goes wrong, nothing half-written counts."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from joints import loaded

from sidmacib.engines import ENGINES, Engine
from sidmacib.engines.render import DATA_FILE, MODULES
from sidmacib.engines.run import OUTPUTS, EngineError, EngineNoAnswerError, execute, refusal
from sidmacib.joint import INNER, Joint
from sidmacib.mechanics.assembly import Elastic, Failure

RESULT = {"peak_load_N": 12.5, "failed_load_N": 12.6}
GOOD = f"""
open("history.csv", "w").write("load_N")
open("nodes.csv", "w").write("face")
open("result.json", "w").write('{json.dumps(RESULT)}')
"""


def python_engine() -> Engine:
    return replace(ENGINES["yade"], command=(sys.executable,), probe=sys.executable)


def folder_with(tmp_path: Path, text: str) -> Path:
    (tmp_path / ENGINES["yade"].script).write_text(text)
    (tmp_path / DATA_FILE).write_text("{}")
    (tmp_path / MODULES.name).mkdir()
    return tmp_path


def test_a_run_that_ends_well_leaves_its_results_and_its_log(tmp_path: Path) -> None:
    execute(python_engine(), folder_with(tmp_path, GOOD + "print('hello')"), 60)
    assert json.loads((tmp_path / "result.json").read_text()) == RESULT
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
        (GOOD.replace("12.5", "0"), "ended without a peak: it carries 0 N and fails at 12.6 N"),
        (GOOD.replace("12.5", "13"), "ended without a peak: it carries 13 N and fails at 12.6 N"),
        (GOOD.replace("12.5", "NaN"), "ended without a peak: it carries nan N"),
        (GOOD.replace("12.6", "Infinity"), "fails at inf N"),
        (GOOD.replace("12.6", "null"), "unreadable result.json"),
        (GOOD.replace("12.6}", ""), "unreadable result.json"),
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


def test_a_script_that_gives_a_reason_is_told_from_one_that_crashes(tmp_path: Path) -> None:
    text = "from engines.scripts.records import NoAnswerError\nraise NoAnswerError('it drifts off')"
    folder = folder_with(tmp_path, text)
    shutil.copytree(MODULES / "scripts", folder / MODULES.name / "scripts")
    with pytest.raises(EngineNoAnswerError, match=r"(?s)^no answer; end of .*\n.*it drifts off$"):
        execute(python_engine(), folder, 60)
    (folder / ENGINES["yade"].script).write_text("raise ValueError")
    with pytest.raises(EngineError) as error:
        execute(python_engine(), folder, 60)
    assert not isinstance(error.value, EngineNoAnswerError)


# --- however the runner ends, the program ends ---------------------------------------------------
RUNNER = """
import sys
from pathlib import Path
from test_execute import python_engine
from sidmacib.engines.run import execute
execute(python_engine(), Path(sys.argv[1]), 300)
"""


def becomes_true(condition: Callable[[], bool], seconds: float = 60.0) -> bool:
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return True
        time.sleep(0.05)
    return False


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_the_program_ends_however_its_runner_ends(tmp_path: Path, number: signal.Signals) -> None:
    text = f"import os, time; open({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()) + ' ')"
    folder = folder_with(tmp_path, text + "\ntime.sleep(300)")
    paths = os.pathsep.join([str(Path(__file__).parent), str(Path(__file__).parents[1])])
    runner = subprocess.Popen(
        [sys.executable, "-c", RUNNER, str(folder)], env={**os.environ, "PYTHONPATH": paths}
    )
    file = tmp_path / "pid"
    assert becomes_true(lambda: file.exists() and file.read_text().endswith(" "))
    pid = int(file.read_text())
    assert alive(pid)
    runner.send_signal(number)
    runner.wait(20)
    assert becomes_true(lambda: not alive(pid))


# --- what an engine can do -----------------------------------------------------------------------
SOFT = {"inner": replace(INNER, shear_stiffness=1e9)}
DUCTILE, BENDS = {"failure": Failure.DUCTILE}, {"elastic": Elastic(1e10)}


@pytest.mark.parametrize(
    ("engine", "joint", "words"),
    [
        *(("liggghts", {}, ""), ("yade", DUCTILE, ""), ("yade", SOFT, ""), ("calculix", BENDS, "")),
        ("liggghts", DUCTILE, "ductile"),
        (
            "yade",
            {"failure": Failure.SOFTENING},
            "no engine models softening bonds; use the static model",
        ),
        ("liggghts", SOFT, "one stiffness"),
        ("yade", BENDS, "only rigid"),
        ("calculix", {}, "only elastic"),
        ("calculix", BENDS | DUCTILE, "ductile"),
    ],
)
def test_an_engine_says_what_it_cannot_do(engine: str, joint: dict[str, Any], words: str) -> None:
    said = refusal(ENGINES[engine], loaded(Joint(3, **joint)).assembly)
    assert said is None if not words else words in str(said)
