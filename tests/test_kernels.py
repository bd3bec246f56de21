"""The same numbers whatever processor the linear algebra is written for."""

import json
import os
import subprocess
import sys

import pytest
from conftest import ROOT
from kernels import NEEDS, can_run

pytestmark = pytest.mark.study

EXACT = ("limit load", "limit forces", "capacities", "envelope")  # no BLAS on the way to these


@pytest.fixture(scope="module")
def found() -> dict[str, dict]:
    """What each kernel gives that this processor can run."""
    script = ROOT / "tests" / "kernel_numbers.py"
    runs = {}
    for kernel in filter(can_run, NEEDS):  # all at once
        environment = os.environ | {"OPENBLAS_CORETYPE": kernel, "PYTHONPATH": str(ROOT)}
        environment |= {"OPENBLAS_NUM_THREADS": "1"}
        command = [sys.executable, str(script)]
        runs[kernel] = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    texts = {kernel: run.communicate()[0] for kernel, run in runs.items()}
    assert all(run.returncode == 0 for run in runs.values())
    return {kernel: json.loads(text) for kernel, text in texts.items()}


@pytest.mark.parametrize("kernel", NEEDS)
def test_all_models_give_the_same_numbers_under(kernel: str, found: dict[str, dict]) -> None:
    if kernel not in found:
        pytest.skip(f"this processor lacks {NEEDS[kernel]}")
    numbers, other = found[kernel]["numbers"], found["Nehalem"]["numbers"]
    assert numbers.keys() == other.keys()
    for name, values in numbers.items():
        if any(part in name for part in EXACT):
            assert values == other[name], name
        else:
            largest = max(map(abs, values))
            assert values == pytest.approx(other[name], rel=1e-7, abs=1e-7 * largest), name


def test_the_kernels_are_not_all_one(found: dict[str, dict]) -> None:
    names = {run["kernel"] for run in found.values()}
    if names == {""} or len(found) < 3:  # two of them share a kernel
        pytest.skip("this numpy does not tell its kernel, or this processor runs too few")
    assert len(names) > 1
