"""Before anything runs: the environment, ^C, the locale, faults, full disks, missing locks."""

import errno
import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from conftest import INSTALLED
from processes import ROOT, python, ran

from workflow import __main__ as workflow_main
from workflow import command as workflow_command
from workflow.configuration import CallError

SMALL = (
    "samples: {n3: {locks: 3}}\nmeshes: [0.02]\neccentricities: [0]\nmodels: [static]\n"
    "dem: {engines: []}\nsidmacib: {reductions: [none]}\n"
)
# ^C, twice, when a module is first imported.
INTERRUPTED = """
import builtins, os, signal, sys
real, late = __import__, sys.argv.pop(1)
def slow(name, *others, **more):
    if name.partition(".")[0] == late and late not in sys.modules:
        sys.modules[late] = None
        try:
            os.kill(os.getpid(), signal.SIGINT)
        finally:
            os.kill(os.getpid(), signal.SIGINT)
    return real(name, *others, **more)
builtins.__import__ = slow
"""
PROGRAM = "from sidmacib.command import run; run()"


@pytest.mark.parametrize("late", ["click", "numpy"])
def test_an_interrupt_while_a_program_loads_is_reported_in_one_line(late: str) -> None:
    found = python("-c", INTERRUPTED + PROGRAM, late)
    assert found.returncode == 1
    assert found.stderr == "Aborted!\n"


def test_an_interrupt_while_the_workflow_loads_ends_it_without_a_word() -> None:
    program = "import runpy; runpy.run_module('workflow', run_name='__main__')"
    found = python("-c", INTERRUPTED + program, "pydantic")
    assert (found.returncode, found.stderr) == (-signal.SIGINT, "")


# A script of Snakemake's that ^C reaches while it loads.
JOB = """
import os, signal, types
files = dict.fromkeys(("input", "output", "params", "resources"), {})
snakemake = types.SimpleNamespace(rule="", log=["log"], **files)
os.kill(os.getpid(), signal.SIGINT)
from workflow.step import step
step(lambda *_: print("runs"))
"""


def test_an_interrupt_while_a_job_loads_ends_it_without_a_traceback(tmp_path: Path) -> None:
    rules = (ROOT / "workflow/rules/common.smk").read_text()
    (prefix,) = re.findall(r'^shell\.prefix\("(.+)"\)$', rules, re.MULTILINE)
    (tmp_path / "job.py").write_text(JOB)
    found = ran(
        "bash", "-c", f"{prefix} {sys.executable} job.py", cwd=tmp_path, PYTHONPATH=str(ROOT)
    )
    assert (found.returncode, found.stdout + found.stderr) == (1, "")
    assert (tmp_path / "log").read_text() == "stopped\n"


def test_times_in_the_future_come_before_now_in_their_order(tmp_path: Path) -> None:
    now = time.time()
    for name, when in (("input", now + 1e6), ("output", now + 2e6), ("old", now - 5.0)):
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (when, when))
    workflow_command.set_back(tmp_path)
    old, first, last = ((tmp_path / name).stat().st_mtime for name in ("old", "input", "output"))
    assert old < first < last <= time.time()
    assert last - first == pytest.approx(1e6)


def test_a_disk_without_room_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "study.yaml").write_text(SMALL)
    monkeypatch.setattr(workflow_main, "snakemake", lambda *_, **__: False)
    for free, why in ((2_000_000, "its disk has 2 MB left"), (10**9, "see above")):
        monkeypatch.setattr(shutil, "disk_usage", lambda _, free=free: SimpleNamespace(free=free))
        words = workflow_main.run_study(tmp_path / "study.yaml", f"{tmp_path}/results")
        assert words == f"{tmp_path}/results: the study is incomplete, {why}"


