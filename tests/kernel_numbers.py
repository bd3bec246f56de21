"""Print numbers of every model in this process, as JSON: see test_kernels.py."""

import ctypes
import json
import math
import sys
from pathlib import Path

import numpy as np
from complementary_energy import least_energy_forces

from sidmacib.contact_points import OPTIONS
from sidmacib.contact_points.envelope import envelope
from sidmacib.contact_points.programme import Sidmacib, capacities
from sidmacib.joint import Direction, Joint
from sidmacib.joint.loading import Loading, lateral_load
from sidmacib.joint.pieces import assemble
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak

DIRECTIONS = [Direction(e) for e in (0.0, 0.5, math.inf)]


def kernel() -> str:
    """The processor that numpy's OpenBLAS works for, '' where it is unknown."""
    for path in (Path(np.__file__).parents[1] / "numpy.libs").glob("libscipy_openblas64_*"):
        name = ctypes.CDLL(str(path)).scipy_openblas_get_corename64_
        name.restype = ctypes.c_char_p
        return str(name().decode())
    return ""


def numbers(locks: int) -> dict[str, list[float]]:
    """Loads (N) and forces (N) of a joint, by model."""
    joint = Joint(locks)
    model = assemble(joint, 0.03, NodeLayout.CENTRES)
    found: dict[str, list[float]] = {}
    for direction in DIRECTIONS:
        loads, name = lateral_load(joint, model, Loading(direction)), f"{direction.eccentricity:g}"
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


if __name__ == "__main__":
    every = {f"{n} locks, {k}": v for n in (3, 5) for k, v in numbers(n).items()}
    json.dump({"kernel": kernel(), "numbers": every}, sys.stdout)
