"""Whether every case of a structure has a result, or a refusal with a reason."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from analysis.summary.complete import marked
from workflow.results.tables import STRUCTURES, read_table


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> str | None:
    """Write how many cases there are; returns the names and reasons of those without a result."""
    return marked(read_table(STRUCTURES, inputs["structures"]), "case", outputs["mark"])
