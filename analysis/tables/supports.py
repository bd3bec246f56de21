"""Table of the supports that move: reactions, and the movement at which structures fall."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

from sidmacib.answers.supports import support_answers
from sidmacib.engines.curve import yade_answer
from sidmacib.errors import CapacityError
from sidmacib.problem import Problem
from sidmacib.structure.loads import SupportMotion
from workflow.case import StructureSubject
from workflow.results.record import rounded_or_none
from workflow.results.tables import SUPPORTS, write_table
from workflow.step import Arguments, Files, step


def support_rows(cases: Iterable[tuple[StructureSubject, str, bool]]) -> Iterator[dict[str, Any]]:
    """A row for each answer to a subject in a variant; where there is none, the note says why.

    The last of each case: whether YADE is asked.
    """
    for subject, variant, yade in cases:
        row = {"structure": subject.structure, "load": subject.load, "variant": variant}
        assembly, loads = subject.problem()
        assert isinstance(loads, SupportMotion)
        try:
            answers, _ = support_answers(assembly, loads)
            if yade:
                answers.append(yade_answer(Problem(assembly, loads)))
        except CapacityError as error:
            yield {**row, "answer": "none", "note": " ".join(str(error).split())}
            continue
        reaction, movement, unit = "reaction_N", "movement_m", 1.0
        if loads.turns:
            reaction, movement, unit = "reaction_Nm", "movement_degrees", math.degrees(1.0)
        for each in answers:
            yield {
                **row,
                "answer": each.answer,
                reaction: rounded_or_none(each.reaction),
                movement: None if each.movement is None else rounded_or_none(unit * each.movement),
                "note": each.note,
            }


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the table; ``cases``: names of structure and load, description, and variant of each,
    and whether YADE is asked.
    """
    cases = [(StructureSubject(*of), variant, yade) for *of, variant, yade in arguments["cases"]]
    write_table(SUPPORTS, SUPPORTS.frame(support_rows(cases)), outputs["supports"])


if __name__ == "__main__":
    step(run)
