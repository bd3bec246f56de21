"""Pages and pictures of a structure."""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import click

from sidmacib.answers.structure import StaticAnswer
from sidmacib.answers.structure_words import answer_words
from sidmacib.command.answers import Row, reason
from sidmacib.command.output import cell, write_text
from sidmacib.errors import CapacityError
from sidmacib.mechanics.limit import LimitState
from sidmacib.models import MODELS, structure_limit, structure_static
from sidmacib.problem import Problem
from sidmacib.scene.drawn import Drawn
from sidmacib.scene.loads import arrows_of, load_of
from sidmacib.scene.page import page
from sidmacib.scene.solids import shape_of
from sidmacib.structure.loads import free_weight


@dataclass(frozen=True, eq=False)
class Views:
    """What is drawn of a structure: its ``title``, ``answer`` in words, ``notes``, and ``models``.

    ``models``: the static model, then limit analysis.
    """

    title: str
    problem: Problem
    answer: str
    notes: Sequence[str]
    models: Sequence[Drawn]

    @classmethod
    def of(
        cls,
        file: Path,
        problem: Problem,
        limit: LimitState | CapacityError | None,
        static: StaticAnswer | CapacityError,
        notes: Sequence[str],
    ) -> "Views":
        """From what the models answer; ``limit``: None where gravity turns."""
        answer = f"No answer from the static model: {static}"
        found = Drawn("static", problem, error=str(static))
        if isinstance(static, StaticAnswer):
            tilts = problem.loads.axis is not None
            weight = None if tilts else free_weight(problem.assembly)
            answer = answer_words(static.load, weight, static.counts, static.mode)
            found = Drawn("static", problem, structure_static.outcome_of(problem, static))
        drawn = [found, _limit(problem, limit)]
        if found.outcome is None:
            drawn.reverse()
        return cls(file.stem, problem, f"{answer[0].upper()}{answer[1:]}.", notes, drawn)

    @property
    def about(self) -> str:
        """What the structure is, and its load."""
        assembly = self.problem.assembly
        free = sum(not piece.fixed for piece in assembly.pieces)
        many = f"{free} free and {len(assembly.pieces) - free} fixed blocks"
        weight = f"weight of the free blocks {free_weight(assembly):.4g} N"
        return f"{many}, {len(assembly.faces)} interfaces; {weight}. {load_of(self.problem)}."

    def write_report(self, path: Path, rows: Sequence[Row]) -> None:
        """Write the page, with the ``rows`` that are printed; `click.UsageError`."""
        data = {
            "shape": shape_of(self.problem.assembly),
            "loads": arrows_of(*self.problem),
            "models": [{"name": MODELS[each.model].label, **each.values()} for each in self.models],
        }
        words = {
            "title": self.title,
            "answer": self.answer,
            "about": self.about,
            "notes": self.notes,
            "head": list(rows[0]),
            "rows": [[_shown(value) for value in row.values()] for row in rows],
            "version": version("multilock"),
            "command": shlex.join(["multilock", *sys.argv[1:]]),
        }
        try:
            text = page(data, words)
        except ValueError as error:
            raise click.UsageError(f"--report: {error}") from None
        write_text(text, path, "--report")


def _limit(problem: Problem, limit: LimitState | CapacityError | None) -> Drawn:
    try:
        if limit is None:
            return Drawn("limit", problem, structure_limit.solve(problem))
    except CapacityError as error:
        limit = error
    if isinstance(limit, CapacityError):
        return Drawn("limit", problem, error=reason(limit))
    return Drawn("limit", problem, structure_limit.outcome_of(problem, limit))


def _shown(value: Any) -> dict[str, Any]:
    return {"text": cell(value), "number": isinstance(value, int | float)}
