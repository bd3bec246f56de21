"""What the project says of itself to registries and archives, and the packages it installs."""

import ast
import json
import os
import re
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text())
CODEMETA = json.loads((ROOT / "codemeta.json").read_text())
ZENODO = json.loads((ROOT / ".zenodo.json").read_text())


def test_all_files_name_the_same_version_title_authors_licence_keywords_and_paper() -> None:
    assert PROJECT["version"] == CITATION["version"] == CODEMETA["version"]
    assert f"## {PROJECT['version']}" in (ROOT / "CHANGELOG.md").read_text()
    authors = [author["name"] for author in PROJECT["authors"]]
    assert authors == [author["name"] for author in CITATION["authors"]]
    assert authors == [author["name"] for author in CODEMETA["author"]]
    assert authors == [author["name"] for author in ZENODO["creators"]]
    assert CITATION["title"] == ZENODO["title"]
    assert PROJECT["description"] == CODEMETA["description"]
    assert PROJECT["license"] == CITATION["license"] == ZENODO["license"]
    assert CODEMETA["license"].endswith(f"/{PROJECT['license']}")
    keywords = PROJECT["keywords"]
    assert keywords == CITATION["keywords"] == CODEMETA["keywords"] == ZENODO["keywords"]
    doi = CITATION["references"][0]["doi"]
    assert PROJECT["urls"]["Published study"] == f"https://doi.org/{doi}"
    assert CODEMETA["referencePublication"]["@id"] == f"https://doi.org/{doi}"
    assert ZENODO["related_identifiers"][0]["identifier"] == doi
    assert CITATION["references"][0]["title"] == CODEMETA["referencePublication"]["name"]