def test_engines_come_after_a_first_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def made(engines: str) -> list[bool]:
        found: list[bool] = []
        monkeypatch.setattr(
            workflow_main, "snakemake", lambda *_, engines=True, **__: found.append(engines)
        )
        (tmp_path / "study.yaml").write_text(SMALL.replace("engines: []", f"engines: {engines}"))
        workflow_main.run_study(tmp_path / "study.yaml", f"{tmp_path}/results")
        return found

    assert made("[]") == [True]
    assert made("[yade]") == [False, True]
    (tmp_path / "results/report.html").write_text("")
    assert made("[yade]") == [True]


@pytest.mark.long
def test_a_picture_is_drawn_in_a_notebook(tmp_path: Path) -> None:
    words = ("envelope", "-n", "2", "-m", "law", "--picture", tmp_path / "law.svg")
    found = python("-c", PROGRAM, *words, MPLBACKEND="module://not_there.backend_inline")
    assert found.returncode == 0, found.stderr


@pytest.mark.study
def test_a_case_is_run_in_a_locale_that_is_not_utf_8(tmp_path: Path) -> None:
    config = tmp_path / "study.yaml"
    config.write_text(SMALL + "# \u00b5\n", encoding="utf-8")
    words = (f"CONFIG={config}", f"RESULTS={tmp_path / 'results'}", "CASE=n3-mesh0.02-e0a")
    posix = {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": ""}
    found = ran(*INSTALLED, "case", *words, **posix)
    assert found.returncode == 0, found.stderr
    assert "V = 24" in found.stdout


@pytest.mark.study
def test_a_study_is_run_by_a_python_whose_path_has_blanks(tmp_path: Path) -> None:
    program, config = tmp_path / "o'b c/python", tmp_path / "study.yaml"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    program.chmod(0o755)
    config.write_text(SMALL)
    run = "import sys; sys.executable = sys.argv.pop(1); from snakemake.cli import main; main()"
    results = tmp_path / "results"
    words = ("--cores", "1", "--configfile", config, "--config", f"results={results}")
    found = python("-c", run, program, *words, "--", results / "tables/cases.csv")
    assert found.returncode == 0, found.stderr


def test_make_installs_nothing_for_a_study_that_is_not_there() -> None:
    command = ("make", "--dry-run", "--always-make", "study", "CONFIG=my.yaml")
    printed = ran(*command, check=True).stdout
    first, *_ = [line for line in printed.splitlines() if re.search("not a file|environment", line)]
    early = ran("sh", "-c", first, CONFIG="my.yaml")
    assert (early.returncode, early.stderr) == (1, "my.yaml: not a file\n")


@pytest.mark.long
def test_a_fault_that_only_the_cases_show_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "study.yaml"
    path.write_text(SMALL + "overrides: {n3-mesh0.02-torsion: {ramp_periods: 50}}\n")
    asked = ["case", str(path), "--case", "n3-mesh0.02-e0a"]
    assert python("-m", "analysis", *asked).stderr.startswith(f"{path}: overrides: 'n3-mesh0.02-")
    path.write_text(SMALL)
    asked[-1] = "n4"
    assert python("-m", "analysis", *asked).stderr.startswith("CASE: 'n4' is not a case")


PYTHON = '#!/bin/sh\nmkdir -p .venv/bin && cp pip .venv/bin/pip && echo "$@" >> calls\n'
PIP = """#!/bin/sh
echo "$@" >> calls
case "$*" in *installer.txt) [ ! -f uv ] || cp uv .venv/bin/uv;; esac
{fails}
"""
UV = '#!/bin/sh\necho uv "$@" >> calls\nexit {status}\n'


def made(
    folder: Path, fails: str, python: str = "python3", **more: str
) -> subprocess.CompletedProcess[str]:
    """The script, run with programs that only log their arguments, and ``more`` programs."""
    (folder / "workflow").mkdir()
    shutil.copy(ROOT / "workflow/install.sh", folder / "workflow")
    for path, text in ((f"bin/{python}", PYTHON), ("pip", PIP.format(fails=fails)), *more.items()):
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_text(text)
        (folder / path).chmod(0o755)
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    return ran("sh", ROOT / "workflow/environment.sh", cwd=folder, PATH=path, PYTHON=python)


@pytest.mark.parametrize(
    "fails", ["exit 1", "kill -TERM $PPID; exit 1", 'case "$*" in *-ed*) exit 1; esac']
)
def test_an_environment_that_cannot_be_made_leaves_the_old_one(tmp_path: Path, fails: str) -> None:
    (tmp_path / ".venv").mkdir()
    (tmp_path / ".venv/mine").write_text("mine")
    found = made(tmp_path, fails)
    assert found.returncode != 0
    assert found.stderr.endswith("The environment .venv could not be made; it is as it was.\n")
    assert [path.name for path in (tmp_path / ".venv").iterdir()] == ["mine"]
    assert not (tmp_path / ".venv.old").exists()


def test_a_new_environment_takes_the_place_of_the_old_one(tmp_path: Path) -> None:
    (tmp_path / ".venv").mkdir()
    (tmp_path / ".venv/mine").write_text("mine")
    assert made(tmp_path, "").returncode == 0
    assert {path.name for path in (tmp_path / ".venv").iterdir()} == {"bin", "study.ready"}
    assert not (tmp_path / ".venv.old").exists()
    calls = (tmp_path / "calls").read_text().splitlines()
    assert calls[-1] == "install --quiet --no-deps --no-build-isolation --editable ."


@pytest.mark.parametrize(("status", "pip_too"), [(0, False), (1, True)])
def test_uv_installs_and_pip_where_it_cannot(tmp_path: Path, status: int, pip_too: bool) -> None:
    assert made(tmp_path, "", uv=UV.format(status=status)).returncode == 0
    calls = (tmp_path / "calls").read_text().splitlines()
    (by_uv,) = (line for line in calls if line.startswith("uv "))
    assert "--require-hashes --requirement requirements/study.txt" in by_uv
    by_pip = "install --quiet --require-hashes --requirement requirements/study.txt"
    assert (by_pip in calls) == pip_too


def test_a_python_that_is_not_there_is_named() -> None:
    found = ran("sh", ROOT / "workflow/system.sh", PYTHON="no-such-python")
    assert found.returncode == 1
    assert found.stderr == "PYTHON=no-such-python: there is no such program\n"


FULL = Path("/dev/full")


@pytest.mark.long
@pytest.mark.parametrize("form", ["table", "csv"])
def test_output_that_finds_no_room_ends_with_one_line(form: str) -> None:
    words = (sys.executable, "-c", PROGRAM, "law", "-n", "3", "--format", form)
    found = ran("sh", "-c", f'"$@" > {FULL}', "sh", *words)
    assert (found.returncode, found.stderr) == (2, "Error: No space left on device\n")


@pytest.mark.long
@pytest.mark.parametrize(("option", "name"), [("--picture", "drawn.svg"), ("--note", "n.html")])
def test_a_file_that_finds_no_room_is_named(option: str, name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.symlink_to(FULL)
    found = python("-c", PROGRAM, "capacity", "-n", "3", "-m", "law", option, path)
    assert found.returncode == 2
    assert found.stderr.splitlines()[-1] == f"Error: {option} {path}: No space left on device"


def refusing(number: int) -> object:
    """A lock of files on a file system that has none."""

    def flock(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    return flock


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_without_locks_a_study_goes_on_and_says_so(
    number: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(fcntl, "flock", refusing(number))
    with workflow_command.lock(tmp_path / "results") as stream:
        assert not stream.closed
    said = capsys.readouterr().err
    assert said.startswith(f"{tmp_path / 'results'}: its file system has no locks")
    assert said.count("\n") == 1


def test_a_lock_that_cannot_be_written_is_an_error_of_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / workflow_command.LOCK).symlink_to(FULL)
    with pytest.raises(CallError, match="cannot be written to: "):
        workflow_command.lock(tmp_path)
    monkeypatch.setattr(fcntl, "flock", refusing(errno.EIO))
    with pytest.raises(CallError, match="cannot be written to: input/output error"):
        workflow_command.lock(tmp_path / "results")
