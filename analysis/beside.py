"""Published numbers beside those computed for every sample that they belong to."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd


@dataclass(frozen=True)
class Line:
    """A published number and the rows of the validation table that belong to it, by sample."""

    quantity: str
    mesh: str
    published: float
    rows: Mapping[str, Any]


@dataclass(frozen=True)
class Beside:
    """All samples with a number of locks: what each is, by name, and the published numbers."""

    locks: int
    samples: Mapping[str, str]
    lines: tuple[Line, ...]


def beside(table: pd.DataFrame, leading: Mapping[str, str]) -> Iterator[Beside]:
    """The validation table by number of locks; ``leading``: the model that is shown, by sample.

    SiDMACIB's numbers are those without friction along the locks; with it they are the same.
    """
    shown = (table["model"] == "sidmacib") | (table["model"] == table["sample"].map(leading))
    table = table[shown & ~table["quantity"].str.contains("_friction_N")]
    for locks, own in table.groupby("locks"):
        found: dict[tuple[str, str], dict[str, Any]] = {}
        for row in own.itertuples():
            mesh = "" if pd.isna(row.mesh_m) else f"{row.mesh_m:g}"
            found.setdefault((str(row.quantity), mesh), {})[str(row.sample)] = row
        samples = {
            str(row.sample): f"friction {row.friction:.4g}, {row.setting}; "
            f"{leading.get(str(row.sample), 'no model')}"
            for row in own.drop_duplicates("sample").itertuples()
        }
        lines = tuple(
            Line(quantity, mesh, next(iter(rows.values())).published, rows)
            for (quantity, mesh), rows in found.items()
        )
        yield Beside(int(str(locks)), samples, lines)


NAMES = (  # of quantities in the validation table, as people say them
    (r"sidmacib_pure_shear_option(\w+?)_(frictionless|friction)_N", r"SiDMACIB, Option \1, V (N)"),
    (r"dem_pure_shear_N", r"peak V of the pieces (N)"),
    (r"weight_lock(\d+)", r"weight of lock \1"),
    (r"weight_lock(\d+)_swapped", r"weight of lock \1, first two swapped"),
    (r"weight_sum", r"sum of weights"),
    (r"weight_sum_rounded_down", r"sum of weights, rounded down"),
    (r"best_option", r"option that fits best"),
)


def name_of(quantity: str) -> str:
    """A quantity of the validation table in words; itself if there are none."""
    for pattern, words in NAMES:
        if found := re.fullmatch(pattern, quantity):
            return found.expand(words)
    return quantity


def difference(row: Any) -> str:
    """How a row's computed value differs from the published one, in words."""
    if pd.isna(row.absolute_difference):
        return "same" if row.computed == row.published else "other"
    if pd.isna(row.relative_difference):
        return f"{row.absolute_difference:+.3f}"
    return f"{100 * row.relative_difference:+.2f} %"