@pytest.mark.study
def test_a_wheel_works_in_an_empty_environment(tmp_path: Path) -> None:
    """It has all modules of the library and none of the workflow, and gives the same numbers.

    Its first commands compile nothing, and it is tagged for the Python and platform of that code.
    """
    uv, environment = Path(sys.executable).with_name("uv"), tmp_path / "environment"

    def run(*command: str | Path) -> str:
        done = subprocess.run(
            command, cwd=tmp_path, env=clean, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    python = ("--python", sys.executable)
    run(uv, "build", "--wheel", "--no-build-isolation", *python, "--out-dir", tmp_path, ROOT)
    (wheel,) = tmp_path.glob("*.whl")
    python_tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    assert f"-{python_tag}-{python_tag}-linux_" in wheel.name
    with zipfile.ZipFile(wheel) as archive:
        modules = {name for name in archive.namelist() if name.endswith(".py")}
    assert modules == {str(p.relative_to(ROOT)) for p in (ROOT / "sidmacib").rglob("*.py")}
    run(uv, "venv", *python, environment)
    pins = ("--constraint", ROOT / "requirements/study.txt")
    run(uv, "pip", "install", "--python", environment / "bin/python", *pins, wheel)
    question = ("capacity", "-n", "5", "-e", "0.3", "-m", "limit", "-m", "yade")
    here = Path(sys.executable).with_name("multilock")
    assert run(environment / "bin/multilock", *question) == run(here, *question)
    kept = tmp_path / "kept"
    first = ("env", f"NUMBA_CACHE_DIR={kept}", environment / "bin/multilock")
    assert "static" in run(*first, "capacity", "-n", "3")
    assert "stands for 3 s" in run(*first, "assembly", ROOT / "studies/time/arch.yaml")
    assert not list(kept.rglob("*.nbc"))


def test_the_paper_claims_of_the_attack_what_its_table_has() -> None:
    table = (ROOT / "docs/tested.md").read_text().partition("numbers: attack -->")[2]
    rows = [line.split("|")[1:-1] for line in table.partition("<!-- end")[0].splitlines()[3:]]
    joints = sum(int(row[1].replace(",", "")) for row in rows)
    largest = max(float(row[4]) for row in rows)
    paper = (ROOT / "docs/paper/paper.md").read_text().replace("\n", " ")
    assert f"in {joints:,} joints with rigid blocks the largest ratio" in paper
    assert f"first failure was {largest}." in paper


def test_the_paper_claims_of_structures_what_their_tables_have() -> None:
    pages = (ROOT / "docs/structures.md").read_text(), (ROOT / "docs/howto/design.md").read_text()
    for row in (
        "| static model, 3DEC | 12 of 12 within 0.5° |",
        "| YADE, 3DEC | 12 of 12 within 0.5° |",
        "| relaxation with finite rotations, 3DEC | 12 of 12 within 1.5° |",
    ):
        assert row in pages[0]
    paper = " ".join((ROOT / "docs/paper/paper.md").read_text().split())
    assert "YADE finds all twelve within 0.5° and the static model within 0.2°" in paper
    assert "finite rotations finds all twelve within 1.5°" in paper
    assert "**8 locks, in 8 of the 305 interfaces**" in pages[1]
    assert "on which four locks do in the plastic model, gets eight" in paper


def test_the_paper_cites_what_its_references_have() -> None:
    cited = set(re.findall(r"@(\w+)", (ROOT / "docs/paper/paper.md").read_text()))
    listed = set(re.findall(r"^@\w+\{(\w+),", (ROOT / "docs/paper/paper.bib").read_text(), re.M))
    assert cited == listed


def test_github_runs_what_the_own_machine_runs() -> None:
    steps = yaml.safe_load((ROOT / ".github/workflows/test.yml").read_text())["jobs"]["test"]
    assert any(step.get("run") == "bash .ci/run" for step in steps["steps"])


def test_actions_are_pinned_by_their_digests() -> None:
    for path in (ROOT / ".github/workflows").glob("*.yml"):
        for used in re.findall(r"uses: (.*)", path.read_text()):
            assert re.fullmatch(r"[\w/-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", used), used


def test_only_what_was_built_and_checked_is_published_without_a_password() -> None:
    text = (ROOT / ".github/workflows/publish.yml").read_text()
    jobs = yaml.safe_load(text)["jobs"]
    runs = [step.get("run", "") for step in jobs["build"]["steps"]]
    assert any("twine check --strict" in run for run in runs)
    assert jobs["publish"]["needs"] == "build"
    assert jobs["publish"]["permissions"] == {"id-token": "write"}
    assert "secrets." not in text
    (built,) = (each for each in jobs["build"]["steps"] if each.get("run") == "python -m build")
    assert built["env"] == {"MULTILOCK_PRECOMPILE": "0"}  # PyPI takes no wheel for one machine


EXTRAS = dict(PROJECT["optional-dependencies"])
STUDY = [*PROJECT["dependencies"], *EXTRAS.pop("study")]
ADDED = {extra: more for extra, more in EXTRAS.items() if not set(more) <= set(STUDY)}
LOCKS = {"study": STUDY} | ADDED
PIN = re.compile(r"^([\w.-]+)==(\S+)((?: ;[^\\]*)? \\\n(?:    --hash=\S+(?: \\)?\n)+)", re.M)
# Used, but not by an import: programs, plugins of pytest and of a theme, an engine of pandas; and
# what builds this project.
NOT_IMPORTED = {
    *("furo", "import-linter", "mypy", "myst-parser", "pytest-xdist", "ruff", "snakefmt", "uv"),
    *("sphinx-click", "sphinx-gallery", "types-pyyaml", "cadquery-ocp-novtk", "highspy"),
    *("pyarrow", "rhino3dm", "setuptools", "snakemake", "snakemake-executor-plugin-slurm"),
    "snakemake-logger-plugin-rich",
}


def lock(name: str) -> str:
    return (ROOT / f"requirements/{name}.txt").read_text()


def pins(name: str) -> dict[str, str]:
    """Version of each package of a lock file."""
    return {canonicalize_name(pin[1]): pin[2] for pin in PIN.finditer(lock(name))}


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_file_is_current_and_has_digests_of_all_it_names(name: str) -> None:
    """It has all that the project asks for, in versions that it allows."""
    text = lock(name)
    named = re.findall(r"^[A-Za-z0-9._-]+==", text, re.MULTILINE)
    assert len(named) == len(PIN.findall(text)) > 0
    found = pins("study") | pins(name)  # which it adds to
    for wanted in map(Requirement, LOCKS[name]):
        assert canonicalize_name(wanted.name) in found, f"{wanted.name}: run make lock"
        assert found[canonicalize_name(wanted.name)] in wanted.specifier, wanted


@pytest.mark.parametrize("name", sorted(set(ADDED) - {"installer"}))
def test_an_extra_adds_to_what_a_study_needs(name: str) -> None:
    assert "--requirement study.txt\n" in lock(name)
    assert not pins("study").keys() & pins(name).keys()


def imported_by(*folders: str) -> tuple[set[str], set[str]]:
    """Names that the files in ``folders`` import, and the packages that have them."""
    found: set[str] = set()
    for path in (path for folder in folders for path in (ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    known = packages_distributions()
    return found, {canonicalize_name(each) for name in found for each in known.get(name, ())}


@pytest.mark.long
def test_every_dependency_is_used() -> None:
    folders = ("sidmacib", "workflow", "analysis", "studies", "benchmarks", "tests")
    imported, used = imported_by(*folders)
    asked = {
        canonicalize_name(Requirement(text).name)
        for texts in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
        for text in texts
    }
    used |= {canonicalize_name(name) for name in imported}  # of extras that are not installed
    assert asked - used - NOT_IMPORTED == set()
    assert not NOT_IMPORTED & used, "no exception is needed"


@pytest.mark.long
def test_the_library_needs_no_more_than_it_imports() -> None:
    """Who wants one number for one joint installs no workflow."""
    imported, used = imported_by("sidmacib")
    asked = {canonicalize_name(Requirement(text).name) for text in PROJECT["dependencies"]}
    used |= asked & imported  # a package of one module is not in `packages_distributions`
    assert asked - NOT_IMPORTED == used - {"multilock", "pydantic-core"}  # pydantic itself
