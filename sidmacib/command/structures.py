"""Output of the command for structures of blocks: loads, forces, capacity curves, supports."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from sidmacib.answers.answer import Answer
from sidmacib.answers.ask import Solved, Tell
from sidmacib.answers.structure_paths import StaticAnswer
from sidmacib.command.answers import Row
from sidmacib.command.output import draw, plot, text_of, write_text
from sidmacib.drawing import SKY
from sidmacib.errors import CapacityError
from sidmacib.mechanics.limit import LimitState, require_standing
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.kinematics import capacity_curve
from sidmacib.structure.analysis.supports import joints_in_words, support_answers
from sidmacib.structure.files.structure_file import Demand, demands_of
from sidmacib.structure.loads import SupportMotion, free_weight


def added_keys(
    *,
    fixed: str | None = None,
    layers: str | None = None,
    friction: str | None = None,
    tolerance: str | None = None,
    from_file: bool = False,
    **of_blocks: object,
) -> dict[str, Any]:
    """Options of the command as keys of a structure's file: those that are given."""
    for key, names in (("fixed", fixed), ("layers", layers)):
        if names is not None:
            of_blocks[key] = [name.strip() for name in names.split(",")]
    laws = {"friction": friction, "from_file": from_file or None}
    sections = {"blocks": _given(of_blocks) or None, "interfaces": _given(laws) or None}
    return _given({**sections, "tolerance": tolerance})


def _given(values: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in values.items() if value is not None}


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


def structure_rows(solved: Solved, tell: Tell = str) -> list[Row]:
    """Capacity of a structure by each model: loads, or angles if gravity turns.

    With factors where a load is to be carried.
    """
    if isinstance(solved.limit, LimitState):
        tell("limit analysis without dilation ...")
    return [_row(solved.demand, answer) for answer in solved.answers]


def force_rows(answer: StaticAnswer) -> list[Row]:
    """Forces of each interface at the load that counts in the static model."""
    state = answer.state
    return [
        {
            "interface": each.interface,
            "compression (N)": each.normal_N,
            "shear (N)": each.shear_N,
            "utilisation": each.utilisation,
            "mode": each.mode,
            "bonded": each.bonded_share,
        }
        for each in interface_forces(answer.assembly, state.force, state.state)
    ]


def _row(demand: Demand, answer: Answer) -> Row:
    """A row of the table; the static model has a first failure and a peak, too."""
    raised, weight = demand.problem.loads.raised, free_weight(demand.problem.assembly)
    what, unit, load, failures = raised.name, raised.unit, answer.value, answer.failures
    row: Row = {"model": answer.model, f"{what} ({unit})": load}
    if demand.newtons is not None:
        row["factor"] = None if load is None else load / demand.newtons
    if raised.axis is None:
        row["load / weight"] = None if load is None else load / weight
    return row | {
        f"mesh error / {what}": answer.mesh_error,
        f"first failure ({unit})": failures and failures.first,
        f"peak ({unit})": failures and failures.peak,
        "note": answer.note,
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
