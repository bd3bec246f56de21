"""The container: built from its recipe without a registry, and a study in it with both engines.

What its recipe starts from is made by debootstrap where it is not there. CONTAINER_OPTIONS may have
options of `buildah build`, such as for local mirrors.
"""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from campaigns.counts import tables_of
from conftest import ROOT
from small import BOTH, COARSE

BASE = "docker.io/library/debian:12-slim"
IMAGE, CONTAINER = "localhost/multilock-test", "multilock-test"
STUDY = COARSE | BOTH | {"models": ["static", "limit"], "eccentricities": [0, "torsion"]}
PLACE = "/study"  # in the container
pytestmark = [
    pytest.mark.machine,
    pytest.mark.skipif("MULTILOCK_MACHINE" not in os.environ, reason="make test-container sets it"),
    pytest.mark.skipif(os.geteuid() != 0, reason="debootstrap asks for root"),
    pytest.mark.skipif(shutil.which("buildah") is None, reason="buildah is not installed"),
]


def buildah(*words: str | Path) -> str:
    """Run it; returns what it prints."""
    found = subprocess.run(["buildah", *words], capture_output=True, text=True, check=False)
    assert found.returncode == 0, f"{words}: {found.stdout[-2000:]}{found.stderr[-2000:]}"
    return found.stdout.strip()


@pytest.fixture
def container(tmp_path: Path) -> Iterator[str]:
    """A container of the image that the recipe makes of the checkout as it was committed."""
    there = BASE in buildah("images", "--all", "--format", "{{.Name}}:{{.Tag}}").split()
    checkout = tmp_path / "checkout"
    subprocess.run(["git", "clone", "--quiet", ROOT, checkout], check=True)
    options = shlex.split(os.environ.get("CONTAINER_OPTIONS", ""))
    alone = ("--isolation", "chroot", "--pull-never", "--network", "host")
    try:
        if not there:
            root = tmp_path / "root"  # Debian's smallest system
            subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root], check=True)
            base = buildah("from", "scratch")
            buildah("add", base, root, "/")
            buildah("commit", "--rm", base, BASE)
        recipe = ("--file", checkout / "container/Containerfile")
        ignored = ("--ignorefile", checkout / "container/ignore")
        buildah("build", *alone, *options, *recipe, *ignored, "--tag", IMAGE, checkout)
        yield buildah("from", "--pull-never", "--name", CONTAINER, IMAGE)
    finally:
        made = (("rm", CONTAINER), ("rmi", IMAGE), *([] if there else [("rmi", BASE)]))
        for words in made:
            subprocess.run(["buildah", *words], capture_output=True, check=False)


def test_a_study_in_the_container_has_the_tables_of_here(container: str, tmp_path: Path) -> None:
    folder = tmp_path / "study"
    folder.mkdir()
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY))
    python = "/opt/multilock/.venv/bin/python"  # of the recipe's entry point
    study = ("-m", "workflow", "study", "study.yaml")
    inside = ("run", "--isolation", "chroot", "--volume", f"{folder}:{PLACE}")
    buildah(*inside, "--workingdir", PLACE, container, "--", python, *study, "--results=inside")
    here = [sys.executable, *study[:3], str(folder / "study.yaml"), f"--results={folder / 'here'}"]
    subprocess.run(here, cwd=ROOT, check=True)
    found, expected = (tables_of(folder / name) for name in ("inside", "here"))
    assert len(expected) > 5
    assert found == expected
