"""What the command `assembly` prints and writes: loads, forces, verdicts and reserves."""

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sidmacib.answers.ask import Solved, Tell, limit_of, static_of
from sidmacib.answers.in_time import TimeAnswer
from sidmacib.answers.reserve import Followed, Reserve, reserve, under
from sidmacib.answers.verdict import lower_first
from sidmacib.command.answers import Row
from sidmacib.command.cases import case_rows, factor_picture
from sidmacib.command.in_time import (
    collapse_row,
    drift_picture,
    history_rows,
    time_page,
    time_rows,
    yade_row,
)
from sidmacib.command.output import (
    draw,
    keep_names,
    require_answer,
    say,
    status_line,
    text_of,
    write_text,
)
from sidmacib.command.seismic import answer, checked, seismic_note, seismic_picture, seismic_rows
from sidmacib.command.structures import (
    curve_rows,
    force_rows,
    note_turned,
    structure_rows,
    support_rows,
    write_curve,
)
from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.mechanics.assembly import Vector
from sidmacib.mechanics.crushing import crushed_faces
from sidmacib.problem import Problem
from sidmacib.structure.analysis.limit import LimitTilt, assumes
from sidmacib.structure.analysis.reserve import Push
from sidmacib.structure.analysis.tilt import moves_most
from sidmacib.structure.files.structure_file import Demand, demands_of, files_behind, notes_on
from sidmacib.structure.loads import SupportMotion
from sidmacib.structure.partial_factors import PartialFactors
from sidmacib.structure.shaking import TimeLoads
from sidmacib.structure.structure import with_dry_joints
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

if TYPE_CHECKING:
    from matplotlib.figure import Figure

OF_LOADS = "interfaces", "compas", "capacity_curve", "note"
ALONG_X: Vector = (1.0, 0.0, 0.0)
ALONE = "needs a load that is one acceleration"
LASTS = "needs a load with a duration (load.duration)"
NO_LIMIT = "no limit: more than 100"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """What is asked for of the ``description`` in a ``file``.

    ``form``: of the table; ``interfaces``: their forces in place of loads; ``case``: one load case;
    ``without_load``: the reserve in place of the file's loads; ``factors``: partial ones;
    ``engines``: others that are asked where a support moves; and the files to be written.
    ``notes``: on what looks wrong; ``tell``: is told what is done.
    """

    file: Path
    description: Any
    form: str
    interfaces: bool
    case: str | None
    without_load: bool
    factors: PartialFactors
    compas: Path | None
    capacity_curve: Path | None
    picture: Path | None
    report: Path | None
    note: Path | None
    history: Path | None
    collapse: bool
    seismic: bool
    engines: Sequence[str]
    notes: Sequence[str] = ()
    tell: Tell = str

    @property
    def still(self) -> Path | None:
        """The file for a picture of the structure, not of the capacity curve."""
        return self.picture if self.capacity_curve is None else None

    @property
    def command(self) -> str:
        """The command line."""
        return shlex.join(["multilock", *sys.argv[1:]])

    @property
    def inputs(self) -> list[Path]:
        """The files that the description is from: the one given, YAML beside it, and meshes."""
        beside = self.file.with_suffix(".yaml")
        unread = beside != self.file and beside.is_file() and "blocks" in read_yaml(beside)
        found = dict.fromkeys(filter(Path.is_file, files_behind(self.file, self.description)))
        return [path for path in found if path != beside or not unread]

    def show(self, rows: Sequence[Row], **about: Any) -> None:
        """Print ``rows``; ``about``: what JSON and CSV say beside them and the input."""
        given = {"file": self.file.name, "input": self.description, "notes": list(self.notes)}
        given |= self.factors.named if self.factors else {}
        click.echo(text_of(rows, self.form, {**about, **given}))

    @property
    def draws(self) -> bool:
        """Whether a page, a picture or a note is asked for."""
        return any(path is not None for path in (self.report, self.still, self.note))

    def draw(
        self,
        rows: Sequence[Row],
        solved: Solved,
        verdict: str,
        curve: "Figure | None" = None,
    ) -> None:
        """Write the page, the picture and the note that are asked for.

        ``curve``: of a factor over positions, which is drawn in place of the structure.
        """
        from sidmacib.command.structure_views import Views, structure_note
        from sidmacib.scene.page import page

        views = Views.of(self.file, self.description, solved, self.notes, verdict, curve)
        if self.report is not None:
            write_text(page(*views.content(rows, self.command)), self.report, "--report")
        if self.still is not None:
            from sidmacib.scene.picture import picture

            title = f"{views.title}: {views.answer}"
            draw(curve or picture(views.models[0], views.shape, title), self.still)
        if self.note is not None:
            note = structure_note(views, rows, self.command, self.inputs)
            write_text(note, self.note, "--note")

    def refuse(self, words: str, *names: str) -> None:
        """`click.UsageError` in these ``words`` for the first of these options that is given."""
        for name in names:
            if getattr(self, name):
                raise click.UsageError(f"--{name.replace('_', '-')}: {words}")


