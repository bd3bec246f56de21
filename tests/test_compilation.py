"""Compiled functions: none is kept after a change of one that it calls."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from sidmacib.mechanics import compilation

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


def answer(folder: Path) -> str:
    """What the outer function makes of 3, in a new process."""
    code = "from kernels.outer import applied; print(applied(3.0))"
    environment = os.environ | {"PYTHONPATH": str(folder)}
    command = [sys.executable, "-c", code]
    return subprocess.run(
        command, check=True, capture_output=True, text=True, env=environment, cwd=folder
    ).stdout.strip()


def test_a_change_in_another_file_is_noticed(tmp_path: Path) -> None:
    package = tmp_path / "kernels"
    package.mkdir()
    (package / "__init__.py").touch()
    shutil.copy(compilation.__file__, package)
    (package / "outer.py").write_text(OUTER)
    (package / "inner.py").write_text(INNER.replace("FACTOR", "2.0"))
    assert answer(tmp_path) == answer(tmp_path) == "6.0"
    (package / "inner.py").write_text(INNER.replace("FACTOR", "5.0"))
    assert answer(tmp_path) == "15.0"
