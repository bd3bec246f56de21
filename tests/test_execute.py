"""Scripts of engines as they are written and run: nothing half-written counts."""

import ast
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from joints import loaded, sawn
from processes import python
from stack import tilted_stack
from structures import on_ground

from sidmacib.engines import ENGINES, Engine, Numerics
from sidmacib.engines.liggghts.process import LiggghtsProcess
from sidmacib.engines.render import DATA_FILE, MODULES, write_script
from sidmacib.engines.run import (
    OUTPUTS,
    EngineError,
    EngineNoAnswerError,
    engine_outcome,
    execute,
    guide_of,
    refusal,
)
from sidmacib.engines.scripts.assembly import Guide, read_assembly
from sidmacib.errors import ResultError
from sidmacib.joint import INNER
from sidmacib.mechanics.assembly import Elastic, Failure
from sidmacib.problem import Problem
from sidmacib.structure.loads import acceleration

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


def test_a_missing_program_is_named_with_its_package(tmp_path: Path) -> None:
    engine = replace(ENGINES["yade"], probe="no-such-yade")
    with pytest.raises(EngineError, match="yade: not installed; on Debian: apt-get install yade"):
        execute(engine, folder_with(tmp_path, GOOD), 60)


def test_to_ask_for_a_version_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    shell = ("sh", "-c", "touch log.liggghts; echo 'LIGGGHTS (Version LIGGGHTS-X 9.1'")
    assert replace(ENGINES["liggghts"], prints_version=shell).version() == "9.1"
    assert not [*tmp_path.iterdir()]


def test_a_program_that_cannot_start_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "liggghts"
    program.write_text("#!/bin/sh\necho libx.so: not found >&2; exit 127\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    with pytest.raises(SystemExit):
        LiggghtsProcess(1)
    assert capsys.readouterr().err.endswith(" (exit code 127): libx.so: not found\n")
    shell = ("sh", "-c", "echo libx.so: not found >&2")
    engine = replace(ENGINES["liggghts"], prints_version=shell)
    with pytest.raises(RuntimeError, match=r"^liggghts: does not start: libx.so: not found$"):
        engine.version()
    assert engine.versions() == {}


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


@pytest.mark.long
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
    said = refusal(ENGINES[engine], loaded(sawn(3, **joint)).assembly)
    assert said is None if not words else words in str(said)


# --- rendered scripts, and the data and modules beside them --------------------------------------
@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> Engine:
    return ENGINES[request.param]


@pytest.fixture
def case() -> Problem:
    return loaded(sawn(3), 0.5, 0.02)


def written(engine: Engine, case: Problem, folder: Path, guide: Guide | None = None) -> Path:
    write_script(engine, *case, Numerics(), "three locks", folder, guide)
    return folder


def test_a_script_is_python_beside_its_modules_and_needs_none_of_this_project(
    engine: Engine, case: Problem, tmp_path: Path
) -> None:
    text = (written(engine, case, tmp_path) / engine.script).read_text()
    ast.parse(text)
    assert "{{" not in text and "{%" not in text
    assert "three locks" in text
    copied = list((tmp_path / MODULES.name).rglob("*.*"))
    assert {path.parent.name for path in copied} == {"scripts", engine.name}
    for path in copied:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                folder = path.parents[node.level - 1]
                assert folder / f"{node.module.replace('.', '/')}.py" in copied
            elif isinstance(node, ast.ImportFrom):
                assert node.module and node.module.split(".")[0] in sys.stdlib_module_names


def test_the_modules_run_without_this_project(tmp_path: Path, case) -> None:
    folder = written(ENGINES["liggghts"], case, tmp_path)
    call = "import engines.liggghts.run, sys; print({'numpy', 'sidmacib'} & set(sys.modules))"
    found = python("-S", "-c", call, cwd=folder, check=True)
    assert found.stdout.strip() == "set()"


def test_a_script_reads_back_what_was_written(engine: Engine, tmp_path: Path) -> None:
    assembly, loads = tilted_stack(2)
    first, second = assembly.faces
    smooth = replace(first, material=replace(first.material, friction=0.1))
    assembly = replace(assembly, faces=(smooth, second))
    write_script(engine, assembly, loads, Numerics(), "stack", tmp_path)
    tree = ast.parse((tmp_path / engine.script).read_text())
    call = next(
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "read_assembly"
    )
    materials = ast.literal_eval(call.keywords[0].value)
    read = read_assembly(str(tmp_path / DATA_FILE), materials)
    # Two faces of one kind keep different materials.
    assert [face.material.friction for face in read.faces] == [0.1, 0.5]
    assert [face.material.friction for face in assembly.faces] == [0.1, 0.5]
    assert np.array([n.position_m for n in read.nodes]) == pytest.approx(assembly.nodes.position)
    assert [[*p.force_N, *p.moment_Nm] for p in read.pieces] == loads.permanent.tolist()
    assert [[*part.force, *part.moment_m] for part in read.loads] == loads.variable[1:].tolist()
    assert read.permanent_N == pytest.approx(loads.scale)


@pytest.mark.parametrize("key", [field.name for field in fields(Numerics)])
def test_an_engine_reads_the_numerics_that_change_its_script_and_no_others(
    engine: Engine, key: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sidmacib.engines.run.execute", lambda *_: None)
    value = getattr(Numerics(), key)
    other = not value if isinstance(value, bool) else type(value)(2 * value)

    joint = sawn(3, elastic=Elastic(1e10) if engine.elastic else None)
    problems = [loaded(joint, 0.5)]
    if not engine.elastic:
        blocks = on_ground(0.5)
        problems.append(Problem(blocks, acceleration(blocks, (1.0, 0.0, 0.0))))

    def scripts(numerics: Numerics) -> list[str]:
        found = []
        for problem in problems:
            with pytest.raises(ResultError):  # nothing was run
                engine_outcome(engine, problem, numerics, "what is tested", tmp_path, 1.0)
            found.append((tmp_path / engine.script).read_text())
        return found

    one, two = scripts(Numerics()), scripts(replace(Numerics(), **{key: other}))
    assert (one != two) == (key in engine.reads)


@pytest.mark.parametrize("name", [name for name in ENGINES if "guided" in ENGINES[name].reads])
def test_the_static_model_guides_the_search(name: str, case: Problem, tmp_path: Path) -> None:
    guide = guide_of(*case)
    assert guide is not None
    texts = [
        (written(ENGINES[name], case, tmp_path, each) / ENGINES[name].script).read_text()
        for each in (guide, None)
    ]
    assert f"first_failure_N={guide.first_failure_N}," in texts[0]
    assert f"peak_N={guide.peak_N}," in texts[0]
    assert "Guide" not in texts[1]
