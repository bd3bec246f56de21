"""Write the decks for 3DEC."""

from workflow.case import JointCase
from workflow.run.step import Arguments, FileLists, Files, step
from workflow.threedec import deck


def run(arguments: Arguments, inputs: Files, outputs: FileLists) -> None:
    """Write the deck of each case."""
    for data, path in zip(arguments["cases"], outputs["decks"], strict=True):
        path.write_text(deck(JointCase.from_json(data)))


if __name__ == "__main__":
    step(run)