def passes(wanted: Wanted) -> bool:
    """Print and write what is ``wanted``; False if the verdict is no.

    Ends with status 1 where there is neither a verdict nor a number.
    """
    if wanted.without_load:
        wanted.refuse("must not be given beside --reserve, which leaves out all loads", "case")
        description = wanted.description
        if isinstance(description, dict):
            loads = "load", "load_cases"
            description = {key: each for key, each in description.items() if key not in loads}
        wanted = replace(wanted, description=description)
    demands = demands_of(
        wanted.description, wanted.file.parent, in_time=True, factors=wanted.factors
    )
    first = demands[0]
    built, cases = first.problem.assembly, [demand.case or "" for demand in demands]
    pieces, faces = [each.name for each in built.pieces], [each.name for each in built.faces]
    keep_names((*pieces, *faces, *cases))
    if wanted.engines and not isinstance(first.problem.loads, SupportMotion | TimeLoads):
        raise click.UsageError("--model: is for a support that moves, or ground that does")
    wanted = replace(wanted, notes=notes_on(wanted.description, first.problem.assembly))
    for line in wanted.notes:
        click.echo(f"Note: {line}", err=True)
    if wanted.case is not None:
        names = [demand.case for demand in demands if demand.case is not None]
        if not names:
            raise ValueError(f"--case {wanted.case}: the file has no load_cases")
        if wanted.case not in names:
            raise refused("--case", wanted.case, " or ".join(names))
        first = demands[names.index(wanted.case)]
    elif not first.raises:
        return _reserve_passes(wanted, first)
    elif first.case is not None:
        return _cases_pass(wanted, demands)
    if wanted.seismic:
        return _bears_earthquake(wanted, first.problem)
    if isinstance(first.problem.loads, TimeLoads):
        return _stands_in_time(wanted, first.problem)
    wanted.refuse(LASTS, "history", "collapse")
    if isinstance(first.problem.loads, SupportMotion):
        _answer_support(wanted, first.problem)
        return True
    return _load_passes(wanted, first)


def _cases_pass(wanted: Wanted, demands: Sequence[Demand]) -> bool:
    """The verdict on all load cases; the one that governs is drawn and noted."""
    others = "interfaces", "compas", "capacity_curve"
    wanted.refuse("needs --case, as there are several load cases", *others)
    wanted.refuse(ALONE, "seismic")
    wanted.refuse(LASTS, "history", "collapse")
    rows, found, governs = case_rows(demands, wanted.tell)
    say(str(found), wanted.form)
    wanted.show(rows, **found.told)
    if wanted.draws:
        curve = factor_picture(wanted.file.stem, demands, rows)
        wanted.draw(rows, governs, str(found), curve)
    return found.passes


