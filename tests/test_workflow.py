"""The workflow as a user runs it: whole studies, small ones."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
import yaml
from conftest import ROOT
from test_decks import returned

from workflow.configuration import read_study
from workflow.threedec import decks

SMALL = {
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.03],
    "dem": {"engines": ["yade"]},
    "eccentricities": [0, 0.5, "torsion"],
    "variants": {"soft": {"failure": "ductile", "eccentricities": [0]}},
}
CASES = {"n3-mesh0.03-e0a", "n3-mesh0.03-e0.5a", "n3-mesh0.03-torsion", "n3-mesh0.03-e0a-soft"}


class Workspace:
    """A folder with a configuration, in which snakemake is run."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.configure()

    def configure(self, **change: object) -> None:
        (self.folder / "study.yaml").write_text(yaml.safe_dump({**SMALL, **change}))

    def snakemake(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [
                *(sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")),
                *("--directory", str(self.folder), "--configfile", "study.yaml"),
                *("--profile", str(ROOT / "profiles/default"), *arguments),
            ],
            check=False,
            cwd=self.folder,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=600,
        )

    def planned(self) -> set[str]:
        """Jobs that a run would do: rule names, cases for the engine's own rule."""
        found = self.snakemake("--dry-run", "--printshellcmds").stdout
        jobs = set(re.findall(r"\b(?:Run yade on|Render|Draw) ([\w.-]+)", found))
        words = {"Read the locks' weights": "weights", "Solve SiDMACIB": "capacity"}
        words |= {"Fit SiDMACIB": "fit", "Compare with": "validation", "Sum up": "summary"}
        return jobs | {name for text, name in words.items() if text in found}


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path)


def test_a_dry_run_plans_every_case_table_and_figure(workspace: Workspace) -> None:
    planned = workspace.planned()
    assert planned >= CASES | {"weights", "capacity", "fit", "validation", "summary"}
    assert planned >= {"options-n3", "revised-n3", "meshes", "side_by_side"}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"geomtry": {"a": 0.06}}, "geomtry: unknown key; the keys here are results, samples"),
        ({"geometry": {"a": -0.06}}, "geometry.a: -0.06 is not allowed; it must be greater than 0 (m)"),
        ({"overrides": {"n3-mesh0.3": {}}}, "overrides: 'n3-mesh0.3' is no case; it must be one of the study's"),
    ],
)
def test_a_typo_is_rejected_before_anything_runs(
    workspace: Workspace, change: dict[str, object], message: str
) -> None:
    workspace.configure(**change)
    found = workspace.snakemake()
    assert found.returncode != 0
    assert message in found.stdout + found.stderr
    assert "Traceback" not in found.stderr
    assert not (workspace.folder / "results").exists()


@pytest.mark.engine
def test_a_small_study_end_to_end(workspace: Workspace) -> None:
    # Everything runs, once.
    found = workspace.snakemake()
    assert found.returncode == 0, found.stderr
    results = workspace.folder / "results"
    columns = pd.read_csv(results / "tables/capacity.csv").columns
    assert columns[:7].tolist() == [
        *("model", "variant", "locks", "mesh_m", "eccentricity_m", "shear_N", "torque_Nm")
    ]
    weights = pd.read_csv(results / "tables/weights.csv")
    assert weights.columns[:9].tolist() == [
        *("model", "locks", "mesh_m", "eccentricity_m", "lock", "block"),
        *("weight", "mean_shear_ratio", "max_shear_ratio"),
    ]
    # The static model leaves the ductile variant to the others.
    assert len(weights) == 3 * (len(CASES) + len(CASES - {"n3-mesh0.03-e0a-soft"}) + len(CASES))
    assert "Published against computed" in (results / "summary.txt").read_text()
    figures = {path.name for path in (results / "figures").iterdir()}
    assert {"side_by_side.png", "side_by_side.pdf", "torsion_stress-n3.png"} <= figures
    assert all((results / "figures" / name).stat().st_size > 5000 for name in figures)

    # A second run does nothing.
    assert "Nothing to be done" in workspace.snakemake().stderr

    # Asking for one case that is there does nothing; asking for one that is lost runs just that.
    lost = results / "cases/yade/n3-mesh0.03-e0.5a/result.json"
    before = lost.read_bytes()
    lost.unlink()
    assert workspace.snakemake(str(lost.relative_to(workspace.folder))).returncode == 0
    assert lost.read_bytes() == before

    # Editing one case plans that case and what aggregates it, nothing else.
    workspace.configure(overrides={"n3-mesh0.03-torsion": {"ramp_periods": 42}})
    planned = workspace.planned()
    assert planned & CASES == {"n3-mesh0.03-torsion"}
    assert planned >= {"weights", "capacity", "fit", "validation", "summary"}
    workspace.configure()

    # A lost table is made again; changed stresses run what is read from them, and nothing else.
    (results / "tables/fit.csv").unlink()
    assert workspace.planned() >= {"fit", "validation", "summary"}
    assert workspace.snakemake().returncode == 0
    nodes = results / "cases/yade/n3-mesh0.03-e0a/nodes.csv"
    nodes.write_text(nodes.read_text() + "\n")
    planned = workspace.planned()
    assert planned >= {"weights", "capacity", "fit"}
    assert not planned & CASES

    # Another time limit runs nothing.
    workspace.snakemake()
    workspace.configure(dem={"engines": ["yade"], "time_limit": 500})
    assert workspace.planned() == set()
    workspace.configure()

    # The same results again, to the byte.
    figure = results / "figures/revised-n3.pdf"
    tables = {path: path.read_bytes() for path in [*(results / "tables").iterdir(), figure]}
    assert workspace.snakemake("--forceall").returncode == 0
    assert {path: path.read_bytes() for path in tables} == tables


