"""What the command `assembly` prints and writes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from sidmacib.command.answers import Row
from sidmacib.command.output import say, text_of
from sidmacib.command.structures import (
    force_rows,
    limit_of,
    stands_turned,
    static_of,
    structure_notes,
    telling,
)
from sidmacib.command.verdicts import (
    case_rows,
    chosen_case,
    demanded_rows,
    reserve_rows,
    without_loads,
)
from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.structure.files.structure_file import Demand, demands_of
from sidmacib.structure.loads import SupportMotion

Answered = tuple[Sequence[Row] | None, bool]


@dataclass(frozen=True)
class Wanted:
    """What is asked for.

    ``form``: of the table; ``interfaces``: their forces in place of loads; ``case``: one load case;
    ``without_load``: the reserve in place of the file's loads; ``engines``: others that are asked
    where a support moves; and the files to be written.
    """

    form: str
    interfaces: bool
    case: str | None
    without_load: bool
    compas: Path | None
    capacity_curve: Path | None
    picture: Path | None
    report: Path | None
    note: Path | None
    engines: Sequence[str]

    @property
    def still(self) -> Path | None:
        """The file for a picture of the structure, not of the capacity curve."""
        return self.picture if self.capacity_curve is None else None

    @property
    def draws(self) -> bool:
        """Whether a page, a picture or a note is asked for."""
        return any(path is not None for path in (self.report, self.still, self.note))

    def refuse(self, words: str, *names: str) -> None:
        """`click.UsageError` in these ``words`` for the first of these options that is given."""
        for name in names:
            if getattr(self, name):
                raise click.UsageError(f"--{name.replace('_', '-')}: {words}")


def answered(file: Path, description: Any, wanted: Wanted) -> Answered:
    """Print and write what is wanted of a ``description`` in a ``file``.

    Returns rows, at least one of which must have a number, or None; and whether the verdict is yes.
    """
    if wanted.without_load:
        wanted.refuse("must not be given beside --reserve, which leaves out all loads", "case")
        description = without_loads(description)
    demands = demands_of(description, file.parent)
    if wanted.engines and not isinstance(demands[0].problem.loads, SupportMotion):
        raise click.UsageError("--model: is for a support that moves only")
    notes = structure_notes(demands[0].problem, description)
    for line in notes:
        click.echo(f"Note: {line}", err=True)
    if wanted.case is not None:
        demands = (chosen_case(demands, wanted.case),)
    elif demands[0].case is not None or not demands[0].raises:
        rows, passes = _of_several(demands, wanted)
        if not passes and not demands[0].raises:
            _note_turned(description, file.parent)
        return rows, passes
    if isinstance(demands[0].problem.loads, SupportMotion):
        return _of_support(file, demands[0], wanted)
    return _of_load(file, description, demands[0], notes, wanted)


def _note_turned(description: Any, folder: Path) -> None:
    """Say how blocks that do not stand as they are would."""
    if key := stands_turned(description, folder):
        click.echo(f"Note: it stands with {key}", err=True)


def _of_several(demands: Sequence[Demand], wanted: Wanted) -> Answered:
    """The verdict on load cases, or what there is in reserve without a load."""
    needs = "--case, as the file has load_cases" if demands[0].raises else "a load"
    others = "interfaces", "compas", "capacity_curve", "picture", "report", "note"
    wanted.refuse(f"needs {needs}", *others)
    rows, words, passes = case_rows(demands) if demands[0].raises else reserve_rows(demands)
    say(words, wanted.form)
    click.echo(text_of(rows, wanted.form))
    return None, passes


def _of_support(file: Path, demand: Demand, wanted: Wanted) -> Answered:
    from sidmacib.command.displacements import support_rows, write_curve

    others = "interfaces", "compas", "report", "note"
    wanted.refuse("must not be given where a support moves", *others)
    rows, moves = support_rows(demand.problem, "yade" in wanted.engines)
    click.echo(text_of(rows, wanted.form))
    write_curve(moves, file.stem, wanted.capacity_curve, wanted.picture)
    return None, True


def _of_load(
    file: Path, description: Any, demand: Demand, notes: Sequence[str], wanted: Wanted
) -> Answered:
    problem, passes, words = demand.problem, True, ""
    rows: list[Row] = []
    asked = wanted.draws or not wanted.interfaces
    tell = telling(problem)
    limit = limit_of(problem, tell) if asked or wanted.compas is not None else None
    if isinstance(limit, InfeasibleError):
        _note_turned(description, file.parent)
    static = static_of(problem, limit, tell)
    if asked:
        rows, found = demanded_rows(demand, limit, static, tell)
        if found is not None:
            passes, words = found.passes, str(found)
            say(words, wanted.form)
    shown = rows
    if wanted.interfaces:
        if isinstance(static, CapacityError):
            raise static
        shown = force_rows(static)
    click.echo(text_of(shown, wanted.form))
    if wanted.compas is not None:
        from sidmacib.structure.files.compas_results import write_compas_results

        write_compas_results(problem, file, wanted.compas, limit)
    if wanted.draws:
        from sidmacib.command.structure_views import Views

        views = Views.of(file, description, problem, limit, static, notes, words)
        views.write(rows, wanted.report, wanted.still, wanted.note)
    if wanted.capacity_curve is not None:
        from sidmacib.command.displacements import curve_rows, write_curve

        moves, end = curve_rows(problem)
        click.echo(f"Capacity curve: {end}.", err=True)
        write_curve(moves, file.stem, wanted.capacity_curve, wanted.picture)
    return None if words else shown, passes  # the verdict is an answer, also without a number