def _reserve_passes(wanted: Wanted, demand: Demand) -> bool:
    """What there is in reserve without a load; drawn under the acceleration that fells it first."""
    wanted.refuse("needs a load", "interfaces", "compas", "capacity_curve")
    wanted.refuse(ALONE, "seismic")
    wanted.refuse(LASTS, "history", "collapse")
    rows, words, passes, weakest = reserve_rows(demand.problem, wanted.tell)
    say(words, wanted.form)
    wanted.show(rows, verdict=words.partition(":")[0].lower(), answer=words)
    if wanted.draws:
        solved = Solved.of(Demand(under(demand.problem, weakest)))
        wanted.draw(rows, solved, words)
    if not passes:
        note_turned(wanted.description, wanted.file.parent)
    return passes


def _stands_in_time(wanted: Wanted, problem: Problem) -> bool:
    """What happens in time, and at which factor on the ground motion the structure falls."""
    wanted.refuse("must not be given where loads act in time", *OF_LOADS)
    assert isinstance(problem.loads, TimeLoads), "loads in time"
    if not problem.loads.ground:
        wanted.refuse("needs load.ground", "collapse")
    for line in problem.loads.cut_off:
        click.echo(f"Note: {line}", err=True)
    with status_line() as progress:
        answer = TimeAnswer.of(problem, progress)
        rows = time_rows(answer)
        if wanted.engines:
            rows.append(yade_row(problem, progress))
        if wanted.collapse:
            rows.append(collapse_row(answer, progress))
    say(answer.words, wanted.form)
    about = {"verdict": answer.said.lower(), "answer": answer.words}
    wanted.show(rows, **about)
    if wanted.history is not None:
        write_text(text_of(history_rows(answer), "csv") + "\n", wanted.history, "--history")
    if wanted.picture is not None:
        draw(drift_picture(answer, wanted.file.stem), wanted.picture)
    if wanted.report is not None:
        text = time_page(answer, wanted.file.stem, rows, wanted.notes, wanted.command)
        write_text(text, wanted.report, "--report")
    return answer.said == "Yes"


def _bears_earthquake(wanted: Wanted, problem: Problem) -> bool:
    """Whether the mechanism bears the displacement that the spectrum in the file asks for."""
    others = "case", "interfaces", "compas", "capacity_curve", "report"
    wanted.refuse("must not be given beside --seismic", *others)
    if wanted.factors:
        raise click.UsageError("--gamma-g, -q, -m: must not be given beside --seismic, with its FC")
    wanted.refuse(LASTS, "history", "collapse")
    found = checked(wanted.description, problem)
    bears, words = answer(found)
    say(words, wanted.form)
    wanted.show(seismic_rows(found), verdict="yes" if bears else "no", answer=words)
    if wanted.picture is not None:
        draw(seismic_picture(found, wanted.file.stem), wanted.picture)
    if wanted.note is not None:
        about = wanted.file.stem, wanted.notes, wanted.command, wanted.inputs
        write_text(seismic_note(found, *about), wanted.note, "--note")
    return bears


def _answer_support(wanted: Wanted, problem: Problem) -> None:
    others = "interfaces", "compas", "report", "note"
    wanted.refuse("must not be given where a support moves", *others)
    rows, moves = support_rows(problem, "yade" in wanted.engines)
    wanted.show(rows)
    write_curve(moves, wanted.file.stem, wanted.capacity_curve, wanted.picture)


def _load_passes(wanted: Wanted, demand: Demand) -> bool:
    """Loads, and the verdict if one is to be carried; or forces of interfaces."""
    problem = demand.problem
    rows: list[Row] = []
    tell = wanted.tell
    limit = limit_of(problem, tell)
    if isinstance(limit, InfeasibleError):
        note_turned(wanted.description, wanted.file.parent)
    solved = Solved(demand, limit, static_of(problem, limit, tell))
    verdict = solved.verdict
    if verdict is not None:
        say(str(verdict), wanted.form)
    if wanted.draws or not wanted.interfaces:
        rows = structure_rows(solved, tell)
    shown = rows
    if wanted.interfaces:
        if isinstance(solved.static, CapacityError):
            raise solved.static
        shown = force_rows(solved.static)
    told = verdict.told if verdict else {}
    wanted.show(shown, **{"case": demand.case, "required (N)": demand.newtons}, **told)
    if wanted.compas is not None:
        from sidmacib.structure.files.compas_results import write_compas_results

        found = None if isinstance(limit, LimitTilt) else limit
        write_compas_results(problem, wanted.file, wanted.compas, found)
    if wanted.draws:
        wanted.draw(rows, solved, str(verdict or ""))
    if wanted.capacity_curve is not None:
        moves, end = curve_rows(problem)
        click.echo(f"Capacity curve: {end}.", err=True)
        write_curve(moves, wanted.file.stem, wanted.capacity_curve, wanted.picture)
    if verdict is None:
        require_answer(shown)
    return verdict is None or verdict.passes


