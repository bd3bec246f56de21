"""What campaigns share: the command line, and a table of counts that others can read."""

import argparse
import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]


def asked(words: str | None, what: str, number: int, table: str) -> argparse.Namespace:
    """The command line of a campaign: ``number`` of ``what``, the seed, the table in ``build/``."""
    parser = argparse.ArgumentParser(description=words)
    parser.add_argument(f"--{what}", type=int, default=number, dest="number")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--table", type=Path, default=ROOT / "build" / table)
    return parser.parse_args()


def write_counts(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write ``rows`` below the names of their ``columns``, as CSV."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)


def tables_of(results: Path) -> dict[str, bytes]:
    """The tables in a results folder, by name: two runs are held against each other."""
    return {path.name: path.read_bytes() for path in sorted((results / "tables").glob("*.csv"))}
