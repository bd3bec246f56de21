"""A full disk, and file systems without locks: an answer or one line."""

import errno
import fcntl
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

from workflow import command as workflow_command
from workflow.configuration import CallError

FULL = Path("/dev/full")


def command(*words: str, **streams: int) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own."""
    code = "from sidmacib.command import run; run()"
    return subprocess.run(
        [sys.executable, "-c", code, *words],
        check=False,
        text=True,
        stderr=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        **streams,
    )


@pytest.mark.parametrize("form", ["table", "csv"])
def test_output_that_finds_no_room_ends_with_one_line(form: str) -> None:
    with FULL.open("w") as full:
        found = command("law", "-n", "3", "--format", form, stdout=full.fileno())
    assert (found.returncode, found.stderr) == (1, "Error: No space left on device\n")


@pytest.mark.parametrize("option", ["--picture", "--note"])
def test_a_file_that_finds_no_room_is_named_in_one_line(option: str, tmp_path: Path) -> None:
    path = tmp_path / "drawn.svg"
    path.symlink_to(FULL)
    words = ("capacity", "-n", "3", "-m", "law", option, str(path))
    found = command(*words, stdout=subprocess.DEVNULL)
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


def test_a_lock_that_fails_otherwise_is_an_error_of_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fcntl, "flock", refusing(errno.EIO))
    with pytest.raises(CallError, match="cannot be written to: input/output error"):
        workflow_command.lock(tmp_path / "results")


def test_a_lock_that_finds_no_room_is_an_error_of_one_line(tmp_path: Path) -> None:
    (tmp_path / workflow_command.LOCK).symlink_to(FULL)
    with pytest.raises(CallError, match="cannot be written to: "):
        workflow_command.lock(tmp_path)
