"""Tables and numbers as pages show them."""

import errno
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from workflow.results.tables import Table, read_table


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def markdown_of(table: pd.DataFrame, cells: Mapping[str, Callable[[Any], str]]) -> str:
    """A table in Markdown with a line for each row: ``cells`` has the text by column."""
    rows = [[cell(row) for cell in cells.values()] for row in table.itertuples()]
    return markdown(list(cells), rows)


def percent(value: float, digits: int = 1) -> str:
    """A share in percent, with its sign."""
    return signed(f"{100.0 * value:+.{digits}f} %")


def span(least: float, most: float, digits: int = 1, between: str = ", ") -> str:
    """Two shares in percent, with their signs."""
    return f"{percent(least, digits)}{between}{percent(most, digits)}"


def signed(text: str) -> str:
    """A number with a typographic minus sign."""
    return text.replace("-", "−")


def size(value: float, digits: int = 1) -> str:
    """A share in percent, without a sign."""
    return f"{100.0 * value:.{digits}f} %"


def direction(ratio: float) -> str:
    """An eccentricity over a in words."""
    return "torsion" if ratio == float("inf") else f"{ratio:g}"


def body(name: str) -> str:
    """The upper body in words."""
    return "one piece" if name == "monolithic" else name


def table_in(results: Path, form: Table) -> pd.DataFrame:
    """A table of the study in ``results``; FileNotFoundError if it is not there."""
    path = results / "tables" / f"{form.name}.csv"
    if not path.is_file():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    return read_table(form, path)
