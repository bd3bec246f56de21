"""Time and memory of a command, as the benchmarks measure them."""

import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.usage import used

WAITS = "import time; held = b'1' * int({megabytes}e6); time.sleep({seconds})"


def python(megabytes: float = 0.0, seconds: float = 0.0) -> list[str]:
    return [sys.executable, "-c", WAITS.format(megabytes=megabytes, seconds=seconds)]


def test_memory_is_that_of_the_command_alone(tmp_path: Path) -> None:
    held = np.ones(30_000_000)  # 240 MB in the process that measures
    little, much = used(python(), tmp_path).memory, used(python(megabytes=100.0), tmp_path).memory
    assert little < held.nbytes / 1e6 / 2.0
    assert much - little == pytest.approx(100.0 * 1e6 / 2**20, rel=0.1)
