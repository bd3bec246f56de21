"""Structures of many blocks: times of the models, and their growth with the blocks.

`make bench` has the rows of a wall of 1,000 blocks, and of the armadillo of compas_cra beside that
program where it is installed; ``python -m benchmarks.structures --blocks 10000`` measures growth.
"""

import argparse
import importlib.util
import math
import resource
import time
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.peers import seconds_by_cra
from benchmarks.usage import seconds
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, NodeLayout
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_first_failure
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.files.compas import read_compas, read_compas_interfaces
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from workflow.step import ROOT

BRICK = (0.4, 0.2, 0.2)  # m
DENSITY = 2000.0  # kg/m3
DRY = FaceMaterial(1e10, 1e10, 0.6, 0.0, 0.0)
MORTAR = FaceMaterial(1e10, 1e10, 0.6, 1e5, 5e4)
WALL_SIZES = (100, 300, 1000, 3000, 10_000)
PATIENCE = 120.0  # s of processor time that another program may take
ARMADILLO_FRICTION = 0.84  # compas_cra's default
Row = tuple[str, str, float]  # what, unit, value


def wall(count: int) -> list[Block]:
    """A wall of at least ``count`` bricks in running bond on a base, half as high as it is long."""
    length, depth, height = BRICK
    courses = max(1, round(math.sqrt(count * length / (2 * height))))
    bricks = math.ceil(count / courses)
    ends = (-length, 0.0, -height), ((bricks + 1) * length, depth, 0.0)
    blocks = [box("base", *ends, DENSITY, fixed=True)]
    for course in range(courses):
        shift, low = (course % 2) * length / 2, course * height
        for number in range(bricks):
            x = shift + number * length
            ends = (x, 0.0, low), (x + length, depth, low + height)
            blocks.append(box(f"brick{course}-{number}", *ends, DENSITY))
    return blocks


def wall_times(count: int, *, limit: bool = True) -> dict[str, Any]:
    """Times (CPU-s) of a wall of at least ``count`` bricks, with nodes at vertices.

    Interfaces are found; the static model raises an acceleration of the bonded wall until the first
    bond fails, and limit analysis, if asked, one of the dry wall to its limit. ``memory_MB``: the
    largest of this process so far.
    """
    blocks = wall(count)
    start = time.process_time()
    bonded = structure(blocks, MORTAR, nodes=NodeLayout.VERTICES)
    finding = time.process_time() - start
    loads = acceleration(bonded, (1.0, 0.0, 0.0))
    static = seconds(lambda: static_first_failure(bonded, loads))
    spent = _limit_seconds(structure(blocks, DRY)) if limit else None
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {
        **{"blocks": len(blocks) - 1, "interfaces": len(bonded.faces), "finding_s": finding},
        **{"limit_s": spent, "static_s": static, "memory_MB": memory},
    }


def _limit_seconds(assembly: Assembly) -> float:
    """CPU-s of limit analysis for a horizontal acceleration."""
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    return seconds(lambda: limit_load(assembly, loads, friction=True))


def wall_figures(count: int) -> Iterator[Row]:
    """`wall_times` as rows."""
    times = wall_times(count)
    what = f"wall of {times['blocks']:,} blocks"
    yield f"{what}: finding its {times['interfaces']:,} interfaces", "CPU-s", times["finding_s"]
    yield f"{what}: limit analysis", "CPU-s", times["limit_s"]
    yield f"{what}, bonded: static model to the first failure", "CPU-s", times["static_s"]


def armadillo_figures() -> Iterator[Row]:
    """The armadillo of compas_cra, 399 blocks: forces at rest by that program, a limit load here.

    Nothing where compas_cra is not installed, which has the blocks.
    """
    if not importlib.util.find_spec("compas_cra"):
        return
    path = Path(str(files("compas_cra"))) / "data/samples/armadillo_cra.json"
    blocks = read_compas(path, 1.0)
    law = FaceMaterial(1e10, 1e10, ARMADILLO_FRICTION, 0.0, 0.0)
    ours = structure(blocks, law, regions=read_compas_interfaces(path, blocks))
    yield "armadillo: limit analysis", "CPU-s", _limit_seconds(ours)
    for name in ("rbe", "cra"):
        what = f"armadillo at rest: compas_cra, {name.upper()}"
        spent = seconds_by_cra(path, name, ARMADILLO_FRICTION, PATIENCE)
        if spent is None:
            yield f"{what}, stopped without an answer", "CPU-s", PATIENCE
        else:
            yield what, "CPU-s", spent


def main() -> None:
    """Command line: walls of more and more blocks, as a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=WALL_SIZES[-1], help="of the largest wall")
    parser.add_argument(
        "--limit-blocks", type=int, default=3000, help="of the largest wall for limit analysis"
    )
    parser.add_argument("--table", type=Path, default=ROOT / "results-structures/tables/walls.csv")
    arguments = parser.parse_args()
    arguments.table.parent.mkdir(parents=True, exist_ok=True)
    wall_times(10)  # compiles
    rows: list[dict[str, Any]] = []
    for count in (each for each in WALL_SIZES if each <= arguments.blocks):
        rows.append(wall_times(count, limit=count <= arguments.limit_blocks))
        pd.DataFrame(rows).to_csv(arguments.table, index=False, float_format="%.4g")
        print(rows[-1], flush=True)
    print(f"Table: {arguments.table}")


if __name__ == "__main__":
    main()
