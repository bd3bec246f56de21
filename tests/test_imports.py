"""What importing the package costs, and what it offers."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import sidmacib

HEAVY = {"cvxpy", "highspy", "clarabel", "scipy", "pandas", "pyarrow", "numba", "pydantic"} | {
    "matplotlib",
    "snakemake",
    "jinja2",
    "yaml",
}
DESCRIPTION = (
    *("errors", "joint", "joint.pieces", "joint.loading", "validation"),
    "contact_points",
    *("mechanics.assembly", "mechanics.equilibrium", "mechanics.contact_law"),
)


def loaded_by(code: str) -> set[str]:
    """Top-level modules that are loaded once ``code`` has run in a new interpreter."""
    show = "import sys; print(*{name.partition('.')[0] for name in sys.modules})"
    command = [sys.executable, "-c", f"{code}\n{show}"]
    return set(subprocess.run(command, check=True, capture_output=True, text=True).stdout.split())


@pytest.mark.parametrize(
    "code",
    [
        "import sidmacib; sidmacib.Joint; sidmacib.assemble; sidmacib.ContactOption",
        "; ".join(f"import sidmacib.{name}" for name in DESCRIPTION),
        "import sidmacib; dir(sidmacib)",
    ],
)
def test_describing_a_joint_loads_nothing_heavier_than_numpy(code: str) -> None:
    assert loaded_by(code) & HEAVY == set()


def test_solvers_are_loaded_with_the_first_programme() -> None:
    assert "cvxpy" in loaded_by("import sidmacib; sidmacib.capacity")


def test_every_public_name_is_there_and_listed() -> None:
    assert set(sidmacib.__all__) <= set(dir(sidmacib))
    for name in sidmacib.__all__:
        assert getattr(sidmacib, name) is not None


@pytest.mark.study
def test_type_checkers_know_the_types_of_public_names(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(
        "import sidmacib\nfrom sidmacib import Joint, assemble, limit_load\n"
        + "".join(f"sidmacib.{name}\n" for name in sidmacib.__all__)
        + "reveal_type(assemble(Joint(3), 0.02))\nreveal_type(sidmacib.Direction(0.5).shear)\n"
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "user.py"]
    environment = os.environ | {"MYPYPATH": str(ROOT)}
    skipped = ["--follow-imports=silent", "--ignore-missing-imports", "--cache-dir", ".cache"]
    found = subprocess.run(
        [*command, *skipped],
        cwd=tmp_path,
        env=environment,
        check=False,
        capture_output=True,
        text=True,
    ).stdout
    assert 'Revealed type is "sidmacib.mechanics.assembly.Assembly"' in found
    assert 'float"' in found
    assert "error" not in found
