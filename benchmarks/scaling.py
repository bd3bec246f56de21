"""Growth of time and memory with the size: `make scaling CASES=100000`, and walls of more blocks.

That many cases of the static model are solved and their table is made, and again when there is
nothing to do. Fits, figures and report are left out: they grow with what is asked of them.
Time on the clock and of processors, memory of the largest process, files and bytes are in
tables/scaling.csv, beside those of a tenth and a hundredth of the cases.

``python -m benchmarks.scaling --blocks 10000`` measures walls up to that many blocks in place of
cases: tables/walls.csv has the times of the models, and the memory. `make bench` has one of them.
"""

import argparse
import math
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from benchmarks import seconds, used
from sidmacib.mechanics.assembly import FaceMaterial, NodeLayout
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_first_failure
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.loads import acceleration
from sidmacib.structure.structure import structure
from workflow.results import read_times
from workflow.step import ROOT

MESHES = [0.02, 0.03]
SAMPLES = {f"n{n}": {"locks": n} for n in (3, 5, 7, 9)}
BRICK = (0.4, 0.2, 0.2)  # m
DENSITY = 2000.0  # kg/m3
DRY = FaceMaterial(1e10, 1e10, 0.6, 0.0, 0.0)
MORTAR = FaceMaterial(1e10, 1e10, 0.6, 1e5, 5e4)
WALL_SIZES = (100, 300, 1000, 3000, 10_000)


# --- studies of many cases -----------------------------------------------------------------------
def study(cases: int) -> dict[str, object]:
    """A study of about that many cases of the static model."""
    each = max(1, round(cases / len(MESHES) / len(SAMPLES)))
    return {
        "samples": SAMPLES,
        "meshes": MESHES,
        "eccentricities": [round(2.0 * n / each, 6) for n in range(each)],
        "nodes": "centres",
        "models": ["static"],
        "dem": {"engines": []},
    }


def study_row(cases: int, folder: Path) -> dict[str, float]:
    """Run a study of about that many cases in ``folder``, twice."""
    config = study(cases)
    path, results = folder / "study.yaml", folder / "results"
    path.write_text(yaml.safe_dump(config))
    command = [
        *(str(Path(sys.executable).parent / "snakemake"), "--quiet", "all"),
        *("--configfile", str(path), "--config", f"results={results}"),
        *("--", f"{results}/tables/cases.csv"),
    ]
    first, again = used(command, ROOT), used(command, ROOT)
    solved = [cpu for kind, _, cpu in read_times(results) if kind == "static"]
    files = [each for each in results.rglob("*") if each.is_file()]
    count = len(pd.read_parquet(results / "tables/cases.parquet"))
    return {
        "cases": count,
        "batches": len(solved),
        "wall_s": first.wall,
        "cpu_s": first.cpu,
        "largest_process_MB": first.memory,
        "cases_cpu_s": sum(solved),
        "again_s": again.wall,
        "files": len(files),
        "MB": sum(each.stat().st_size for each in files) / 1e6,
    }


# --- structures of many blocks -------------------------------------------------------------------
def wall(count: int) -> list[Block]:
    """A wall of at least ``count`` bricks in running bond on a base, four times as long as high.

    Of 10,000 bricks, one twice as high would buckle under its own weight.
    """
    length, depth, height = BRICK
    courses = max(1, round(math.sqrt(count * length / (4 * height))))
    bricks = math.ceil(count / courses)
    ends = (-length, 0.0, -height), ((bricks + 1) * length, depth, 0.0)
    blocks = [box("base", *ends, DENSITY, fixed=True)]
    for course in range(courses):
        low = course * height
        joints = [*(number * length for number in range(bricks + 1))]
        if course % 2:  # between half bricks
            joints = [0.0, *(x + length / 2 for x in joints[:-1]), joints[-1]]
        for number, (x, end) in enumerate(pairwise(joints)):
            ends = (x, 0.0, low), (end, depth, low + height)
            blocks.append(box(f"brick{course}-{number}", *ends, DENSITY))
    return blocks


def wall_times(count: int) -> dict[str, Any]:
    """Times (CPU-s) of a wall of at least ``count`` bricks, with nodes at vertices.

    Interfaces are found; the static model raises an acceleration of the bonded wall until the first
    bond fails, and limit analysis one of the dry wall to its limit. ``memory_MB``: the largest of
    this process so far.
    """
    blocks = wall(count)
    start = time.process_time()
    bonded = structure(blocks, MORTAR, nodes=NodeLayout.VERTICES)
    finding = time.process_time() - start
    loads = acceleration(bonded, (1.0, 0.0, 0.0))
    static = seconds(lambda: static_first_failure(bonded, loads))
    dry = structure(blocks, DRY)
    push = acceleration(dry, (1.0, 0.0, 0.0))
    limit = seconds(lambda: limit_load(dry, push, friction=True))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {
        **{"blocks": len(blocks) - 1, "interfaces": len(bonded.faces), "finding_s": finding},
        **{"limit_s": limit, "static_s": static, "memory_MB": memory},
    }


def wall_figures(count: int) -> Iterator[tuple[str, str, float]]:
    """`wall_times` as lines for `make bench`: what was measured, its unit and its value."""
    times = wall_times(count)
    what = f"wall of {times['blocks']:,} blocks"
    yield f"{what}: finding its {times['interfaces']:,} interfaces", "CPU-s", times["finding_s"]
    yield f"{what}: limit analysis", "CPU-s", times["limit_s"]
    yield f"{what}, bonded: static model to the first failure", "CPU-s", times["static_s"]


# --- tables --------------------------------------------------------------------------------------
def study_rows(most: int) -> Iterator[dict[str, Any]]:
    """A row for a hundredth of the cases, a tenth of them, and all."""
    for cases in (most // 100, most // 10, most):
        with tempfile.TemporaryDirectory(prefix="multilock-scaling-") as name:
            yield study_row(cases, Path(name))


def wall_rows(most: int) -> Iterator[dict[str, Any]]:
    """A row for each wall of at most so many blocks."""
    wall_times(10)  # compiles
    for count in WALL_SIZES:
        if count <= most:
            yield wall_times(count)


def main() -> None:
    """Command line: how many cases, or blocks, and where the table goes."""
    parser = argparse.ArgumentParser(description=__doc__)
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--cases", type=int, default=100_000)
    size.add_argument("--blocks", type=int, help="of the largest wall, in place of cases")
    parser.add_argument("--results", type=Path, default=ROOT / "results")
    arguments = parser.parse_args()
    name, digits, found = "scaling", 6, study_rows(arguments.cases)
    if arguments.blocks is not None:
        name, digits, found = "walls", 4, wall_rows(arguments.blocks)
    path = arguments.results / f"tables/{name}.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = []
    for each in found:
        rows.append(each)
        pd.DataFrame(rows).to_csv(path, index=False, float_format=f"%.{digits}g")
        print(", ".join(f"{key} {value:.4g}" for key, value in each.items()), flush=True)
    print(f"Table: {path}")


if __name__ == "__main__":
    main()
