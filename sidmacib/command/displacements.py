"""Output of the command for structures that move: capacity curves, and supports that move."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sidmacib.command.answers import Row
from sidmacib.command.output import draw, plot, text_of, write_text
from sidmacib.drawing import SKY
from sidmacib.problem import Problem
from sidmacib.structure.analysis.kinematics import capacity_curve
from sidmacib.structure.analysis.supports import joints_in_words, support_answers
from sidmacib.structure.loads import SupportMotion, free_weight

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    curve: list[Row] = [
        {moved: unit * movement, what: reaction}
        for movement, reaction in zip(path.movement.tolist(), path.reaction.tolist(), strict=True)
    ]
    return rows, curve


def write_curve(rows: Sequence[Row], title: str, curve: Path | None, picture: Path | None) -> None:
    """Write ``rows`` into the file ``curve``, in CSV, and draw them into ``picture``.

    `click.UsageError` for a file that cannot be written.
    """
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
