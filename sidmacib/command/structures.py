"""Output of the command for structures of blocks: loads, forces, capacity curves, supports."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.answers.verdict import Verdict, lower_first, verdict
from sidmacib.command.answers import Row, reason
from sidmacib.command.output import draw, plot, text_of, write_text
from sidmacib.drawing import SKY
from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.equilibrium import has_bonds
from sidmacib.mechanics.limit import LimitState, require_standing
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.models import structure_limit
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits, some_of
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.kinematics import capacity_curve
from sidmacib.structure.analysis.limit import LimitTilt, assumes, limit_mesh_error
from sidmacib.structure.analysis.supports import joints_in_words, support_answers
from sidmacib.structure.analysis.tilt import moves_most
from sidmacib.structure.files.loads import load_warnings
from sidmacib.structure.files.sections import StructureFile
from sidmacib.structure.files.structure_file import Demand, demands_of
from sidmacib.structure.loads import SupportMotion, free_weight, naming_permanent
from sidmacib.structure.warnings import structure_warnings

FULL = 1.0 - 1e-4  # of a limit: an interface that uses more is at it
MOST = 6  # names in a note
LARGE = 2000  # contact nodes of a structure: of a larger one, results are told as they come

Tell = Callable[[str], object]
Limit = LimitState | LimitTilt | CapacityError
Static = StaticAnswer | CapacityError


def added_keys(
    *,
    fixed: str | None,
    friction: str | None,
    tolerance: str | None,
    from_file: bool,
    **of_blocks: object,
) -> dict[str, Any]:
    """Options of the command as keys of a structure's file: those that are given."""
    if fixed is not None:
        of_blocks["fixed"] = [name.strip() for name in fixed.split(",")]
    laws = {"friction": friction, "from_file": from_file or None}
    sections = {"blocks": _given(of_blocks) or None, "interfaces": _given(laws) or None}
    return _given({**sections, "tolerance": tolerance})


def _given(values: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in values.items() if value is not None}


def structure_notes(problem: Problem, description: Any) -> list[str]:
    """One line each for what looks wrong in a structure and the ``description`` that it is of."""
    given = StructureFile.read(description)
    notes = structure_warnings(problem.assembly, given.tolerance, given.interfaces.from_file)
    notes += load_warnings(problem.assembly, given.pushed)
    if given.assumed:
        notes.append(f"assumed: {', '.join(' '.join(each) for each in given.assumed.items())}")
    laws = (given.interfaces, *given.special)
    if given.locks and any(law.compressive_strength is not None for law in laws):
        notes.append("compressive_strength: does not limit interfaces with locks")
    return notes


def note_turned(description: Mapping[str, Any], folder: Path) -> None:
    """Say by which key blocks of files stand, if they do not as they are but do turned."""
    blocks = description["blocks"]
    files = {name: each for name, each in blocks.items() if "file" in each and "up" not in each}
    for up in ("y", "x") if files else ():
        turned = {name: {**each, "up": up} for name, each in files.items()}
        try:
            demands = demands_of({**description, "blocks": {**blocks, **turned}}, folder)
            require_standing(*demands[0].problem, friction=True)
        except (ValueError, CapacityError):
            continue
        click.echo(f"Note: it stands with up: {up} (on the command line --up {up})", err=True)
        return


def telling(problem: Problem) -> Tell:
    """A function that tells, on standard error, what is found of a large structure."""
    if len(problem.assembly.nodes.area) <= LARGE:
        return str
    return lambda words: click.echo(words, err=True)


def limit_of(problem: Problem, tell: Tell = str) -> Limit:
    """What limit analysis with friction finds, or why it has no answer."""
    assembly = problem.assembly
    free = sum(not piece.fixed for piece in assembly.pieces)
    tell(f"{free:,} free blocks, {len(assembly.faces):,} contact faces: limit analysis ...")
    try:
        found = structure_limit.found_for(problem)
    except CapacityError as error:
        return error
    if isinstance(found, LimitState):
        share = found.load / free_weight(assembly)
        tell(f"limit: {four_digits(found.load)} N, {share:.4g} of the weight")
    return found


