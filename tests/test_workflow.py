"""The workflow as a user runs it, with small studies."""

import csv
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest
import yaml
from conftest import ROOT
from processes import python, ran
from small import COARSE
from test_record import returned

from workflow.__main__ import forget_failures
from workflow.cases import cases_of
from workflow.configuration import read_study
from workflow.results import RECORD
from workflow.threedec import decks

pytestmark = pytest.mark.study

SMALL = COARSE | {"dem": {"engines": ["yade"]}}
SMALL["variants"] = {"soft": {"failure": "ductile", "eccentricities": [0]}}
SOLVED = COARSE | {"eccentricities": [0, 0.5]}
OF_CASES = ("engine", "solve", "returned")  # rules
CASES = {"n3-mesh0.03-e0a", "n3-mesh0.03-e0.5a", "n3-mesh0.03-torsion", "n3-mesh0.03-e0a-soft"}
TABLES = {"collect", "capacity", "comparisons", "figures", "summary", "report", "complete"}


class Workspace:
    """A folder with a configuration, in which snakemake is run."""

    def __init__(self, folder: Path, checkout: Path = ROOT) -> None:
        self.folder, self.checkout = folder, checkout
        folder.mkdir(parents=True, exist_ok=True)
        self.configure(SMALL)

    def configure(self, config: dict[str, object]) -> None:
        (self.folder / "study.yaml").write_text(yaml.safe_dump(config))

    def command(self, *arguments: str) -> list[str]:
        return [
            *(sys.executable, "-m", "snakemake", "--snakefile", str(self.checkout / "Snakefile")),
            *("--directory", str(self.folder), "--configfile", "study.yaml"),
            *("--profile", str(self.checkout / "profiles/default"), *arguments),
        ]

    def snakemake(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        return ran(*self.command(*arguments), cwd=self.folder, **environment)

    def planned(self) -> set[str]:
        """What a run would make: cases and batches by name, and what comes after by rule."""
        found = self.snakemake("--summary")
        assert found.returncode == 0, found.stderr
        rows = csv.DictReader(found.stdout.splitlines(), delimiter="\t")
        return {
            Path(row["output_file"]).parent.name if row["rule"] in OF_CASES else row["rule"]
            for row in rows
            if row["plan"] != "no update"
        }

    @property
    def results(self) -> Path:
        return self.folder / "results"


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path)


@pytest.fixture(scope="module")
def solved_once(made_once: Callable[..., Path]) -> Path:
    """A study without engines that was run."""

    def solve(folder: Path) -> None:
        workspace = Workspace(folder)
        workspace.configure(SOLVED)
        found = workspace.snakemake()
        assert found.returncode == 0, found.stderr

    return made_once("solved", solve)


@pytest.fixture
def solved(solved_once: Path, tmp_path: Path) -> Workspace:
    """A copy of a study without engines that was run."""
    folder = tmp_path / "copy"
    shutil.copytree(solved_once, folder)
    copy = Workspace(folder)
    copy.configure(SOLVED)
    return copy


# --- planning ------------------------------------------------------------------------------------
def test_a_dry_run_plans_every_case_and_table_and_writes_nothing(workspace: Workspace) -> None:
    assert workspace.snakemake("--dry-run").returncode == 0
    assert workspace.planned() == CASES | {"batch"} | TABLES
    assert not workspace.results.exists()


@pytest.mark.parametrize(("snakefile", "target"), [("", "all"), ("workflow", "study")])
def test_the_rule_graph_names_the_rules(workspace: Workspace, snakefile: str, target: str) -> None:
    """Also from the Snakefile at the place where catalogues of workflows look for it."""
    path = str(workspace.checkout / snakefile / "Snakefile")
    found = workspace.snakemake("--snakefile", path, "--rulegraph")
    assert found.returncode == 0, found.stderr
    named = set(re.findall(r'label = "(\w+)"', found.stdout))
    assert named == {target, "engine", "solve"} | TABLES
    assert not workspace.results.exists()


def test_a_fault_is_reported_before_anything_runs(workspace: Workspace) -> None:
    workspace.configure({**SMALL, "geometry": {"a": -0.06}})
    found = workspace.snakemake()
    assert found.returncode != 0
    assert "geometry.a: -0.06 is not allowed" in found.stdout + found.stderr
    assert "Traceback" not in found.stderr
    assert not workspace.results.exists()


# --- a study without engines ---------------------------------------------------------------------
def test_a_study_without_engines_has_the_static_model_in_their_place(solved: Workspace) -> None:
    assert {path.name for path in (solved.results / "cases").iterdir()} == {"static"}
    assert set(pd.read_csv(solved.results / "tables/fit.csv")["model"]) == {"static"}
    assert (solved.results / "figures/shear_stress-n3.png").stat().st_size > 5000
    assert solved.planned() == set()


