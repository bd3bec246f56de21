"""Compiled functions: none is kept after a change of one that it calls."""

import shutil
import subprocess
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest

import sidmacib
from sidmacib.answers.in_time import TimeAnswer
from sidmacib.answers.joint import quick_path
from sidmacib.dynamics import precompiled as in_time
from sidmacib.joint import Hold
from sidmacib.joint.loading import Loading
from sidmacib.mechanics import compilation
from sidmacib.mechanics.precompiled import signatures
from sidmacib.structure.files.structure_file import demands_of
from sidmacib.yaml_text import read_yaml

INNER = """from kernels.compilation import compiled

@compiled
def doubled(value):
    return FACTOR * value
"""
OUTER = """from kernels.compilation import compiled
from kernels.inner import doubled

@compiled
def applied(value):
    return doubled(value)
"""


@pytest.fixture
def kernels(tmp_path: Path) -> Path:
    """A package of compiled functions."""
    package = tmp_path / "kernels"
    package.mkdir()
    (package / "__init__.py").touch()
    shutil.copy(compilation.__file__, package)
    (package / "outer.py").write_text(OUTER)
    (package / "inner.py").write_text(INNER.replace("FACTOR", "2.0"))
    return package


@pytest.mark.long
def test_a_change_in_another_file_is_noticed(kernels: Path) -> None:
    assert answer(kernels) == answer(kernels) == "6.0"
    (kernels / "inner.py").write_text(INNER.replace("FACTOR", "5.0"))
    assert answer(kernels) == "15.0"


def test_what_is_compiled_ahead_is_what_the_static_model_calls() -> None:
    joint = sidmacib.Joint(3, hold_down=sidmacib.HoldDown(Hold.WEIGHT))
    for each in (joint, replace(joint, elastic=sidmacib.Elastic(2e10))):
        with suppress(sidmacib.CapacityError):
            quick_path(each, Loading(sidmacib.Direction(0.3)))
    called = {f: set(f.signatures) for f in signatures() if f.signatures}
    assert len(called) >= 6
    for function, given in called.items():
        assert given == {signatures()[function]}, function.py_func.__name__


def test_what_is_compiled_ahead_is_what_the_model_in_time_calls() -> None:
    folder = Path(__file__).parents[1] / "studies/time"
    description = read_yaml(folder / "arch.yaml")
    description["load"]["duration"] = 0.05
    TimeAnswer.of(demands_of(description, folder, in_time=True)[0].problem)
    ((function, given),) = in_time.signatures().items()
    assert set(function.signatures) == {given}


def answer(kernels: Path, before: str = "", **environment: str) -> str:
    """What the outer function makes of 3 in a process without a home; ``before``: code."""
    code = f"{before}\nfrom kernels.outer import applied; print(applied(3.0))"
    done = subprocess.run(
        [sys.executable, "-B", "-c", code],
        check=False,
        capture_output=True,
        text=True,
        env={"PYTHONPATH": str(kernels.parent), **environment},
        cwd="/",
    )
    assert not done.stderr, done.stderr
    return done.stdout.strip()


@pytest.mark.long
def test_without_a_folder_to_write_to_they_are_compiled_for_the_process(kernels: Path) -> None:
    (kernels / "__pycache__").touch()  # a file where numba's folder would be
    assert answer(kernels, HOME="/dev/null", NUMBA_CACHE_DIR="/dev/null") == "6.0"
    assert not list(kernels.rglob("*.nb?"))


@pytest.mark.long
def test_where_nothing_can_be_written_the_answer_is_given(kernels: Path, tmp_path: Path) -> None:
    full = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))"
    assert answer(kernels, full, NUMBA_CACHE_DIR=str(tmp_path / "c")) == "6.0"
    assert not list(tmp_path.rglob("*.nb?"))


@pytest.mark.long
def test_a_file_that_was_cut_off_is_compiled_again(kernels: Path) -> None:
    assert answer(kernels) == "6.0"
    kept = list(kernels.rglob("*.nb?"))
    assert kept
    for path in kept:
        path.write_bytes(path.read_bytes()[:40])
    assert answer(kernels) == "6.0"
