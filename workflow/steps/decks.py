"""Write the decks for 3DEC."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflow.joints.case import Case
from workflow.run.step import step
from workflow.threedec import deck


def run(
    arguments: Mapping[str, Any], inputs: Mapping[str, Path], outputs: Mapping[str, list[Path]]
) -> None:
    """Write the deck of each case."""
    for data, path in zip(arguments["cases"], outputs["decks"], strict=True):
        path.write_text(deck(Case.from_json(data)))


if __name__ == "__main__":
    step(run)
