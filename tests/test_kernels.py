"""The same numbers whatever processor the linear algebra is written for."""

import ctypes
import json
import math
import platform
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from joints import loaded, sawn
from processes import ROOT, python
from test_complementary_energy import least_energy_forces

from sidmacib import OPTIONS, Direction, Sidmacib, capacities, envelope, limit_load
from sidmacib.mechanics.static import static_peak

pytestmark = pytest.mark.study

NEEDS = {"SkylakeX": "avx512f", "Haswell": "avx2", "Zen": "avx2", "Nehalem": "sse4_2"}
DIRECTIONS = [Direction(e) for e in (0.0, 0.5, math.inf)]


def can_run(kernel: str) -> bool:
    """Whether this processor can run a kernel of OpenBLAS."""
    info = Path("/proc/cpuinfo")
    return platform.machine() == "x86_64" and info.exists() and NEEDS[kernel] in info.read_text()


def kernel() -> str:
    """The processor that numpy's OpenBLAS works for, '' where it is unknown."""
    for path in (Path(np.__file__).parents[1] / "numpy.libs").glob("libscipy_openblas64_*"):
        name = ctypes.CDLL(str(path)).scipy_openblas_get_corename64_
        name.restype = ctypes.c_char_p
        return str(name().decode())
    return ""


def numbers(locks: int) -> dict[str, list[float]]:
    """Loads (N) and forces (N) of a joint, by model."""
    joint = sawn(locks)
    found: dict[str, list[float]] = {}
    for direction in DIRECTIONS:
        (model, loads), name = loaded(joint, direction.eccentricity), f"{direction.eccentricity:g}"
        limit, static = limit_load(model, loads), static_peak(model, loads)
        found[f"limit load {name}"] = [limit.load]
        found[f"limit forces {name}"] = limit.force.ravel().tolist()
        found[f"static {name}"] = [static.first_failure_load, static.peak.load]
        found[f"static forces {name}"] = static.peak.force.ravel().tolist()
        energy = least_energy_forces(model, loads, 0.25 * joint.T0)
        found[f"complementary forces {name}"] = energy.ravel().tolist()
    sidmacib = Sidmacib(joint, OPTIONS["option4"])
    found["capacities"] = [c.load for c in capacities(sidmacib, DIRECTIONS)]
    found["envelope"] = envelope(sidmacib).vertices.ravel().tolist()
    return found


@pytest.fixture(scope="module")
def found() -> dict[str, dict]:
    """What each kernel gives that this processor can run."""

    def run(kernel: str) -> dict:
        more = {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
        return json.loads(python(__file__, check=True, OPENBLAS_CORETYPE=kernel, **more).stdout)

    kernels = [*filter(can_run, NEEDS)]
    with ThreadPoolExecutor() as pool:
        return dict(zip(kernels, pool.map(run, kernels), strict=True))


@pytest.mark.parametrize("kernel", NEEDS)
def test_all_models_give_the_same_numbers_under(kernel: str, found: dict[str, dict]) -> None:
    """To the byte where no BLAS is on the way to them: in all models but a second formulation."""
    if kernel not in found:
        pytest.skip(f"this processor lacks {NEEDS[kernel]}")
    numbers, other = found[kernel]["numbers"], found["Nehalem"]["numbers"]
    assert numbers.keys() == other.keys()
    for name, values in numbers.items():
        if "complementary" in name:
            largest = max(map(abs, values))
            assert values == pytest.approx(other[name], rel=1e-7, abs=1e-7 * largest), name
        else:
            assert values == other[name], name


def test_the_kernels_are_not_all_one(found: dict[str, dict]) -> None:
    names = {run["kernel"] for run in found.values()}
    if names == {""} or len(found) < 3:  # two of them share a kernel
        pytest.skip("this numpy does not tell its kernel, or this processor runs too few")
    assert len(names) > 1


if __name__ == "__main__":
    every = {f"{n} locks, {k}": v for n in (3, 5) for k, v in numbers(n).items()}
    json.dump({"kernel": kernel(), "numbers": every}, sys.stdout)