def test_a_study_without_engines_has_the_static_model_in_their_place(workspace: Workspace) -> None:
    workspace.configure(dem={"engines": []}, eccentricities=[0, 0.5])
    found = workspace.snakemake()
    assert found.returncode == 0, found.stderr
    results = workspace.folder / "results"
    assert {path.name for path in (results / "cases").iterdir()} == {"static", "limit"}
    assert set(pd.read_csv(results / "tables/fit.csv")["model"]) == {"static"}
    assert "SiDMACIB against static" in (results / "summary.txt").read_text()
    assert (results / "figures/shear_stress-n3.png").stat().st_size > 5000


def test_what_came_back_from_3dec_stands_beside_the_other_models(workspace: Workspace) -> None:
    change: dict[str, object] = {"dem": {"engines": []}, "eccentricities": [0], "variants": {}}
    workspace.configure(**change)
    case = decks(read_study({**SMALL, **change}))["n3-mesh0.03-e0a"]
    folder = workspace.folder / "results/decks/3dec/n3-mesh0.03-e0a"
    folder.mkdir(parents=True)
    (folder / "results.txt").write_text(returned(case, 245.5))
    found = workspace.snakemake()
    assert found.returncode == 0, found.stderr
    capacity = pd.read_csv(workspace.folder / "results/tables/capacity.csv")
    assert capacity.loc[capacity["model"] == "3dec", "shear_N"].tolist() == [245.5]
    assert "static, limit, 3dec" in (workspace.folder / "results/summary.txt").read_text()


@pytest.mark.engine
def test_a_case_that_fails_shows_its_log_and_the_others_go_on(
    workspace: Workspace, tmp_path: Path
) -> None:
    fake = tmp_path / "fake-python"
    fake.write_text(
        "#!/bin/sh\nif grep -q torsion joint.py; then echo engine broke down; exit 7; fi\n"
        'exec /usr/bin/python3 "$@"\n'
    )
    fake.chmod(0o755)
    found = workspace.snakemake(YADE_PYTHON=str(fake))
    assert found.returncode != 0
    assert "n3-mesh0.03-torsion: yade ended with exit code 7" in found.stderr
    assert "| engine broke down" in found.stderr
    cases = workspace.folder / "results/cases/yade"
    done = {path.parent.name for path in cases.glob("*/result.json")}
    assert done == CASES - {"n3-mesh0.03-torsion"}
    assert not (workspace.folder / "results/summary.txt").exists()


def test_a_study_without_its_engine_says_what_to_install(workspace: Workspace) -> None:
    found = workspace.snakemake(
        "results/cases/yade/n3-mesh0.03-e0a/result.json", YADE_PYTHON="/no/such/python"
    )
    assert found.returncode != 0
    assert "yade: not installed; on Debian: apt-get install yade" in found.stderr
