"""Numbers of the study of blocks that bend, `make study CONFIG=studies/elastic/config.yaml`."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from studies.markdown import body, markdown, percent, size, table_in
from workflow.results.tables import VARIANTS


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


def loads(results: Path) -> str:
    """Locks that work in pure shear, and how much less than (n - 1) / 2 this is."""

    def cell(row: Any) -> str:
        half = (row.locks - 1) / 2
        return f"{row.load_over_T0:.2f} ({percent(row.load_over_T0 / half - 1.0, 0)})"

    table = _finest(results)
    return _by_locks(table[table["eccentricity_m"].eq(0.0)], cell, ratio=True)


def mesh_errors(results: Path) -> str:
    """Largest mesh error of each stiffness, in pure shear and in all directions."""
    table = _finest(results)
    rows = []
    for giga, part in table.groupby("giga", sort=True):
        pure = part[part["eccentricity_m"].eq(0.0)]
        errors = (pure["mesh_error"].max(), part["mesh_error"].max())
        rows.append([_young(float(giga)), *(size(float(error)) for error in errors)])
    return markdown(["E (GPa)", "pure shear", "all directions"], rows)


def unsafe(results: Path) -> str:
    """The option that fits best, and how unsafe (n - 1) / 2 is with it at most."""

    def cell(row: Any) -> str:
        return f"{row.option.removeprefix('option')}: {size(row.largest_unsafe_error, 0)}"

    joints = _finest(results).drop_duplicates(["upper_body", "giga", "locks"])
    return _by_locks(joints, cell)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "elastic-loads": loads,
    "elastic-mesh-errors": mesh_errors,
    "elastic-unsafe": unsafe,
}
