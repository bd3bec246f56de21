"""Counts of a campaign, as a table that others can read."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path


def write_counts(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write ``rows`` below the names of their ``columns``, as CSV."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)
