"""Tables of a study, as bytes: two runs are held against each other."""

from pathlib import Path


def tables_of(results: Path) -> dict[str, bytes]:
    """The tables in a results folder, by name."""
    return {path.name: path.read_bytes() for path in sorted((results / "tables").glob("*.csv"))}
