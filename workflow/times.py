"""What jobs took, as each leaves it beside its results: for reports, and nothing depends on it."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = ".times"
KEYS = ("wall_s", "own_cpu_s", "programs_cpu_s")


def read_times(results: Path) -> Iterator[tuple[str, dict[str, float]]]:
    """Kind of each job, and its s on the clock, of its own processor and of its programs.

    What is not whole is left out.
    """
    for path in sorted((results / FOLDER).rglob("*.json")):
        try:
            told: Any = json.loads(path.read_text())
            times = {key: float(told[key]) for key in KEYS}
        except (OSError, ValueError, TypeError, KeyError, RecursionError):
            continue
        yield path.relative_to(results / FOLDER).parts[0].removesuffix(".json"), times
