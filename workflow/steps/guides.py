"""Where an engine begins to search in each of its cases, found at once for all of them.

What finds it takes as long to load as an engine takes to start.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sidmacib.errors import CapacityError
from workflow.engines import ENGINES
from workflow.engines.guide import guide_for
from workflow.joints.case import Case
from workflow.joints.problem import problem_of
from workflow.run.step import step


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, Path]
) -> None:
    """Write the guides by the digests of their cases."""
    guides = {}
    for case in map(Case.from_json, arguments["cases"]):
        assert case.numerics is not None, f"{case.name}: an engine needs numerics"
        try:
            guide = guide_for(ENGINES[case.model], problem_of(case), case.numerics)
        except (CapacityError, ValueError, MemoryError):
            continue  # the case itself tells why
        guides[case.digest()] = None if guide is None else asdict(guide)
    outputs["guides"].write_text(json.dumps(guides, indent=1) + "\n")


if __name__ == "__main__":
    step(run)
