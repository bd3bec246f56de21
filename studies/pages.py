"""Write numbers of a study's tables into pages.

    python -m studies.pages results-locks docs/law.md

A block stands between <!-- numbers: name --> and <!-- end -->; what was there is replaced, unless
its tables are not in the results.
"""

import math
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import studies.attack.search
import studies.designed_vault.all_layouts
import studies.elastic.page
import studies.layouts.page
import studies.locks.page
import studies.measured.specimens
import studies.published.page
import studies.structures.page
from studies.markdown import markdown, markdown_of

COLUMNS = {  # of the page, and those of the table
    "cases": ("cases", "{:,.0f}"),
    "batches": ("batches", "{:.0f}"),
    "first run (s)": ("wall_s", "{:.0f}"),
    "processors (s)": ("cpu_s", "{:.0f}"),
    "of these, cases (s)": ("cases_cpu_s", "{:.0f}"),
    "again, nothing to do (s)": ("again_s", "{:.0f}"),
    "largest process (MB)": ("largest_process_MB", "{:.0f}"),
    "files": ("files", "{:.0f}"),
    "MB": ("MB", "{:.0f}"),
}

BLOCK = re.compile(r"(<!-- numbers: ([\w-]+) -->\n)(?:.*?\n)??(<!-- end -->)", re.DOTALL)


def growth(results: Path) -> str:
    """A row for each number of cases."""
    rows = pd.read_csv(results / "tables/scaling.csv").to_dict("records")
    cells = [[form.format(row[column]) for column, form in COLUMNS.values()] for row in rows]
    return markdown(list(COLUMNS), cells)


def walls(results: Path) -> str:
    """A row for each wall, with the exponents by which its times grow from the wall before.

    A dash where a model was not asked.
    """
    table = pd.read_csv(results / "tables/walls.csv")
    steps = np.log(table[["blocks", "finding_s", "limit_s", "static_s"]]).diff()
    exponents = steps.div(steps["blocks"], axis=0)

    def time(row: Any, column: str) -> str:
        value, exponent = getattr(row, column), exponents[column][row.Index]
        if math.isnan(value):
            return "-"
        return f"{value:.3g}" + ("" if math.isnan(exponent) else f" ({exponent:.1f})")

    return markdown_of(
        table,
        {
            "blocks": lambda row: f"{row.blocks:,}",
            "interfaces": lambda row: f"{row.interfaces:,}",
            "finding them (CPU-s)": lambda row: time(row, "finding_s"),
            "limit analysis (CPU-s)": lambda row: time(row, "limit_s"),
            "static model to the first failure, bonded (CPU-s)": lambda row: time(row, "static_s"),
            "largest memory (MB)": lambda row: f"{row.memory_MB:.0f}",
        },
    )


BLOCKS = {
    **studies.published.page.BLOCKS,
    **studies.elastic.page.BLOCKS,
    **studies.layouts.page.BLOCKS,
    **studies.locks.page.BLOCKS,
    **studies.attack.search.BLOCKS,
    **studies.designed_vault.all_layouts.BLOCKS,
    **studies.structures.page.BLOCKS,
    **studies.measured.specimens.BLOCKS,
    "scaling": growth,
    "structures-walls": walls,
}


def filled(text: str, results: Path) -> str:
    """A page with its blocks made from the tables in ``results``; ValueError for an unknown one.

    A block whose table is not there stays as it is, and a line says so.
    """

    def block(match: re.Match[str]) -> str:
        begin, name, end = match.groups()
        if name not in BLOCKS:
            raise ValueError(
                f"{name}: unknown block of numbers; it must be one of {', '.join(BLOCKS)}"
            )
        try:
            return f"{begin}{BLOCKS[name](results)}\n{end}"
        except FileNotFoundError as error:
            print(f"{name}: unchanged, as {error.filename} is missing", file=sys.stderr)
            return match[0]

    return BLOCK.sub(block, text)


def main() -> None:
    """Fill the pages that are named on the command line."""
    results, *pages = map(Path, sys.argv[1:])
    for page in pages:
        page.write_text(filled(page.read_text(), results))


if __name__ == "__main__":
    main()
