"""Steps in time of walls at rest, for `make bench`: here, and by compas_lmgc90.

The latter is in the extra ``peers``. Running bond, friction 0.7, steps of 1 ms.
"""

import importlib.util
from collections.abc import Iterator, Sequence
from functools import partial

from benchmarks import seconds
from benchmarks.peers import lmgc90_steps, surface
from benchmarks.scaling import DENSITY, wall
from sidmacib.answers.in_time import TimeAnswer
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.structure_file import demands_of

FRICTION, STEP = 0.7, 1e-3
WALLS = ((1, 2000), (95, 200), (990, 60))  # bricks, at least, and steps


def moved(blocks: Sequence[Block], steps: int) -> object:
    """The blocks after some steps on ground that hardly moves."""
    shapes = {
        each.name: {
            **dict(zip(("vertices", "faces"), surface(each), strict=True)),
            **{"density": each.density, "fixed": each.fixed},
        }
        for each in blocks
    }
    still = {"pulse": {"acceleration": 1e-9, "duration": 1.0}, "direction": [1, 0, 0]}
    load = {"ground": still, "duration": steps * STEP, "step": STEP}
    given = {"blocks": shapes, "interfaces": {"friction": FRICTION}, "load": load}
    return TimeAnswer.of(demands_of(given, in_time=True)[0].problem)


def moved_by_lmgc90(blocks: Sequence[Block], steps: int) -> object:
    """The same by compas_lmgc90."""
    fixed = [each.fixed for each in blocks]
    return lmgc90_steps(blocks, fixed, FRICTION, DENSITY, STEP, steps)


def step_figures() -> Iterator[tuple[str, str, float]]:
    """Steps a second of processor time: without what comes before the first."""
    programs = {"": moved}
    if importlib.util.find_spec("compas_lmgc90"):
        programs["compas_lmgc90, "] = moved_by_lmgc90
    for bricks, steps in WALLS:
        blocks = wall(bricks)
        for name, move in programs.items():
            move(blocks, 1)  # compiles
            few, more = (seconds(partial(move, blocks, n)) for n in (steps // 4, steps))
            rate = (steps - steps // 4) / (more - few)
            yield f"{name}steps in time, {len(blocks) - 1} blocks", "1/CPU-s", rate
