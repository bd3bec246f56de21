"""Tables and numbers as pages have them."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import pandas as pd

from workflow.results.tables import Table, read_table


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def percent(value: float, digits: int = 1) -> str:
    """A part in percent, with its sign."""
    return signed(f"{100.0 * value:+.{digits}f} %")


def signed(text: str) -> str:
    """A number with the sign that print has."""
    return text.replace("-", "−")


def size(value: float, digits: int = 1) -> str:
    """A part in percent that has no sign."""
    return f"{100.0 * value:.{digits}f} %"


def direction(ratio: float) -> str:
    """An eccentricity over a in words."""
    return "torsion" if ratio == float("inf") else f"{ratio:g}"


def body(name: str) -> str:
    """The upper body in words."""
    return "one piece" if name == "monolithic" else name


def table_in(results: Path, form: Table) -> pd.DataFrame:
    """A table of the study in ``results``."""
    return read_table(form, results / "tables" / f"{form.name}.csv")
