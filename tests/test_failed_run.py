"""What a run that fails leaves on the screen."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT
from test_workflow import SOLVED, Workspace

pytestmark = pytest.mark.study


@pytest.mark.engine
def test_a_run_that_fails_shows_no_summary_of_an_earlier_one(
    tmp_path: Path,
) -> None:
    solved = Workspace(tmp_path / "study")
    solved.configure({**SOLVED, "eccentricities": [0]})
    earlier = ("results/summary.txt", "results/report.html")
    assert _states(solved) == {"static": "to do"}
    assert solved.snakemake(*earlier).returncode == 0
    assert _states(solved) == {"static": "done"}
    engine = tmp_path / "kills-its-job"
    engine.write_text("#!/bin/sh\nkill -KILL $PPID\n")
    engine.chmod(0o755)
    solved.configure({**SOLVED, "dem": {"engines": ["yade"]}, "eccentricities": [0]})
    command = [sys.executable, "-m", "workflow", "study", str(solved.folder / "study.yaml")]
    found = subprocess.run(
        [*command, f"--results={solved.results}"],
        check=False,
        cwd=ROOT,
        env={**os.environ, "YADE_PYTHON": str(engine)},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert found.returncode == 1
    assert found.stdout == ""
    assert found.stderr.splitlines()[-1] == f"{solved.results}: the study is incomplete, see above"
    assert "n3-mesh0.03-e0a" in found.stderr
    assert _states(solved, YADE_PYTHON=str(engine))["yade"] == "to do"  # none was written


def _states(study: Workspace, **environment: str) -> dict[str, str]:
    """States of the cases of a study by model, as `make cases` prints them."""
    asked = ["cases", str(study.folder / "study.yaml"), f"--results={study.results}"]
    found = subprocess.run(
        [sys.executable, "-m", "workflow", *asked, "--format", "csv"],
        check=True,
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    return {row["model"]: row["state"] for row in csv.DictReader(found.stdout.splitlines())}
