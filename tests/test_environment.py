"""The environment is made anew, or stays as it was."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from processes import ROOT, ran

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
def test_an_environment_that_cannot_be_made_leaves_the_one_that_is_there(
    tmp_path: Path, fails: str
) -> None:
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
def test_packages_are_installed_by_uv_and_by_pip_where_that_cannot(
    tmp_path: Path, status: int, pip_too: bool
) -> None:
    assert made(tmp_path, "", uv=UV.format(status=status)).returncode == 0
    calls = (tmp_path / "calls").read_text().splitlines()
    (by_uv,) = (line for line in calls if line.startswith("uv "))
    assert "--require-hashes --requirement requirements.txt" in by_uv
    by_pip = "install --quiet --require-hashes --requirement requirements.txt"
    assert (by_pip in calls) == pip_too


def test_a_python_that_is_not_there_is_named() -> None:
    found = ran("sh", ROOT / "workflow/system.sh", PYTHON="no-such-python")
    assert found.returncode == 1
    assert found.stderr == "PYTHON=no-such-python: there is no such program\n"
