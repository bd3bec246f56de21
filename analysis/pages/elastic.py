"""Numbers of the study of blocks that bend, `make study CONFIG=elastic.yaml`."""

import math
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from analysis.pages.markdown import body, markdown, percent, size, table_in
from workflow.results.tables import VARIANTS


def _finest(results: Path) -> pd.DataFrame:
    """Rows at the finest mesh, with E in GPa (infinite: rigid), stiff ones first."""
    table = table_in(results, VARIANTS)
    table = table.assign(giga=(table["young_Pa"] / 1e9).fillna(math.inf))
    finest = table[table["mesh_m"].eq(table["mesh_m"].min())]
    return finest.sort_values(["upper_body", "giga"], ascending=[True, False], kind="stable")


def _young(giga: float) -> str:
    return "rigid" if math.isinf(giga) else f"{giga:g}"


def loads(results: Path) -> str:
    """Locks that work in pure shear, and how much less than (n - 1) / 2 this is."""
    table = _finest(results)
    own = table[table["eccentricity_m"].eq(0.0)]
    counts = sorted(set(own["locks"]))
    rows = []
    for (upper, giga), part in own.groupby(["upper_body", "giga"], sort=False):
        found = part.set_index("locks")
        ratio = found["stiffness_ratio"].iloc[0]
        cells = []
        for count in counts:
            load = float(found.loc[count, "load_over_T0"])
            cells.append(f"{load:.2f} ({percent(load / ((count - 1) / 2) - 1.0, 0)})")
        told = "∞" if math.isinf(giga) else f"{ratio:g}"
        rows.append([_young(giga), told, body(str(upper)), *cells])
    return markdown(["E (GPa)", "E / (Kn·b)", "body", *(f"n = {n}" for n in counts)], rows)


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
    own = _finest(results).drop_duplicates(["upper_body", "giga", "locks"])
    counts = sorted(set(own["locks"]))
    rows = []
    for (upper, giga), part in own.groupby(["upper_body", "giga"], sort=False):
        found = part.set_index("locks")
        cells = [
            f"{str(found.loc[n, 'option']).removeprefix('option')}: "
            f"{size(float(found.loc[n, 'largest_unsafe_error']), 0)}"
            for n in counts
        ]
        rows.append([_young(giga), body(str(upper)), *cells])
    return markdown(["E (GPa)", "body", *(f"n = {n}" for n in counts)], rows)


BLOCKS: dict[str, Callable[[Path], str]] = {
    "elastic-loads": loads,
    "elastic-mesh-errors": mesh_errors,
    "elastic-unsafe": unsafe,
}
