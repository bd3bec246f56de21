"""Whether loads of random blocks, walls and arches are within their mesh errors.

`python -m campaigns.peaks COUNT` solves COUNT of each kind, and each again on a fine mesh.
"""

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from sidmacib import CapacityError, static_peak
from sidmacib.answers.structure import static_answer
from sidmacib.problem import Problem
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.structure import refined

FINE = 16  # cells, along a side, that one of the file is divided into on the fine mesh
MOST_NODES = 4000  # of a fine mesh; it is coarser if it would have more
Random = np.random.Generator


@dataclass(frozen=True)
class Outcome:
    """Whether the ``peak`` counts, the load's mesh ``error``, its ``change`` on a fine mesh."""

    peak: bool
    error: float
    change: float


def block(random: Random) -> Problem:
    """A block that is bonded to a base."""
    top = {"low": [0, 0, 0], "high": random.uniform(0.2, 1.0, 3).tolist()}
    return _bonded(random, {"base": _base(-0.3), "top": top})


def wall(random: Random) -> Problem:
    """A wall of two or three courses in running bond."""
    length, thick, high = random.uniform((0.3, 0.1, 0.1), (1.0, 0.3, 0.3)).tolist()
    blocks: dict[str, Any] = {"base": _base(-0.2)}
    for course in range(int(random.integers(2, 4))):
        ends = [0.0, 1.0, 2.0] if course % 2 == 0 else [0.0, 0.5, 1.5, 2.0]
        for number, (low, far) in enumerate(pairwise(ends)):
            blocks[f"b{course}{number}"] = {
                "low": [low * length, 0, course * high],
                "high": [far * length, thick, (course + 1) * high],
            }
    return _bonded(random, blocks)


def arch(random: Random) -> Problem:
    """A semicircular arch of three to seven voussoirs between fixed blocks."""
    inner, thick, wide = random.uniform((0.6, 0.15, 0.2), (1.2, 0.35, 0.5)).tolist()
    outer, turns = inner + thick, np.linspace(0.0, np.pi, int(random.integers(4, 9)))
    blocks: dict[str, Any] = {
        "left": {"low": [-outer - 1, 0, -0.5], "high": [-inner, wide, 0], "fixed": True},
        "right": {"low": [inner, 0, -0.5], "high": [outer + 1, wide, 0], "fixed": True},
    }
    for number, (low, far) in enumerate(pairwise(turns)):
        corners = ((inner, low), (outer, low), (outer, far), (inner, far))
        outline = [
            [round(r * float(np.cos(t)), 9), 0, round(r * float(np.sin(t)), 9)] for r, t in corners
        ]
        blocks[f"v{number}"] = {"outline": outline, "along": [0, wide, 0]}
    return _bonded(random, blocks)


KINDS: dict[str, Callable[[Random], Problem]] = {"block": block, "wall": wall, "arch": arch}


def outcome(problem: Problem) -> Outcome:
    """What counts of a structure, and how far it is from the same on a fine mesh."""
    answer = static_answer(problem)
    divided = FINE
    while len((fine := refined(problem.assembly, divided)).nodes.area) > MOST_NODES:
        divided //= 2
    found = static_peak(fine, problem.loads)
    load = found.peak.load if answer.counts.peak else found.first_failure_load
    assert answer.mesh_error is not None, "the load is above 0"
    return Outcome(answer.counts.peak, answer.mesh_error, abs(float(load) / answer.load - 1.0))


def _base(low: float) -> dict[str, Any]:
    return {"low": [-2, -2, low], "high": [3, 3, 0], "fixed": True}


def _bonded(random: Random, blocks: dict[str, Any]) -> Problem:
    """``blocks`` with bonds of random strength, under an acceleration along x or any direction."""
    cohesion = 10.0 ** random.uniform(3.3, 5.5)
    turn = random.choice([0.0, random.uniform(0.0, 2.0 * np.pi)])
    interfaces = {
        "friction": float(random.uniform(0.4, 0.8)),
        "cohesion": float(cohesion),
        "tensile_strength": float(cohesion / random.uniform(0.7, 3.0)),
    }
    load = {"acceleration": [float(np.cos(turn)), float(np.sin(turn)), 0]}
    return structure_of({"blocks": blocks, "interfaces": interfaces, "load": load})


def _found(kind: str, count: int) -> Iterator[Outcome]:
    for seed in range(count):
        try:
            yield outcome(KINDS[kind](np.random.default_rng(seed)))
        except CapacityError as error:
            print(f"{kind} {seed}: {error}")


def main(count: int) -> None:
    """Print how many loads of each kind are further from those on a fine mesh than they say."""
    for kind in KINDS:
        found = list(_found(kind, count))
        peaks = [each for each in found if each.peak]
        beyond = [sum(each.change > each.error for each in some) for some in (peaks, found)]
        print(f"{kind}: {beyond[0]} of {len(peaks)} peaks, {beyond[1]} of all {len(found)} loads")


if __name__ == "__main__":
    main(int(sys.argv[1]))
