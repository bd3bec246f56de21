"""The search for locks beside trying all layouts, for few interfaces, on one thread.

``python -m studies.designed_vault.all_layouts RESULTS`` writes ``tables/all_layouts.csv``. Cubes in
a row between two walls, without a floor, are held by their locks alone and pushed aside and down.
"""

import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from sidmacib.design import LockKindSection, WeightsSection, directions_of, layouts_of
from sidmacib.design.direction import RowSearch
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.joint import DRY
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block, box
from sidmacib.structure.loads import force_at
from sidmacib.structure.structure import structure

CUBES = (1, 2, 3)
EDGE, DENSITY = 0.4, 2000.0  # m, kg/m3
KIND = LockKindSection(width=(0.05,), height=0.02, most=3)
ANGLES = (0.0, 45.0, 90.0, 135.0)  # degrees
PUSH = 2500.0  # N
GAP = 1e-4


def row(count: int) -> list[Block]:
    """Cubes side by side without a floor between two fixed walls: only locks hold them up."""
    walls = [
        box("left", (-EDGE, 0.0, 0.0), (0.0, EDGE, EDGE), DENSITY, fixed=True),
        box(
            "right", (EDGE * count, 0.0, 0.0), (EDGE * (count + 1), EDGE, EDGE), DENSITY, fixed=True
        ),
    ]
    free = [
        box(f"cube{k}", (EDGE * k, 0.0, 0.0), (EDGE * (k + 1), EDGE, EDGE), DENSITY)
        for k in range(count)
    ]
    return [*walls, *free]


def cubes(count: int) -> DesignProblem:
    """The design of a `row` of cubes; each interface may get locks in four directions."""
    assembly = structure(row(count), replace(DRY, friction=0.0), nodes=NodeLayout.VERTICES)
    middle = (EDGE / 2, EDGE / 2, EDGE / 2)
    cases = tuple(
        LoadCase(name, force_at(assembly, "cube0", middle, along), PUSH)
        for name, along in (("aside", (0.0, 1.0, 0.0)), ("down", (0.0, 1.0, -1.0)))
    )
    sites = tuple(
        Site(number, layouts_of(face, KIND, directions_of(face, angles=ANGLES)))
        for number, face in enumerate(assembly.faces)
        if isinstance(face, Polygon)
    )
    return DesignProblem(assembly, sites, cases, WeightsSection())


def tried(given: DesignProblem, search: RowSearch) -> tuple[int, float]:
    """Number of all layouts, and the least cost of those that carry all cases."""
    count, best = 0, np.inf
    for choice in product(*[(None, *site.layouts) for site in given.sites]):
        count += 1
        taken = given.chosen(choice)
        cost = float(given.costs @ taken)
        if cost < best and search.carries(taken):  # no solver is asked about what costs more
            best = cost
    return count, best


def compared(count: int) -> dict[str, float]:
    """Costs and times (CPU-s) of both ways to the cheapest locks of a row of ``count`` cubes."""
    given = cubes(count)
    begin = time.process_time()
    found = RowSearch(given, 1.0).cheapest(gap=GAP)
    middle = time.process_time()
    layouts, least = tried(given, RowSearch(given, 1.0))
    end = time.process_time()
    return {
        **{"interfaces": len(given.sites), "layouts": layouts, "least_cost": least},
        **{"tried_s": end - middle, "found_cost": found.cost, "bound": found.bound},
        "search_s": middle - begin,
    }


def main(arguments: Sequence[str]) -> None:
    """Write the table into the results folder that is the only argument."""
    (results,) = arguments
    path = Path(results) / "tables/all_layouts.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    compared(CUBES[0])  # compiles
    pd.DataFrame(map(compared, CUBES)).to_csv(path, index=False)


if __name__ == "__main__":
    main(sys.argv[1:])
