"""Output of the command for structures of blocks: loads, forces, capacity curves, supports."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.answers.verdict import lower_first
from sidmacib.command.answers import Row, reason
from sidmacib.command.output import draw, plot, text_of, write_text
from sidmacib.drawing import SKY
from sidmacib.errors import CapacityError, NoEquilibriumError
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.limit import LimitState, require_standing
from sidmacib.mechanics.sliding import sliding_limit
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits, some_of
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.kinematics import capacity_curve
from sidmacib.structure.analysis.limit import assumes, limit_mesh_error, limit_state, limit_tilt
from sidmacib.structure.analysis.second_order import rotation_effect, rotation_words
from sidmacib.structure.analysis.supports import joints_in_words, support_answers
from sidmacib.structure.analysis.tilt import Tilt, load_of_tilt, moves_most, turning
from sidmacib.structure.files.loads import load_warnings
from sidmacib.structure.files.sections import StructureFile
from sidmacib.structure.files.structure_file import Demand, demands_of
from sidmacib.structure.loads import SupportMotion, free_weight, naming_permanent
from sidmacib.structure.warnings import structure_warnings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FULL = 1.0 - 1e-4  # of a limit: an interface that uses more is at it
MOST = 6  # names in a note
LARGE = 2000  # contact nodes of a structure: of a larger one, results are told as they come

Tell = Callable[[str], object]


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


def stands_turned(description: Mapping[str, Any], folder: Path) -> str:
    """The key by which blocks of files stand, though they do not as they are, or nothing."""
    blocks = description["blocks"]
    files = {name: each for name, each in blocks.items() if "file" in each and "up" not in each}
    for up in ("y", "x") if files else ():
        turned = {name: {**each, "up": up} for name, each in files.items()}
        try:
            demands = demands_of({**description, "blocks": {**blocks, **turned}}, folder)
            require_standing(*demands[0].problem, friction=True)
        except (ValueError, CapacityError):
            continue
        return f"up: {up} (on the command line --up {up})"
    return ""


def telling(problem: Problem) -> Tell:
    """A function that tells, on standard error, what is found of a large structure."""
    if len(problem.assembly.nodes.area) <= LARGE:
        return str
    return lambda words: click.echo(words, err=True)


def limit_of(problem: Problem, tell: Tell = str) -> LimitState | CapacityError | None:
    """Limit analysis with friction, or why it has no answer; None if gravity turns."""
    if problem.loads.axis is not None:
        return None
    assembly = problem.assembly
    free = sum(not piece.fixed for piece in assembly.pieces)
    tell(f"{free:,} free blocks, {len(assembly.faces):,} contact faces: limit analysis ...")
    try:
        found = limit_state(*problem)
    except CapacityError as error:
        return error
    share = found.load / free_weight(assembly)
    tell(f"limit: {four_digits(found.load)} N, {share:.4g} of the weight")
    return found


def static_of(
    problem: Problem, limit: LimitState | CapacityError | None, tell: Tell = str
) -> StaticAnswer | CapacityError:
    """The answer of the static model, or why it has none; ``limit``: by `limit_of`."""
    tell("static model ...")
    try:
        return static_answer(problem, limit)
    except CapacityError as error:
        tell(f"static: no answer: {reason(error)}")
        return error


def structure_rows(
    demand: Demand,
    limit: LimitState | CapacityError | None,
    static: StaticAnswer | CapacityError,
    tell: Tell,
) -> list[Row]:
    """Capacity of a structure by each model: loads, or angles if gravity turns.

    With factors where a load is to be carried. ``limit`` and ``static``: by `limit_of` and
    `static_of`.
    """
    of_limit = [*(_limit_tilt(demand) if limit is None else _limits(demand, limit, tell))]
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
            "interface": each.name,
            "compression (N)": each.normal,
            "shear (N)": each.shear,
            "utilisation": each.utilisation,
            "bonded": each.bonded,
        }
        for each in interface_forces(answer.assembly, state.force, state.state)
    ]


def _crushed(problem: Problem, limit: LimitState) -> str:
    """Which interfaces limit analysis presses to the compressive strength, in words."""
    use = crushing_use(problem.assembly, limit.force[None, :, 0])
    names = [problem.assembly.faces[number].name for number, of in use.items() if of[0] > FULL]
    return f"crushed: {some_of(names, MOST)}" if names else ""


def _torque(limit: LimitState) -> str:
    """That torque limits the load, in words, and the load without that limit."""
    if limit.untwisted is None or four_digits(limit.untwisted) == four_digits(limit.load):
        return ""
    others = "no limit" if math.isinf(limit.untwisted) else f"{four_digits(limit.untwisted)} N"
    return f"limited by the torque of interfaces ({others} without)"


def _limits(demand: Demand, limit: LimitState | CapacityError, tell: Tell) -> Iterator[Row]:
    if isinstance(limit, CapacityError):
        yield _row(demand, "limit", None, reason(limit))
        return
    problem = demand.problem
    moves = f"largest displacement: {moves_most(problem.assembly, limit.mechanism)}"
    notes = assumes(problem.assembly), _torque(limit), _crushed(problem, limit), moves
    note, error = "; ".join(filter(None, notes)), limit_mesh_error(problem, limit.load)
    yield _row(demand, "limit", limit.load, note, error)
    tell("limit analysis without dilation ...")
    try:
        with naming_permanent(problem.loads):
            sliding = sliding_limit(*problem, limit)
        yield _row(demand, "limit, no dilation", sliding.state.load, sliding.note)
    except CapacityError as failure:
        yield _row(demand, "limit, no dilation", None, reason(failure))


def _limit_tilt(demand: Demand) -> Iterator[Row]:
    assembly, loads = demand.problem
    try:
        with naming_permanent(loads):
            limit = limit_tilt(assembly, Tilt.of(loads))
        if limit.mechanism is None:
            note = "in equilibrium at every tilt"
        else:
            moves = moves_most(assembly, limit.mechanism)
            note = f"{assumes(assembly)}; largest displacement: {moves}"
        error = limit_mesh_error(demand.problem, limit.angle)
        yield _row(demand, "limit", limit.angle, note, error)
    except CapacityError as failure:
        yield _row(demand, "limit", None, reason(failure))


def _static(demand: Demand, answer: StaticAnswer | CapacityError) -> Row:
    if isinstance(answer, CapacityError):
        return _row(demand, "static", None, reason(answer))
    note = _note(demand.problem, answer)
    return _row(demand, "static", answer.load, note, answer.mesh_error, answer)


def _note(problem: Problem, answer: StaticAnswer) -> str:
    """The load that counts, the reason, the end of the peak, and what small displacements miss."""
    moves = ""
    if answer.mechanism is not None:
        moves = f"; largest displacement: {moves_most(answer.assembly, answer.mechanism)}"
    rotation = rotation_words(_rotation_effect(problem, answer)) or "small displacements"
    return f"{answer.counts}; failure mode: {answer.mode}{moves}; {rotation}"


def _rotation_effect(problem: Problem, answer: StaticAnswer) -> float | None:
    """The change of the load that counts by finite rotation, over it; None where it is unknown."""
    assembly, loads, load = answer.assembly, problem.loads, answer.load
    if not load > 0.0:
        return None
    path = [point for point in answer.path if point.load <= answer.state.load]
    if loads.axis is None:
        change = rotation_effect(assembly, loads, path, load)
    else:
        loads = turning(assembly, Tilt.of(loads), load)
        change, load = rotation_effect(assembly, loads, path, 0.0), load_of_tilt(load, loads)
    return None if change is None else change / load


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
    rows: list[Row] = [
        {
            "displacement (m)": moved,
            "load (N)": load,
            "load / weight": load / weight,
            "largest rotation (degrees)": turned,
        }
        for moved, load, turned in zip(
            curve.displacement.tolist(), curve.load.tolist(), curve.rotation.tolist(), strict=True
        )
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
    curve: list[Row] = [
        {moved: unit * movement, what: reaction}
        for movement, reaction in zip(path.movement.tolist(), path.reaction.tolist(), strict=True)
    ]
    return rows, curve


def write_curve(rows: Sequence[Row], title: str, curve: Path | None, picture: Path | None) -> None:
    """Write ``rows`` into the file ``curve``, in CSV, and draw them into ``picture``.

    `click.UsageError` for a file that cannot be written, and for no rows.
    """
    if not rows and (curve or picture):
        raise click.UsageError("no curve to write or draw: see the row kinematics")
    if curve is not None:
        write_text(text_of(rows, "csv") + "\n", curve, "--capacity-curve")
    if picture is not None:
        draw(_picture(rows, title), picture)


def _picture(rows: Sequence[Row], title: str) -> "Figure":
    """The first number of ``rows`` to the right, the second upwards."""
    moved, force = list(rows[0])[:2]
    figure, axes = plot(title, moved, force)
    axes.plot([row[moved] for row in rows], [row[force] for row in rows], color=SKY)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=min(0.0, *(row[force] for row in rows)))
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    return figure
