"""Meanings of the columns of the study's tables, for readers; no table depends on them."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from workflow.results import tables
from workflow.results.tables import Table

TABLES: tuple[Table, ...] = tuple(each for each in vars(tables).values() if isinstance(each, Table))
MORE: Mapping[str, Sequence[str]] = {  # columns of a table that may follow those it must have
    tables.MODELS.name: ("displacement_at_<share>_percent_m", "weight_lock<number>", "case"),
}
_READ = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
MEANINGS: Mapping[str, str] = _READ["meanings"]
EXCEPTIONS: Mapping[str, Mapping[str, str]] = _READ["exceptions"]  # by table


def meaning(table: Table, column: str) -> str:
    """The meaning of a ``column`` of a table; KeyError if it has none."""
    return EXCEPTIONS.get(table.name, {}).get(column) or MEANINGS[column]


def columns_of(table: Table) -> tuple[str, ...]:
    """All columns of a table, those that may follow as well."""
    return *table.columns, *MORE.get(table.name, ())
