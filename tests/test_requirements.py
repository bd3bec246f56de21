"""The packages that are installed: pinned, with digests, each of them used."""

import ast
import re
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = dict(PROJECT["optional-dependencies"])
STUDY = [*PROJECT["dependencies"], *EXTRAS.pop("study")]
LOCKS = {  # of extras that add to the study's packages
    "requirements.txt": STUDY,
    **{
        f"requirements-{extra}.txt": more
        for extra, more in EXTRAS.items()
        if not set(more) <= set(STUDY)
    },
}
PIN = re.compile(
    r"^([A-Za-z0-9._-]+)==(\S+)((?: ;[^\\]*)? \\\n(?:    --hash=\S+(?: \\)?\n)+)", re.M
)
# Used, but not by an import: programs, plugins of pytest and of a theme, an engine of pandas; and
# what builds this project.
NOT_IMPORTED = {
    *(
        "furo",
        "import-linter",
        "mypy",
        "myst-parser",
        "pytest-xdist",
        "ruff",
        "snakefmt",
        "sphinx-click",
        "sphinx-gallery",
        "types-pyyaml",
        "uv",
    ),
    *("cadquery-ocp-novtk", "highspy", "rhino3dm", "setuptools", "snakemake"),
    "snakemake-executor-plugin-slurm",
    "snakemake-logger-plugin-rich",
}


def pins(name: str) -> dict[str, str]:
    """Version of each package of a lock file."""
    return {canonicalize_name(pin[1]): pin[2] for pin in PIN.finditer((ROOT / name).read_text())}


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_file_has_digests_of_all_it_names(name: str) -> None:
    text = (ROOT / name).read_text()
    named = re.findall(r"^[A-Za-z0-9._-]+==", text, re.MULTILINE)
    assert len(named) == len(PIN.findall(text)) > 0


@pytest.mark.parametrize("name", LOCKS)
def test_a_lock_file_is_current(name: str) -> None:
    """It has all that the project asks for, in versions that it allows."""
    found = pins("requirements.txt") | pins(name)  # which it adds to
    for text in LOCKS[name]:
        wanted = Requirement(text)
        assert canonicalize_name(wanted.name) in found, f"{wanted.name}: run make lock"
        assert found[canonicalize_name(wanted.name)] in wanted.specifier, text


@pytest.mark.parametrize(
    "name", sorted(set(LOCKS) - {"requirements.txt", "requirements-installer.txt"})
)
def test_an_extra_adds_to_what_a_study_needs(name: str) -> None:
    assert "--requirement requirements.txt\n" in (ROOT / name).read_text()
    assert not pins("requirements.txt").keys() & pins(name).keys()


def _imported(*folders: str) -> set[str]:
    """Names of the packages that the files in ``folders`` import."""
    found: set[str] = set()
    for path in (path for folder in folders for path in (ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module.partition(".")[0])
    return found


def test_every_dependency_is_used() -> None:
    imported = _imported("sidmacib", "workflow", "analysis", "studies", "benchmarks", "tests")
    known = packages_distributions()
    used = {canonicalize_name(package) for name in imported for package in known.get(name, ())}
    asked = {
        canonicalize_name(Requirement(text).name)
        for texts in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
        for text in texts
    }
    used |= {canonicalize_name(name) for name in imported}  # of extras that are not installed
    assert asked - used - NOT_IMPORTED == set()
    assert not NOT_IMPORTED & used, "no exception is needed"


def test_the_library_needs_no_more_than_it_imports() -> None:
    """Who wants one number for one joint installs no workflow."""
    imported = _imported("sidmacib")
    known = packages_distributions()
    used = {canonicalize_name(package) for name in imported for package in known.get(name, ())}
    asked = {canonicalize_name(Requirement(text).name) for text in PROJECT["dependencies"]}
    used |= asked & imported  # a package of one module is not in `packages_distributions`
    assert asked - NOT_IMPORTED == used - {"multilock", "pydantic-core"}  # pydantic itself