def test_snakemakes_own_report_has_figures_and_tables_with_captions(solved: Workspace) -> None:
    found = solved.snakemake("--report", "own.html")
    assert found.returncode == 0, found.stderr
    text = (solved.folder / "own.html").read_text()
    shown = ("Figures", "Tables", "side_by_side.png", "capacity.csv", "what is assumed")
    said = ("Click a rule of the graph", '"rule": "comparisons"', "Solve a batch of cases")
    assert [words for words in (*shown, *said) if words not in text] == []


@pytest.mark.parametrize("config", ["config.yaml", "studies/locks/config.yaml"])
def test_the_linter_finds_only_that_rules_share_one_environment(config: str) -> None:
    """And that functions stand beside the rules whose cases they look up."""
    found = python("-m", "snakemake", "--lint", "--configfile", config)
    lints = set(re.findall(r"^ {4}\* (.*)$", found.stdout + found.stderr, re.MULTILINE))
    assert lints == {
        "Specify a conda environment or container for each rule.:",
        "Mixed rules and functions in same snakefile.:",
    }


def test_a_case_that_was_solved_in_a_batch_has_its_own_files_on_request(solved: Workspace) -> None:
    name = "n3-mesh0.03-e0.5a"
    found = solved.snakemake(f"results/cases/static/{name}/result.json")
    assert found.returncode == 0, found.stderr
    folder = solved.results / f"cases/static/{name}"
    result = json.loads((folder / "result.json").read_text())
    capacity = pd.read_csv(solved.results / "tables/capacity.csv")
    row = capacity[(capacity["model"] == "static") & (capacity["case"] == name)].iloc[0]
    assert result["peak_load_N"] == pytest.approx(row["load_N"], rel=1e-9)
    assert len(pd.read_csv(folder / "nodes.csv")) > 20
    assert pd.read_csv(folder / "history.csv")["load_N"].is_monotonic_increasing


def test_what_came_back_from_3dec_stands_beside_the_other_models(workspace: Workspace) -> None:
    config = {**SOLVED, "models": ["static", "limit"], "eccentricities": [0]}
    workspace.configure(config)
    study = read_study(config)
    case = decks(study, cases_of(study).values())["n3-mesh0.03-e0a"]
    folder = workspace.results / "decks/3dec/n3-mesh0.03-e0a"
    folder.mkdir(parents=True)
    (folder / "results.txt").write_text(returned(case, 245.5))
    found = workspace.snakemake("results/summary.txt")
    assert found.returncode == 0, found.stderr
    capacity = pd.read_csv(workspace.results / "tables/capacity.csv")
    assert capacity.loc[capacity["model"] == "3dec", "shear_N"].tolist() == [245.5]
    text = (workspace.results / "summary.txt").read_text()
    heads = re.findall(r"^(.+), mesh 0.03 m: V", text, re.M)
    assert heads == ["Static model", "Limit analysis", "3DEC"]
    # What came back is wrong now: it is named, and everything else is there.
    (folder / "results.txt").write_text(returned(case, float("inf")))
    workspace.snakemake("results/summary.txt")
    text = (workspace.results / "summary.txt").read_text()
    words = "WITHOUT A RESULT: 1 of 5 cases\n  n3-mesh0.03-e0a (3dec): 3dec: peak"
    assert text.startswith(words)


