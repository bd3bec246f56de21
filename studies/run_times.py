"""Numbers of pages from `make scaling` and `make bench`: how run times grow."""

import math
from pathlib import Path

import pandas as pd

from studies.markdown import markdown

COLUMNS = {  # of the page, and those of the table
    "cases": ("cases", "{:,.0f}"),
    "jobs": ("jobs", "{:.0f}"),
    "first run (s)": ("wall_s", "{:.0f}"),
    "processors (s)": ("cpu_s", "{:.0f}"),
    "of these, cases (s)": ("cases_cpu_s", "{:.0f}"),
    "their table (s)": ("tables_cpu_s", "{:.0f}"),
    "again, nothing to do (s)": ("again_s", "{:.0f}"),
    "largest process (MB)": ("largest_process_MB", "{:.0f}"),
    "files": ("files", "{:.0f}"),
    "MB": ("MB", "{:.0f}"),
}


def growth(results: Path) -> str:
    """A row for each number of cases."""
    table = pd.read_csv(results / "tables/scaling.csv")
    rows = [
        [form.format(row[column]) for column, form in COLUMNS.values()]
        for row in table.to_dict("records")
    ]
    return markdown(list(COLUMNS), rows)


def walls(results: Path) -> str:
    """A row for each wall, with the exponents by which its times grow from the wall before.

    A dash where a model was not asked.
    """
    table = pd.read_csv(results / "tables/walls.csv")
    rows = []
    for before, row in zip([None, *table.index[:-1]], table.to_dict("records"), strict=True):
        cells = [f"{row['blocks']:,}", f"{row['interfaces']:,}"]
        for column in ("finding_s", "limit_s", "static_s"):
            if math.isnan(row[column]):
                cells.append("-")
                continue
            cell = f"{row[column]:.3g}"
            if before is not None:
                growth = math.log(row[column] / table[column][before])
                cell += f" ({growth / math.log(row['blocks'] / table['blocks'][before]):.1f})"
            cells.append(cell)
        rows.append([*cells, f"{row['memory_MB']:.0f}"])
    return markdown(WALLS, rows)


WALLS = [
    "blocks",
    "interfaces",
    "finding them (CPU-s)",
    "limit analysis (CPU-s)",
    "static model to the first failure, bonded (CPU-s)",
    "largest memory (MB)",
]
BLOCKS = {"scaling": growth, "structures-walls": walls}
