"""What importing the package costs, and what it offers; what quick answers and planning load."""

from pathlib import Path

import pytest
from processes import ROOT, python

import sidmacib

SOLVERS = {"cvxpy", "numba", "matplotlib", "pandas", "scipy"}
HEAVY = SOLVERS | {"highspy", "clarabel", "pyarrow", "pydantic", "snakemake", "jinja2", "yaml"}
DESCRIPTION = (
    *("errors", "joint", "joint.pieces", "joint.loading", "validation"),
    "contact_points",
    *("mechanics.assembly", "mechanics.equilibrium", "mechanics.contact_law"),
)


def loaded_by(code: str) -> set[str]:
    """Top-level modules that are loaded once ``code`` has run in a new interpreter."""
    show = "import sys; print(*{name.partition('.')[0] for name in sys.modules})"
    return set(python("-c", f"{code}\n{show}", check=True).stdout.split())


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


@pytest.mark.parametrize("module", ["workflow.cases", "workflow.case", "sidmacib.models"])
def test_planning_imports_no_solver_and_no_table(module: str) -> None:
    found = loaded_by(f"import {module}")
    assert not found & (SOLVERS | {"pyarrow", "jinja2"})
    assert module != "workflow.case" or "pydantic" not in found


@pytest.mark.parametrize(
    ("arguments", "seconds", "allowed"),
    [
        (["--help"], 0.4, set()),
        (["capacity", "-m", "safe", "-m", "law"], 1.0, {"scipy", "numba"}),
    ],
)
def test_a_quick_answer_loads_no_solver_of_others(
    arguments: list[str], seconds: float, allowed: set[str]
) -> None:
    code = (
        "import sys, time\nfrom sidmacib.command.main import main\n"
        "try: main(sys.argv[1:])\nexcept SystemExit as end: assert not end.code\n"
        "print(time.process_time(), *{m.partition('.')[0] for m in sys.modules}, file=sys.stderr)"
    )
    found = python("-c", code, *arguments, check=True, PYTHONPATH=str(ROOT))
    time, *loaded = found.stderr.split()
    assert SOLVERS & {*loaded} <= allowed
    assert float(time) < 4.0 * seconds  # a busy machine takes longer


def test_only_what_compiled_code_prints_meanwhile_is_dropped() -> None:
    code = """import ctypes
from sidmacib.mechanics.optimisation import silent
c = ctypes.CDLL(None)
print("before")
with silent():
    c.printf(b"noise in the buffer\\n")
    c.puts(b"more noise")
print("after")
c.puts(b"heard again")
"""
    printed = python("-c", code, check=True).stdout
    assert set(printed.split("\n")) == {"before", "after", "heard again", ""}


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
    strict = ("--strict", "--config-file=", "user.py", "--cache-dir", ".cache")
    skipped = ("--follow-imports=silent", "--ignore-missing-imports")
    found = python("-m", "mypy", *strict, *skipped, cwd=tmp_path, MYPYPATH=str(ROOT)).stdout
    assert 'Revealed type is "sidmacib.mechanics.assembly.Assembly"' in found
    assert 'float"' in found
    assert "error" not in found
