"""Write numbers of a study's tables into pages.

    python -m studies.pages results-locks docs/law.md

A block stands between <!-- numbers: name --> and <!-- end -->; what was there is replaced, unless
its tables are not in the results. Blocks are made beside the code of their study; here, where a
study has none.
"""

import re
import sys
from pathlib import Path

import numpy as np
import pandas as pd

import studies.attack.search
import studies.locks.page
import studies.measured.contacts
import studies.measured.specimens
import studies.measured.walls
import studies.published.page
import studies.structures.compare
from sidmacib.mechanics.assembly import NodeLayout
from studies.markdown import markdown, size, table_in
from workflow.results.tables import CASES, Table

BLOCK = re.compile(r"(<!-- numbers: ([\w-]+) -->\n)(?:.*?\n)??(<!-- end -->)", re.DOTALL)
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
LAYOUT_SAMPLES = {
    "n3": "3 locks as printed",
    "n3_fits": "3 locks fitted",
    "n5": "5 locks as printed",
    "n5_fits": "5 locks fitted",
}
AS_PRINTED = ("n3", "n5")
LAYOUTS = [layout.replace("lobatto", "Lobatto") for layout in NodeLayout]


# --- blocks that bend, studies/elastic -----------------------------------------------------------


# --- layouts of nodes, studies/layouts -----------------------------------------------------------
def _by_layout(results: Path, table: Table) -> pd.DataFrame:
    """A table of all three studies, with the layout."""
    return pd.concat(
        [table_in(results / layout, table).assign(layout=str(layout)) for layout in NodeLayout]
    )


def layouts_torsion(results: Path) -> str:
    """Loads in pure torsion on each layout and mesh, and the largest of their mesh errors."""
    cases = _by_layout(results, CASES).query("model == 'static'")
    cases = cases[np.isinf(cases["eccentricity_over_a"]) & cases["sample"].isin(AS_PRINTED)]
    keys = ["sample", "mesh_m"]
    loads = cases.pivot_table(index=keys, columns="layout", values="load_N")
    rows = [
        [
            LAYOUT_SAMPLES[sample],
            f"{mesh:g}",
            *(f"{loads.loc[(sample, mesh), each]:.2f}" for each in NodeLayout),
        ]
        for sample in AS_PRINTED
        for mesh in sorted(cases["mesh_m"].unique(), reverse=True)
    ]
    errors = cases.pivot_table(index="mesh_m", columns="layout", values="mesh_error", aggfunc="max")
    for mesh, row in errors.sort_index(ascending=False).iterrows():
        cells = [size(row[each], 0) for each in NodeLayout]
        rows.append(["largest mesh-error estimate", f"{mesh:g}", *cells])
    return markdown(["pure torsion, M / a (N)", "mesh (m)", *LAYOUTS], rows)


# --- growth of studies and of walls, benchmarks/scaling.py ---------------------------------------
def growth(results: Path) -> str:
    """A row for each number of cases."""
    rows = pd.read_csv(results / "tables/scaling.csv").to_dict("records")
    cells = [[form.format(row[column]) for column, form in COLUMNS.values()] for row in rows]
    return markdown(list(COLUMNS), cells)


# --- pages ---------------------------------------------------------------------------------------
BLOCKS = {
    **studies.published.page.BLOCKS,
    **studies.locks.page.BLOCKS,
    **studies.attack.search.BLOCKS,
    **studies.structures.compare.BLOCKS,
    **studies.measured.specimens.BLOCKS,
    **studies.measured.walls.BLOCKS,
    **studies.measured.contacts.BLOCKS,
    "layouts-torsion": layouts_torsion,
    "scaling": growth,
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
