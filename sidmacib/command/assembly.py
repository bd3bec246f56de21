"""What the command `assembly` prints and writes: loads, forces, verdicts and reserves."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import click

from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.answers.verdict import Verdict, governing, lower_first, on_all, verdict
from sidmacib.command.answers import Row
from sidmacib.command.output import say, text_of
from sidmacib.command.structures import (
    Tell,
    curve_rows,
    force_rows,
    limit_of,
    stands_turned,
    static_of,
    structure_notes,
    structure_rows,
    support_rows,
    telling,
    write_curve,
)
from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.mechanics.assembly import Kind, Vector
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.mechanics.limit import LimitState
from sidmacib.problem import Problem
from sidmacib.structure.analysis.reserve import Push, Reserve, reserve
from sidmacib.structure.analysis.tilt import moves_most
from sidmacib.structure.files.structure_file import Demand, demands_of
from sidmacib.structure.loads import StructureLoads, SupportMotion, pushed
from sidmacib.validation import refused

ALONG_X: Vector = (1.0, 0.0, 0.0)
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
    elif not demands[0].raises:
        return _of_reserve(file, description, demands[0], notes, wanted)
    elif demands[0].case is not None:
        return _of_cases(file, description, demands, notes, wanted)
    if isinstance(demands[0].problem.loads, SupportMotion):
        return _of_support(file, demands[0], wanted)
    return _of_load(file, description, demands[0], notes, wanted)


def _note_turned(description: Any, folder: Path) -> None:
    """Say how blocks that do not stand as they are would."""
    if key := stands_turned(description, folder):
        click.echo(f"Note: it stands with {key}", err=True)


def _of_cases(
    file: Path, description: Any, demands: Sequence[Demand], notes: Sequence[str], wanted: Wanted
) -> Answered:
    """The verdict on all load cases; the one that governs is drawn and noted."""
    others = "interfaces", "compas", "capacity_curve"
    wanted.refuse("needs --case, as the file has load_cases", *others)
    rows, words, passes, (demand, limit, static) = case_rows(demands)
    say(words, wanted.form)
    click.echo(text_of(rows, wanted.form))
    if wanted.draws:
        _draw(wanted, rows, file, description, demand.problem, limit, static, notes, words)
    return None, passes


def _of_reserve(
    file: Path, description: Any, demand: Demand, notes: Sequence[str], wanted: Wanted
) -> Answered:
    """What there is in reserve without a load; drawn under the acceleration that fells it first."""
    wanted.refuse("needs a load", "interfaces", "compas", "capacity_curve")
    rows, words, passes, weakest = reserve_rows(demand.problem)
    say(words, wanted.form)
    click.echo(text_of(rows, wanted.form))
    if wanted.draws:
        assembly, loads = demand.problem
        assert isinstance(loads, StructureLoads), "loads of a structure"
        problem = Problem(assembly, pushed(assembly, loads, weakest))
        limit = limit_of(problem)
        static = static_of(problem, limit)
        _draw(wanted, rows, file, description, problem, limit, static, notes, words)
    if not passes:
        _note_turned(description, file.parent)
    return None, passes


def _of_support(file: Path, demand: Demand, wanted: Wanted) -> Answered:
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
        _draw(wanted, rows, file, description, problem, limit, static, notes, words)
    if wanted.capacity_curve is not None:
        moves, end = curve_rows(problem)
        click.echo(f"Capacity curve: {end}.", err=True)
        write_curve(moves, file.stem, wanted.capacity_curve, wanted.picture)
    return None if words else shown, passes  # the verdict is an answer, also without a number


def _draw(wanted: Wanted, rows: Sequence[Row], *of: Any) -> None:
    """Write the page, the picture and the note that are ``wanted``; ``of``: see `Views.of`."""
    from sidmacib.command.structure_views import Views

    Views.of(*of).write(rows, wanted.report, wanted.still, wanted.note)


def demanded_rows(
    demand: Demand,
    limit: LimitState | CapacityError | None,
    static: StaticAnswer | CapacityError,
    tell: Tell = str,
) -> tuple[list[Row], Verdict | None]:
    """`structure_rows`, and the verdict where a load is to be carried."""
    rows = structure_rows(demand, limit, static, tell)
    if demand.newtons is None or limit is None:
        return rows, None
    return rows, verdict(demand.newtons, static, limit)


class Solved(NamedTuple):
    """What limit analysis and the static model answer for a ``demand``."""

    demand: Demand
    limit: LimitState | CapacityError
    static: StaticAnswer | CapacityError


def case_rows(demands: Sequence[Demand]) -> tuple[list[Row], str, bool, Solved]:
    """One row for each load case, the verdict on all of them, and whether all are carried.

    And the case that governs.
    """
    solved, found = [], []
    for demand in demands:
        assert demand.newtons is not None, "a load case says what is to be carried"
        limit = limit_of(demand.problem)
        assert limit is not None, "no load case tilts a structure"
        static = static_of(demand.problem, limit)
        solved.append(Solved(demand, limit, static))
        found.append(verdict(demand.newtons, static, limit))
    first = governing(found)
    rows: list[Row] = [
        {
            "case": answer.demand.case,
            "required (N)": each.newtons,
            "carried": "yes" if each.passes else "no",
            "factor": each.factor,
            "to first failure": each.first,
            "to peak": each.peak,
            "to limit": each.limit,
            "mesh error / load": getattr(answer.static, "mesh_error", None),
            "governs": "yes" if number == first else "",
            "note": each.note or each.words,
        }
        for number, (answer, each) in enumerate(zip(solved, found, strict=True))
    ]
    words = on_all([str(demand.case) for demand in demands], found)
    return rows, words, all(each.passes for each in found), solved[first]


def reserve_rows(problem: Problem) -> tuple[list[Row], str, bool, Vector]:
    """What a structure has in reserve without a load, the verdict, and whether it stands.

    And the direction of the acceleration that fells it first, or x.
    """
    try:
        found = reserve(problem, telling(problem))
    except CapacityError as error:
        words, falls = str(error), isinstance(error, InfeasibleError)
        said = f"{'No' if falls else 'No answer'}: {lower_first(words)}"
        return [_reserve_row("limit", "stands", None, words)], said, False, ALONG_X
    rows = [
        _reserve_row(
            "limit", "geometrical safety factor", found.factor, _factor_note(problem, found.factor)
        )
    ]
    if crushed_faces(problem.assembly):
        note = "strength of the blocks over the strength needed"
        note = note if found.strength else "no limit: more than 100"
        rows.append(_reserve_row("limit", "factor of compressive strengths", found.strength, note))
    least = [] if found.least is None else [("least", found.least)]
    axes = [("", push) for push in found.tried if 1.0 in map(abs, push.direction)]
    for name, push in (*least, *axes):
        tilt = "" if push.tilt is None else f"a tilt of {push.tilt:.4g} degrees; "
        note = f"{tilt}largest displacement: {moves_most(problem.assembly, push.mechanism)}"
        what = f"{name} horizontal acceleration (g), towards {_way(push)}".lstrip()
        rows.append(_reserve_row("limit", what, push.acceleration, note))
    rows.append(_reserve_row("static", "stands", None, found.static or "in equilibrium"))
    weakest = ALONG_X if found.least is None else found.least.direction
    if found.falls:
        return rows, f"No: {lower_first(found.static)} in the static model", False, weakest
    return rows, f"Yes: {_stands(found)}", True, weakest


def _reserve_row(model: str, what: str, value: float | None, note: str) -> Row:
    return {"model": model, "reserve": what, "value": value, "note": note}


def _factor_note(problem: Problem, factor: float | None) -> str:
    if factor is not None:
        return "thickness of the interfaces over the least with which it stands"
    if all(face.kind is Kind.DRY for face in problem.assembly.faces):
        return "no limit: more than 100"
    return "for dry interfaces only"


def _stands(found: Reserve) -> str:
    words = "it stands"
    if found.factor is not None:
        words += f", with a geometrical safety factor of {found.factor:.3g}"
    push = found.least
    if push is None:
        words += (
            "; no horizontal acceleration fells it in limit analysis, which wedges blocks that "
        )
        words += "slide; for the static model's answer, give an acceleration as the load"
    else:
        tilt = "" if push.tilt is None else f", a tilt of {push.tilt:.3g} degrees"
        words += f"; it falls at {push.acceleration:.3g} g towards {_way(push)}{tilt}"
    return f"{words}; the static model: {found.static}" if found.static else words


def _way(push: Push) -> str:
    return f"({', '.join(f'{each:.3g}' for each in push.direction[:2])})"


def chosen_case(demands: Sequence[Demand], name: str) -> Demand:
    """The load case called ``name``; ValueError if there is none."""
    names = [str(demand.case) for demand in demands if demand.case is not None]
    if not names:
        raise ValueError(f"--case {name}: the file has no load_cases")
    if name not in names:
        raise refused("--case", name, " or ".join(names))
    return demands[names.index(name)]


def without_loads(description: Any) -> Any:
    """A ``description`` in plain values without what is raised."""
    if not isinstance(description, dict):
        return description
    return {key: value for key, value in description.items() if key not in ("load", "load_cases")}