# --- with an engine ------------------------------------------------------------------------------
@pytest.mark.engine
def test_a_small_study_end_to_end(workspace: Workspace) -> None:
    # Everything runs, once.
    found = workspace.snakemake()
    assert found.returncode == 0, found.stderr
    results = workspace.results
    weights = pd.read_csv(results / "tables/weights.csv")
    # The static model runs at half the mesh too.
    assert len(weights) == 3 * (len(CASES) + 2 * len(CASES))
    cases = pd.read_csv(results / "tables/cases.csv").set_index(["model", "name"])
    assert cases["error"].isna().all()
    held = cases.loc["yade", "difference_to_static"]
    assert held.notna().all()
    assert held.abs().max() < 0.01
    assert cases.loc["yade", "mesh_error"].notna().all()
    brittle = cases.loc["yade"].drop("n3-mesh0.03-e0a-soft")
    assert set(brittle["mode"]) == set(cases.loc["static", "mode"]) == {"bonds"}
    assert cases.loc["yade", "versions"].str.startswith("yade ").all()
    assert "Published against computed" in (results / "summary.txt").read_text()
    figures = {path.name for path in (results / "figures").iterdir()}
    assert {"side_by_side.png", "side_by_side.pdf", "torsion_stress-n3.png"} <= figures
    assert all((results / "figures" / name).stat().st_size > 5000 for name in figures)

    # A second run does nothing.
    assert workspace.planned() == set()

    # Editing one case plans that case and what aggregates it, nothing else.
    workspace.configure({**SMALL, "overrides": {"n3-mesh0.03-torsion": {"ramp_periods": 42}}})
    assert workspace.planned() == {"n3-mesh0.03-torsion"} | TABLES

    # Another case asks the engine for no other one.
    workspace.configure({**SMALL, "eccentricities": [0, 0.5, 0.7, "torsion"]})
    assert workspace.planned() == {"n3-mesh0.03-e0.7a", "batch"} | TABLES

    # Another time limit only makes the report, which shows the configuration; going back nothing.
    workspace.configure({**SMALL, "dem": {"engines": ["yade"], "time_limit": 500}})
    assert workspace.planned() == {"report"}
    workspace.configure(SMALL)
    assert workspace.planned() == set()

    # One case whose result is gone is made again, with the same bytes, and asked for alone.
    target = "results/cases/yade/n3-mesh0.03-e0.5a/result.json"
    nodes = results / "cases/yade/n3-mesh0.03-e0.5a/nodes.csv"
    before = nodes.read_bytes()
    (workspace.folder / target).unlink()
    nodes.unlink()
    assert workspace.snakemake(target).returncode == 0
    assert nodes.read_bytes() == before

    # The same results again, to the byte.
    figure = results / "figures/revised-n3.pdf"
    tables = {path: path.read_bytes() for path in [*(results / "tables").iterdir(), figure]}
    targets = [str(p.relative_to(workspace.folder)) for p in tables if p.suffix != ".parquet"]
    assert workspace.snakemake("--forceall", *targets).returncode == 0
    assert {path: path.read_bytes() for path in tables} == tables


@pytest.mark.engine
def test_a_failed_case_is_named_and_tried_again(workspace: Workspace) -> None:
    engine = workspace.folder / "breaks-down-in-torsion"  # in place of Python
    broken = "if grep -q torsion joint.py; then echo engine broke down; exit 7; fi"
    engine.write_text(f'#!/bin/sh\n{broken}\nexec /usr/bin/python3 "$@"\n')
    engine.chmod(0o755)
    workspace.configure({**SMALL, "eccentricities": [0, "torsion"], "variants": {}})
    found = workspace.snakemake(YADE_PYTHON=str(engine))
    assert found.returncode != 0
    reason = "n3-mesh0.03-torsion (yade): yade: ended with exit code 7: engine broke down"
    assert reason in found.stderr
    cases = pd.read_csv(workspace.results / "tables/cases.csv").set_index(["model", "name"])
    assert cases["error"].notna().sum() == 1
    assert reason in (workspace.results / "summary.txt").read_text()
    log = workspace.results / "logs/cases/yade/n3-mesh0.03-torsion.log"
    assert "| engine broke down" in log.read_text()
    assert (workspace.results / "figures/revised-n3.png").stat().st_size > 5000
    assert workspace.planned() == {"complete"}
    forget_failures(workspace.results, every=False)  # as `make study` does
    assert workspace.planned() == {"n3-mesh0.03-torsion"} | TABLES
    record = f"results/cases/yade/n3-mesh0.03-torsion/{RECORD}"
    assert workspace.snakemake(record).returncode == 0
    assert json.loads((workspace.folder / record).read_text())["error"] is None
    assert workspace.planned() == TABLES


@pytest.mark.engine
def test_a_run_that_fails_shows_no_summary_of_an_earlier_one(tmp_path: Path) -> None:
    study = Workspace(tmp_path / "study")
    study.configure({**SOLVED, "eccentricities": [0]})
    assert states(study) == {"static": "to do"}
    assert study.snakemake("results/summary.txt", "results/report.html").returncode == 0
    assert states(study) == {"static": "done"}
    engine = tmp_path / "kills-its-job"
    engine.write_text("#!/bin/sh\nkill -KILL $PPID\n")
    engine.chmod(0o755)
    study.configure({**SOLVED, "dem": {"engines": ["yade"]}, "eccentricities": [0]})
    found = asked(study, "study", YADE_PYTHON=str(engine))
    assert found.returncode == 1
    assert found.stdout == ""
    assert found.stderr.splitlines()[-1] == f"{study.results}: the study is incomplete, see above"
    assert "n3-mesh0.03-e0a" in found.stderr
    assert states(study, YADE_PYTHON=str(engine))["yade"] == "to do"  # none was written


def asked(study: Workspace, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """The command of the workflow, as `make` calls it."""
    place = (str(study.folder / "study.yaml"), f"--results={study.results}")
    return python("-m", "workflow", words[0], *place, *words[1:], **environment)


def states(study: Workspace, **environment: str) -> dict[str, str]:
    """States of the cases of a study by model, as `make cases` prints them."""
    printed = asked(study, "cases", "--format", "csv", **environment).stdout
    return {row["model"]: row["state"] for row in csv.DictReader(printed.splitlines())}
