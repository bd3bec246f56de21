"""The last step of a study, which fails unless every case has a result."""

from pathlib import Path

import pandas as pd

from workflow.results.tables import CASES, STRUCTURES, read_table
from workflow.step import Arguments, Files, step


def run(arguments: Arguments, inputs: Files, outputs: Files) -> str | None:
    """Write how many cases there are; returns the names and reasons of those without a result."""
    joints = "cases" in inputs
    kind, names = (CASES, "name") if joints else (STRUCTURES, "case")
    return marked(read_table(kind, inputs[kind.name]), names, outputs["mark"])


def marked(cases: pd.DataFrame, names: str, mark: Path) -> str | None:
    """Implement `run` for ``cases`` whose names are in the column ``names``."""
    failed = cases[cases["error"].notna()]
    if failed.empty:
        mark.write_text(f"{len(cases)} cases\n")
        return None
    rows = failed[[names, "model", "error"]].itertuples(index=False)
    lines = [f"{name} ({model}): {error}" for name, model, error in rows]
    return "\n".join([f"{len(failed)} of {len(cases)} cases have no result:", *lines])


if __name__ == "__main__":
    step(run)
