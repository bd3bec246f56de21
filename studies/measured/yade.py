"""Follow a wall in YADE, beside its measured curve and the static model.

    make measured ENGINE=yade

YADE has the pressure in a joint at its nodes. The static model integrates it; here it is followed
at the same nodes as well. Nothing is fitted. Writes a table of equilibria, and a figure.
"""

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import followed
from sidmacib.engines import YADE, Numerics
from sidmacib.engines.curve import engine_curve
from sidmacib.engines.run import HOUR
from sidmacib.problem import Problem
from sidmacib.structure.files.structure_file import structure_of
from sidmacib.structure.structure import refined
from sidmacib.yaml_text import read_yaml
from studies.measured.walls import HERE, campaigns, results_folder
from workflow.results.tables import Table, write_table
from workflow.schema import with_changes

CAMPAIGN, SPECIMEN = "granite", "WS.100"
CELLS = (1, 4)  # along a side of an interface
FURTHEST = 0.012  # m, beyond the peak of the static model
# Five times as slow, with a tenth of the unbalanced force: loads differ by 0.1 % up to 4.5 mm.
NUMERICS = Numerics(damping=0.7, ramp_periods=4.0, unbalanced_ratio=1e-3)
STATIC, AT_NODES = "static", "static at nodes"
PATHS = Table(
    "yade",
    ("specimen", "model", "cells", "nodes", "point", "displacement_m", "load_N"),
    ("model", "cells", "point"),
)
LOOKS = {  # in the figure, and in words
    STATIC: ("-", "static model"),
    AT_NODES: ("--", "static model, pressure at nodes"),
    YADE.name: ("o", YADE.label),
}


def wall(specimen: str = SPECIMEN) -> Problem:
    """The structure of a specimen under its load."""
    campaign = campaigns()[CAMPAIGN]
    changes = campaign.kinds[campaign.specimens[specimen].kind]
    return structure_of(with_changes(read_yaml(HERE / campaign.file), changes))


def rows(model: str, cells: int, furthest: float = FURTHEST) -> list[dict[str, Any]]:
    """A row of `PATHS` for each equilibrium of a model; ``cells`` of `STATIC` are its own.

    ``furthest``: how far YADE moves the wall, m. `EngineError` if it ends without a result.
    """
    assembly, loads = problem = wall()
    if model == STATIC:
        found = static_answer(problem)
        assembly, path = found.assembly, found.path
    else:
        assembly = refined(assembly, cells, pressed=False)
        path = () if model == YADE.name else followed(assembly, loads).path
    points = [(each.displacement, each.load) for each in path]
    if model == YADE.name:
        with TemporaryDirectory() as folder:
            curve = engine_curve(Problem(assembly, loads), NUMERICS, furthest, Path(folder), HOUR)
        points = [(0.0, 0.0), *zip(*(each.tolist() for each in curve), strict=True)]
    of = {"specimen": SPECIMEN, "model": model, "cells": cells, "nodes": len(assembly.nodes.area)}
    return [
        {**of, "point": point, "displacement_m": moved, "load_N": load}
        for point, (moved, load) in enumerate(points)
    ]


def drawn(table: pd.DataFrame, measured: pd.DataFrame) -> Figure:
    """Forces over displacements, measured and by each model, as far as YADE goes."""
    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    axes = figure.add_subplot()
    own = measured[measured["specimen"].eq(SPECIMEN)]
    axes.plot(own["displacement_mm"], own["force_kN"], color="black", lw=0.9, label="measured")
    for (model, cells), path in table.groupby(["model", "cells"], sort=False):
        look, words = LOOKS[str(model)]
        nodes = "" if model == STATIC else f", {path['nodes'].iloc[0]} nodes"
        colour = "C1" if model == STATIC else "C2" if cells == CELLS[0] else "C4"
        more = {"color": colour, "label": f"{words}{nodes}", "markersize": 4}
        axes.plot(1e3 * path["displacement_m"], path["load_N"] / 1e3, look, **more)
    axes.set(title=f"Granite wall {SPECIMEN}", xlim=(0, 1e3 * FURTHEST))
    axes.set_xlabel("displacement (mm)")
    axes.set_ylabel("force (kN)")
    axes.set_ylim(0, None)
    axes.legend(loc="lower right")
    return figure


def main() -> None:
    """Command line: write the table and the figure, and print the largest loads."""
    to = results_folder(__doc__)
    tasks = [(model, cells) for cells in CELLS for model in (YADE.name, AT_NODES)]
    with ProcessPoolExecutor() as processes:
        found = processes.map(rows, *zip(*tasks, (STATIC, 2), strict=True))
        table = pd.DataFrame([row for path in found for row in path])
    write_table(PATHS, table, to / "tables/yade.csv")
    figure = drawn(table, pd.read_csv(HERE / "curves.csv"))
    figure.savefig(to / "figures/yade.png", dpi=150, metadata={"Software": None})
    peaks = table.loc[table.groupby(["model", "nodes"], sort=False)["load_N"].idxmax()]
    print(peaks.to_string(index=False))


if __name__ == "__main__":
    main()