def static_of(problem: Problem, limit: Limit | None, tell: Tell = str) -> Static:
    """The answer of the static model, or why it has none; ``limit``: by `limit_of`, if known."""
    tell("static model ...")
    try:
        return static_answer(problem, None if isinstance(limit, LimitTilt) else limit)
    except CapacityError as error:
        tell(f"static: no answer: {reason(error)}")
        return error


class Solved(NamedTuple):
    """What limit analysis and the static model answer for a ``demand``."""

    demand: Demand
    limit: Limit
    static: Static

    @classmethod
    def of(cls, demand: Demand) -> "Solved":
        """By `limit_of` and `static_of`."""
        limit = limit_of(demand.problem)
        return cls(demand, limit, static_of(demand.problem, limit))

    @property
    def verdict(self) -> Verdict:
        """On the load that is to be carried; only where the demand says how much that is."""
        newtons, limit = self.demand.newtons, self.limit
        assert newtons is not None and not isinstance(limit, LimitTilt)
        bonded = has_bonds(self.demand.problem.assembly)
        return verdict(newtons, self.static, limit, dry=not bonded)


def structure_rows(solved: Solved, tell: Tell = str) -> list[Row]:
    """Capacity of a structure by each model: loads, or angles if gravity turns.

    With factors where a load is to be carried.
    """
    demand, limit, static = solved
    of_limit = [*_limits(demand, limit, tell)]
    if isinstance(static, NoEquilibriumError):
        for row in of_limit:
            if row.get("load (N)", row.get("tilt (degrees)")) is not None:
                row["note"] += f"; static model: {lower_first(str(static))}"
    return [*of_limit, _static(demand, static)]


def force_rows(answer: StaticAnswer) -> list[Row]:
    """Forces of each interface at the load that counts in the static model."""
    state = answer.state
    return [
        {
            "interface": each.interface,
            "compression (N)": each.normal_N,
            "shear (N)": each.shear_N,
            "utilisation": each.utilisation,
            "bonded": each.bonded_share,
        }
        for each in interface_forces(answer.assembly, state.force, state.state)
    ]


def _limits(demand: Demand, limit: Limit, tell: Tell) -> Iterator[Row]:
    if isinstance(limit, CapacityError):
        yield _row(demand, "limit", None, reason(limit))
        return
    problem, note = demand.problem, "in equilibrium at every tilt"
    if limit.mechanism is not None:
        moves = f"largest displacement: {moves_most(problem.assembly, limit.mechanism)}"
        limited = _limited_by(problem, limit) if isinstance(limit, LimitState) else ()
        note = "; ".join((assumes(problem.assembly), *limited, moves))
    load = limit.load if isinstance(limit, LimitState) else limit.angle
    yield _row(demand, "limit", load, note, limit_mesh_error(problem, load))
    if isinstance(limit, LimitTilt):
        return
    tell("limit analysis without dilation ...")
    try:
        with naming_permanent(problem.loads):
            sliding = sliding_limit(*problem, limit)
        yield _row(
            demand, "limit, no dilation", sliding.state.load, "sliding does not open the joints"
        )
    except CapacityError as failure:
        yield _row(demand, "limit, no dilation", None, reason(failure))


def _limited_by(problem: Problem, limit: LimitState) -> Iterator[str]:
    """That torque limits the load, with the load without that; which interfaces are crushed."""
    untwisted = limit.untwisted
    if untwisted is not None and four_digits(untwisted) != four_digits(limit.load):
        others = "no limit" if math.isinf(untwisted) else f"{four_digits(untwisted)} N"
        yield f"limited by the torque of interfaces ({others} without)"
    use = crushing_use(problem.assembly, limit.force)
    names = [problem.assembly.faces[number].name for number, of in use.items() if of > FULL]
    if names:
        yield f"crushed: {some_of(names, MOST)}"


