"""Write numbers of a study's tables into pages.

    python -m studies.pages results-locks docs/law.md

A block stands between <!-- numbers: name --> and <!-- end -->; what was there is replaced, unless
its tables are not in the results. Blocks are made beside the code of their study; here, where a
study has none.
"""

import math
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import studies.attack.search
import studies.designed_vault.all_layouts
import studies.locks.page
import studies.measured.specimens
import studies.measured.walls
import studies.published.page
import studies.structures.compare
from sidmacib.mechanics.assembly import NodeLayout
from studies.markdown import body, markdown, markdown_of, percent, size, table_in
from workflow.results.tables import CASES, FIT, VARIANTS, Table

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
RULE_WORDS = {"half": ", (n − 1) / 2", "lower_sum": ", lower locks"}
LAYOUTS = [layout.replace("lobatto", "Lobatto") for layout in NodeLayout]


# --- blocks that bend, studies/elastic -----------------------------------------------------------
def _finest(results: Path) -> pd.DataFrame:
    """Rows at the finest mesh, with E in GPa (infinite: rigid), stiff ones first."""
    table = table_in(results, VARIANTS)
    table = table.assign(giga=(table["young_Pa"] / 1e9).fillna(math.inf))
    finest = table[table["mesh_m"].eq(table["mesh_m"].min())]
    return finest.sort_values(["upper_body", "giga"], ascending=[True, False], kind="stable")


def _young(giga: float) -> str:
    return "rigid" if math.isinf(giga) else f"{giga:g}"


def _by_locks(table: pd.DataFrame, cell: Callable[[Any], str], ratio: bool = False) -> str:
    """A table with a row for each body and stiffness, a column for each number of locks."""
    counts = sorted(set(table["locks"]))
    rows = []
    for (upper, giga), part in table.groupby(["upper_body", "giga"], sort=False):
        by_count = {row.locks: row for row in part.itertuples()}
        stiffness = "∞" if math.isinf(giga) else f"{part['stiffness_ratio'].iloc[0]:g}"
        cells = [cell(by_count[count]) for count in counts]
        rows.append([_young(giga), *([stiffness] * ratio), body(str(upper)), *cells])
    head = ["E (GPa)", *(["$E / (K_n b)$"] * ratio), "body", *(f"n = {n}" for n in counts)]
    return markdown(head, rows)


def elastic_loads(results: Path) -> str:
    """Locks that work in pure shear, and how much less than (n - 1) / 2 this is."""

    def cell(row: Any) -> str:
        half = (row.locks - 1) / 2
        return f"{row.load_over_T0:.2f} ({percent(row.load_over_T0 / half - 1.0, 0)})"

    table = _finest(results)
    return _by_locks(table[table["eccentricity_m"].eq(0.0)], cell, ratio=True)


def elastic_mesh_errors(results: Path) -> str:
    """Largest mesh error of each stiffness, in pure shear and in all directions."""
    table = _finest(results)
    rows = []
    for giga, part in table.groupby("giga", sort=True):
        pure = part[part["eccentricity_m"].eq(0.0)]
        errors = (pure["mesh_error"].max(), part["mesh_error"].max())
        rows.append([_young(float(giga)), *(size(float(error)) for error in errors)])
    return markdown(["E (GPa)", "pure shear", "all directions"], rows)


def elastic_unsafe(results: Path) -> str:
    """The option that fits best, and how unsafe (n - 1) / 2 is with it at most."""

    def cell(row: Any) -> str:
        return f"{row.option.removeprefix('option')}: {size(row.largest_unsafe_error, 0)}"

    joints = _finest(results).drop_duplicates(["upper_body", "giga", "locks"])
    return _by_locks(joints, cell)


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


def layouts_options(results: Path) -> str:
    """The option of SiDMACIB that fits best on each layout and mesh, by the rule that counts."""
    table = _by_layout(results, FIT).query("model == 'static' and not friction")
    best = table.sort_values("misfit", kind="stable").drop_duplicates(
        ["layout", "sample", "mesh_m", "reduction"]
    )
    best = best.set_index(["sample", "reduction", "mesh_m", "layout"])
    rows = []
    for sample, words in LAYOUT_SAMPLES.items():
        three = sample.startswith("n3")  # both rules count one lock
        for rule, of_rule in RULE_WORDS.items():
            if three and rule != "half":
                continue
            for mesh in sorted(table["mesh_m"].unique(), reverse=True):
                cells = [_fit(best.loc[(sample, rule, mesh, each)]) for each in NodeLayout]
                rows.append([words + ("" if three else of_rule), f"{mesh:g}", *cells])
    return markdown(["best option (misfit; unsafe by up to)", "mesh (m)", *LAYOUTS], rows)


def _fit(row: pd.Series) -> str:
    """The option, with its misfit and its largest unsafe error."""
    unsafe = size(max(row["largest_unsafe_error"], 0.0))
    return f"{row['option'].removeprefix('option')} ({size(row['misfit'])}; {unsafe})"


# --- growth of studies and of walls, benchmarks/scaling.py ---------------------------------------
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


# --- pages ---------------------------------------------------------------------------------------
BLOCKS = {
    **studies.published.page.BLOCKS,
    **studies.locks.page.BLOCKS,
    **studies.attack.search.BLOCKS,
    **studies.designed_vault.all_layouts.BLOCKS,
    **studies.structures.compare.BLOCKS,
    **studies.measured.specimens.BLOCKS,
    **studies.measured.walls.BLOCKS,
    "elastic-loads": elastic_loads,
    "elastic-mesh-errors": elastic_mesh_errors,
    "elastic-unsafe": elastic_unsafe,
    "layouts-torsion": layouts_torsion,
    "layouts-options": layouts_options,
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