def reserve_rows(problem: Problem, tell: Tell = str) -> tuple[list[Row], str, bool, Vector]:
    """What a structure has in reserve without a load, the verdict, and whether it stands.

    And the direction of the acceleration that fells it first, or x.
    """

    def table(*cells: tuple[str, str, float | None, str]) -> list[Row]:
        head = "model", "reserve", "value", "note"
        return [dict(zip(head, each, strict=True)) for each in cells]

    try:
        found = reserve(problem, tell)
    except CapacityError as error:
        said = "No" if isinstance(error, InfeasibleError) else "Open"
        rows = table(("limit", "stands", None, str(error)))
        return rows, f"{said}: {lower_first(str(error))}", False, ALONG_X
    if found.bonds:
        problem = with_dry_joints(problem)
    note = _factor_note(found.factor, dry=found.dry)
    cells = [("limit", "geometrical safety factor", found.factor, note)]
    if crushed_faces(problem.assembly):
        note = "strength of the blocks over the strength needed" if found.strength else NO_LIMIT
        cells.append(("limit", "factor of compressive strengths", found.strength, note))
    pushes = [push for push in found.tried if 1.0 in map(abs, push.direction)]
    named = [("least horizontal", found.least), *(("horizontal", push) for push in pushes)]
    for name, push in named:
        if push is not None:
            tilt = "" if push.tilt is None else f"a tilt of {push.tilt:.4g} degrees; "
            moves = f"largest displacement: {moves_most(problem.assembly, push.mechanism)}"
            note = f"{assumes(problem.assembly)}; {tilt}{moves}"
            what = f"{name} acceleration (g), towards {_way(push.direction)}"
            cells.append(("limit", what, push.acceleration, note))
    stands = f"with dry joints; {found.bonds}" if found.bonds else "in equilibrium"
    cells.append(("static", "stands", None, found.static or stands))
    if found.followed is not None:
        least = found.followed
        what = f"least horizontal acceleration (g), towards {_way(least.direction)}"
        note = "first failure of a bond" if least.bonds else "the peak"
        cells.append(("static", what, least.acceleration, note))
    words = f"Yes: {_stands(found)}"
    if found.falls:
        words = f"No: {lower_first(found.static)} in the static model"
    weakest = found.decides.direction if found.decides else ALONG_X
    return table(*cells), words, not found.falls, weakest


def _factor_note(factor: float | None, *, dry: bool) -> str:
    if factor is not None:
        return "thickness of the interfaces over the least with which it stands"
    return NO_LIMIT if dry else "for dry interfaces only"


def _stands(found: Reserve) -> str:
    words, first = "it stands", found.decides
    if found.bonds:
        words += " with dry joints"
    if found.factor is not None:
        words += f", with a geometrical safety factor of {found.factor:.3g}"
    if first is None:
        words += "; no horizontal acceleration fells it in limit analysis"
    else:
        what = "it falls"
        if isinstance(first, Followed) and first.bonds:
            what = "its first bond fails"
        words += f"; {what} at {first.acceleration:.3g} g towards {_way(first.direction)}"
        if isinstance(first, Push) and first.tilt is not None:
            words += f", a tilt of {first.tilt:.3g} degrees"
        if found.followed is None:
            words += " in limit analysis, which may overestimate"
    if found.static:
        words += f"; the static model: {found.static}"
    return f"{words}; {found.bonds}" if found.bonds else words


def _way(direction: Vector) -> str:
    return f"({', '.join(f'{each:.3g}' for each in direction[:2])})"