def _static(demand: Demand, answer: Static) -> Row:
    """The load that counts, the reason, and how the blocks move beyond it."""
    if isinstance(answer, CapacityError):
        return _row(demand, "static", None, reason(answer))
    moves = ""
    if answer.mechanism is not None:
        moves = f"; largest displacement: {moves_most(answer.assembly, answer.mechanism)}"
    note = f"{answer.counts}; failure mode: {answer.mode}{moves}"
    return _row(demand, "static", answer.load, note, answer.mesh_error, answer)


def _row(
    demand: Demand,
    model: str,
    load: float | None,
    note: str,
    error: float | None = None,
    answer: StaticAnswer | None = None,
) -> Row:
    """A row of the table; an ``answer`` of the static model has a first failure and a peak, too."""
    tilts = demand.problem.loads.axis is not None
    what, unit = ("tilt", "degrees") if tilts else ("load", "N")
    row: Row = {"model": model, f"{what} ({unit})": load}
    if not tilts:
        if demand.newtons is not None:
            row["factor"] = None if load is None else load / demand.newtons
        row["load / weight"] = None if load is None else load / free_weight(demand.problem.assembly)
    return row | {
        f"mesh error / {what}": error,
        f"first failure ({unit})": answer and answer.failures.first,
        f"peak ({unit})": answer and answer.failures.peak,
        "note": note,
    }


def curve_rows(problem: Problem) -> tuple[list[Row], str]:
    """The capacity curve of a structure, one row for each position, and how it ends, in words.

    `CapacityError` if there is none.
    """
    curve, weight = capacity_curve(*problem), free_weight(problem.assembly)
    points = zip(curve.displacement.tolist(), curve.load.tolist(), curve.rotation, strict=True)
    rows: list[Row] = [
        {
            "displacement (m)": moved,
            "load (N)": load,
            "load / weight": load / weight,
            "largest rotation (degrees)": float(turned),
        }
        for moved, load, turned in points
    ]
    joints = joints_in_words(curve.hinges, curve.slides)
    return rows, f"{curve.end} along it; {joints} at the start"


def support_rows(problem: Problem, yade: bool) -> tuple[list[Row], list[Row]]:
    """What a support that moves does: reactions by each model, and the reaction over the movement.

    ``yade``: whether YADE is asked too. Errors of `support_answers`.
    """
    assembly, loads = problem
    assert isinstance(loads, SupportMotion)
    answers, path = support_answers(assembly, loads)
    if yade:
        from sidmacib.engines.curve import yade_answer

        answers.append(yade_answer(problem))
    what, moved, unit = "reaction (N)", "movement (m)", 1.0
    if loads.turns:
        what, moved, unit = "reaction (N m)", "movement (degrees)", math.degrees(1.0)
    rows: list[Row] = [
        {
            "model": each.answer,
            what: each.reaction,
            moved: None if each.movement is None else unit * each.movement,
            "note": each.note,
        }
        for each in answers
    ]
    if isinstance(path, CapacityError):
        return rows, []
    points = zip((unit * path.movement).tolist(), path.reaction.tolist(), strict=True)
    return rows, [{moved: movement, what: reaction} for movement, reaction in points]


def write_curve(rows: Sequence[Row], title: str, curve: Path | None, picture: Path | None) -> None:
    """Write ``rows`` into the file ``curve``, in CSV, and draw them into ``picture``.

    `click.UsageError` for a file that cannot be written, and for no rows.
    """
    if not rows and (curve or picture):
        raise click.UsageError("no curve to write or draw: see the row kinematics")
    if curve is not None:
        write_text(text_of(rows, "csv") + "\n", curve, "--capacity-curve")
    if picture is not None:
        moved, force = list(rows[0])[:2]
        figure, axes = plot(title, moved, force)
        axes.plot([row[moved] for row in rows], [row[force] for row in rows], color=SKY)
        axes.set_xlim(left=0)
        axes.set_ylim(bottom=min(0.0, *(row[force] for row in rows)))
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        draw(figure, picture)
