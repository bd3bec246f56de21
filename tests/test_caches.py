"""Runs where the home folder or the checkout cannot be written to."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from campaigns.faults import AS_ANYBODY, not_writable
from conftest import ROOT

from workflow.run.results_folder import CACHES

STUDY = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.03],
    "eccentricities": [0],
    "models": ["static"],
    "dem": {"engines": []},
}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    folder = tmp_path / "checkout"
    for name in ("sidmacib", "workflow", "analysis", "templates", "profiles"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Snakefile", "config.yaml"):
        shutil.copy(ROOT / name, folder)
    (tmp_path / "home").mkdir()
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    return folder


def run(
    checkout: Path, place: Path, folder: Path | None = None, **more: str
) -> subprocess.CompletedProcess[str]:
    """One case of a study of that checkout, in the working directory ``place``.

    ``folder``: with the study and a home; by default the one that the checkout is in.
    """
    folder = folder or checkout.parent
    environment = {name: value for name, value in os.environ.items() if name not in CACHES}
    options = (str(folder / "study.yaml"), f"--results={folder / 'results'}")
    command = (sys.executable, "-m", "analysis", "case", *options, "--case=n3-mesh0.03-e0a")
    return subprocess.run(
        [*(AS_ANYBODY if os.getuid() == 0 else ()), *command],
        check=False,
        cwd=place,
        env={**environment, "HOME": str(folder / "home"), "PYTHONPATH": str(checkout), **more},
        capture_output=True,
        text=True,
        timeout=600,
    )


@pytest.mark.study
def test_a_home_and_a_checkout_that_are_read_only_do_not_matter(
    checkout: Path, tmp_path: Path
) -> None:
    (tmp_path / "work").mkdir()
    with not_writable(tmp_path / "home"), not_writable(checkout):
        found = run(checkout, tmp_path / "work")
    assert found.returncode == 0, found.stderr
    assert "Traceback" not in found.stderr
    assert (tmp_path / "results/.cache").is_dir()
    assert not [*(tmp_path / "home").iterdir()]


def test_a_working_directory_that_is_read_only_is_named_in_a_line(checkout: Path) -> None:
    with not_writable(checkout):
        found = run(checkout, checkout)
    assert found.returncode == 1
    words = f"the working directory: {checkout} cannot be written to: permission denied"
    assert found.stderr.splitlines() == [words]


@pytest.mark.study
def test_a_profile_of_other_workflows_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(STUDY))
    for name in ("home", "mine"):
        (tmp_path / name).mkdir()
    (tmp_path / "mine/config.yaml").write_text("dry-run: true\n")
    found = run(ROOT, tmp_path, tmp_path, SNAKEMAKE_PROFILE=str(tmp_path / "mine"))
    assert found.returncode == 0, found.stderr
    assert "first failure: V = " in found.stdout
