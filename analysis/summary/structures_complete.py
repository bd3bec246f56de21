"""Whether every case of a structure has a result, or a model that says why it cannot have one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflow.results.tables import STRUCTURES, read_table


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> str | None:
    """Write how many cases there are; returns the names and reasons of those without a result."""
    cases = read_table(STRUCTURES, inputs["structures"])
    failed = cases[cases["error"].notna()]
    if failed.empty:
        outputs["mark"].write_text(f"{len(cases)} cases\n")
        return None
    lines = [f"{row.case} ({row.model}): {row.error}" for row in failed.itertuples(index=False)]
    return "\n".join([f"{len(failed)} of {len(cases)} cases have no result:", *lines])
