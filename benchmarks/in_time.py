"""Steps in time of walls at rest, for `make bench`: here, and by compas_lmgc90.

The latter is in the extra ``peers``. Running bond, friction 0.7, steps of 1 ms.
"""

import importlib.util
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from benchmarks import seconds
from benchmarks.peers import lmgc90_steps
from sidmacib.answers.in_time import TimeAnswer
from sidmacib.structure.blocks import box
from sidmacib.structure.files.structure_file import demands_of

FRICTION, DENSITY, STEP = 0.7, 2000.0, 1e-3
WALLS = ((1, 1, 2000), (9, 10, 200), (30, 32, 60))  # courses, bricks in one, steps
BRICK = 0.2, 0.1, 0.1  # m


def bricks(courses: int, many: int) -> dict[str, tuple[list[float], list[float]]]:
    """Low and high corners of the ground and of a wall's bricks, by name."""
    length, depth, height = BRICK
    found = {"ground": ([-1.0, -1.0, -0.2], [many * length + 1.0, 1.0, 0.0])}
    for course in range(courses):
        first = 0.5 * length if course % 2 else length
        ends = [0.0, *np.arange(first, many * length - 1e-9, length).tolist(), many * length]
        for k in range(len(ends) - 1):
            low = [round(ends[k], 6), 0.0, round(course * height, 6)]
            high = [round(ends[k + 1], 6), depth, round((course + 1) * height, 6)]
            found[f"b{course}_{k}"] = low, high
    return found


def moved(wall: dict[str, Any], steps: int) -> object:
    """The wall after some steps on ground that hardly moves."""
    blocks = {name: {"low": low, "high": high} for name, (low, high) in wall.items()}
    blocks["ground"]["fixed"] = True
    still = {"pulse": {"acceleration": 1e-9, "duration": 1.0}, "direction": [1, 0, 0]}
    load = {"ground": still, "duration": steps * STEP, "step": STEP}
    interfaces = {"friction": FRICTION}
    given = {"blocks": blocks, "interfaces": interfaces, "load": load}
    return TimeAnswer.of(demands_of(given, in_time=True)[0].problem)


def moved_by_lmgc90(wall: dict[str, Any], steps: int) -> object:
    """The same by compas_lmgc90."""
    solids = [box(name, low, high, DENSITY) for name, (low, high) in wall.items()]
    fixed = [name == "ground" for name in wall]
    return lmgc90_steps(solids, fixed, FRICTION, DENSITY, STEP, steps)


def step_figures() -> Iterator[tuple[str, str, float]]:
    """Steps a second of processor time: without what comes before the first."""
    programs = {"": moved}
    if importlib.util.find_spec("compas_lmgc90"):
        programs["compas_lmgc90, "] = moved_by_lmgc90
    for courses, many, steps in WALLS:
        wall = bricks(courses, many)
        for name, move in programs.items():
            move(wall, 1)  # compiles
            few, more = (seconds(partial(move, wall, n)) for n in (steps // 4, steps))
            rate = (steps - steps // 4) / (more - few)
            yield f"{name}steps in time, {len(wall) - 1} blocks", "1/CPU-s", rate
