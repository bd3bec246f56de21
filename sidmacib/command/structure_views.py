"""Pages and pictures of a structure."""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sidmacib.answers.structure import StaticAnswer
from sidmacib.command.answers import Row, reason
from sidmacib.command.output import cell, draw, in_asked_units, in_asked_words, write_text
from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.limit import LimitState
from sidmacib.models import MODELS, structure_limit, structure_static
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits, number_of
from sidmacib.scene.drawn import Drawn
from sidmacib.scene.forces import arrows_of, load_of
from sidmacib.scene.page import page
from sidmacib.scene.solids import shape_of, with_condensed_locks
from sidmacib.structure.loads import free_weight


@dataclass(frozen=True, eq=False)
class Views:
    """What is drawn of a structure: its ``title``, ``answer`` in words, ``notes``, and ``models``.

    ``models``: the one that answers first; ``shape``: by `shape_of`.
    """

    title: str
    problem: Problem
    answer: str
    notes: Sequence[str]
    models: Sequence[Drawn]
    shape: Mapping[str, Any]

    @classmethod
    def of(
        cls,
        file: Path,
        description: Any,
        problem: Problem,
        limit: LimitState | CapacityError | None,
        static: StaticAnswer | CapacityError,
        notes: Sequence[str],
        verdict: str = "",
    ) -> "Views":
        """From what the models answer; ``limit``: None where gravity turns.

        ``verdict``: on a load that is to be carried, if there is one.
        """
        weight = None if problem.loads.axis is not None else free_weight(problem.assembly)
        by_limit = _limit(problem, limit)
        if isinstance(static, StaticAnswer):
            found = Drawn("static", problem, structure_static.outcome_of(problem, static))
            answer = _answer_words(static, weight)
        else:
            found = Drawn("static", problem, error=reason(static))
            answer = f"static model: {reason(static)}"
            if by_limit.load is not None and not isinstance(static, NoEquilibriumError):
                answer = f"limit analysis: {_load_words(by_limit.load, weight)}; {answer}"
        drawn = [found, by_limit]
        if found.outcome is None:
            drawn.reverse()
        shape = shape_of(problem.assembly, with_condensed_locks(description, file.parent))
        words = " ".join(f"{each[0].upper()}{each[1:]}." for each in (verdict, answer) if each)
        return cls(file.stem, problem, in_asked_words(words), notes, drawn, shape)

    @property
    def about(self) -> str:
        """What the structure is, and its load."""
        assembly = self.problem.assembly
        free = sum(not piece.fixed for piece in assembly.pieces)
        many = f"{free:,} free and {number_of(len(assembly.pieces) - free, 'fixed block')}"
        weight = f"weight of the free blocks {four_digits(free_weight(assembly))} N"
        load = load_of(self.problem)
        faces = number_of(len(assembly.faces), "interface")
        return in_asked_words(f"{many}, {faces}; {weight}. {load}.")

    def write(
        self, rows: Sequence[Row], report: Path | None, still: Path | None, note: Path | None
    ) -> None:
        """Write the page, the picture and the calculation note that are asked for.

        ``rows``: the table that is printed. `click.UsageError` for a file that cannot be written;
        ValueError for a page without the package plotly.
        """
        command = shlex.join(["multilock", *sys.argv[1:]])
        if report is not None:
            write_text(page(*self.content(rows, command)), report, "--report")
        if still is not None:
            from sidmacib.scene.picture import picture

            draw(picture(self.models[0], self.shape, f"{self.title}: {self.answer}"), still)
        if note is not None:
            from sidmacib.command.structure_note import structure_note

            write_text(structure_note(self, rows, command), note, "--note")

    def content(self, rows: Sequence[Row], command: str) -> tuple[dict[str, Any], dict[str, Any]]:
        """Data and words of `page`; ``rows``: the table that is printed by ``command``."""
        shown = in_asked_units(rows)
        structure = {
            "title": self.title,
            "shape": self.shape,
            "loads": arrows_of(*self.problem),
            "models": [{"name": MODELS[each.model].label, **each.values()} for each in self.models],
        }
        words = {
            "title": self.title,
            "answer": self.answer,
            "about": self.about,
            "notes": self.notes,
            "head": list(shown[0]),
            "rows": [
                [
                    {"text": cell(each), "number": isinstance(each, int | float)}
                    for each in row.values()
                ]
                for row in shown
            ],
            "command": command,
        }
        return {"structures": [structure]}, words


def _load_words(load: float, weight: float | None) -> str:
    """A ``load`` (N) beside the ``weight`` (N) of the free blocks; degrees without one."""
    if weight is None:
        return f"{load:.4g}°"
    return f"{four_digits(load)} N, {load / weight:.3g} of the weight"


def _answer_words(answer: StaticAnswer, weight: float | None) -> str:
    """What happens at the load that counts, and how the structure fails."""
    at = _load_words(answer.load, weight)
    if not answer.counts.peak:
        return f"first bond failure at {at}; {answer.counts}"
    ends = "last equilibrium" if weight is None else "peak"
    return f"{ends} at {at}; failure mode: {answer.mode}"


def _limit(problem: Problem, limit: LimitState | CapacityError | None) -> Drawn:
    try:
        if limit is None:
            return Drawn("limit", problem, structure_limit.solve(problem))
    except CapacityError as error:
        limit = error
    if isinstance(limit, CapacityError):
        return Drawn("limit", problem, error=reason(limit))
    return Drawn("limit", problem, structure_limit.outcome_of(problem, limit))
