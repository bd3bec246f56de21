"""Output of the command for structures that move: capacity curves, and supports that move."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sidmacib.command.answers import Row, reason
from sidmacib.command.output import draw, text_of, write_text
from sidmacib.drawing import SKY
from sidmacib.errors import CapacityError
from sidmacib.problem import Problem
from sidmacib.structure.analysis.capacity_curve import CapacityCurve, capacity_curve
from sidmacib.structure.analysis.support_path import StaticReactions, static_reactions
from sidmacib.structure.analysis.supports import (
    SupportPath,
    greatest_reaction,
    least_reaction,
    support_path,
)
from sidmacib.structure.loads import SupportMotion, free_weight

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_JOINTS = 6  # names in a note


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
    return rows, _curve_words(curve)


def _curve_words(curve: CapacityCurve) -> str:
    return f"{curve.end} along it; {_joints(curve.hinges, curve.slides)} at the start"


def support_rows(problem: Problem) -> tuple[list[Row], list[Row]]:
    """What a support that moves does: reactions by each model, and the reaction over the movement.

    `CapacityError` if the structure does not stand, or an interface is not dry.
    """
    assembly, loads = problem
    assert isinstance(loads, SupportMotion)
    least, path = least_reaction(assembly, loads), support_path(assembly, loads)
    greatest = greatest_reaction(assembly, loads)
    rows = [
        *_static(problem, least.size),
        _row(
            loads,
            "limit, least",
            least.size,
            None,
            f"the support yields; {_joints(least.hinges, least.slides)}",
        ),
        _row(
            loads,
            "limit, greatest",
            greatest.size if greatest else None,
            None,
            f"the support is pushed back; {_joints(greatest.hinges, greatest.slides)}"
            if greatest
            else "no limit: the support can be pushed back with any force",
        ),
        _row(
            loads,
            "kinematics",
            float(path.reaction[-1]),
            float(path.movement[-1]),
            _end(path),
        ),
    ]
    what, moved = _columns(loads)
    curve: list[Row] = [
        {moved: _in_degrees(loads, movement), what: reaction}
        for movement, reaction in zip(path.movement.tolist(), path.reaction.tolist(), strict=True)
    ]
    return rows, curve


def _static(problem: Problem, least: float) -> Iterator[Row]:
    loads = problem.loads
    assert isinstance(loads, SupportMotion)
    try:
        found: StaticReactions = static_reactions(problem.assembly, loads, least)
    except CapacityError as error:
        yield _row(loads, "static", None, None, reason(error))
        return
    yield _row(loads, "static, at rest", found.rest, 0.0, "elastic joints; small displacements")
    reached = "has dropped to" if found.dropped(least) else "is followed to"
    last = float(found.reaction[-1]), float(found.movement[-1])
    yield _row(loads, "static, yields", *last, f"the reaction {reached} this")


def _end(path: SupportPath) -> str:
    if path.falls:
        return f"the structure falls; {_joints(path.hinges, path.slides)}"
    if path.free:
        return "the support carries nothing more: the structure stands without it"
    if path.path.met:
        return f"{' and '.join(path.path.met)} meet; it was followed no further"
    return "the structure still stands; it was followed no further"


def _joints(hinges: Sequence[str], slides: Sequence[str]) -> str:
    """Names of hinges and of joints that slide, in words."""
    both = [
        f"{words} {', '.join(names[:MOST_JOINTS])}"
        + (f" and {len(names) - MOST_JOINTS} others" if len(names) > MOST_JOINTS else "")
        for words, names in (("hinges at", hinges), ("sliding at", slides))
        if names
    ]
    return ", ".join(both) or "no joint opens or slides"


def _columns(loads: SupportMotion) -> tuple[str, str]:
    """Names of the columns of the reaction and of the movement."""
    if loads.turns:
        return "reaction (N m)", "movement (degrees)"
    return "reaction (N)", "movement (m)"


def _in_degrees(loads: SupportMotion, movement: float) -> float:
    """A movement in m, or in degrees in place of rad."""
    return math.degrees(movement) if loads.turns else movement


def _row(
    loads: SupportMotion, model: str, reaction: float | None, movement: float | None, note: str
) -> Row:
    what, moved = _columns(loads)
    shown = None if movement is None else _in_degrees(loads, movement)
    return {"model": model, what: reaction, moved: shown, "note": note}


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
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.0), layout="constrained")
    axes = figure.subplots()
    moved, force = list(rows[0])[:2]
    axes.plot([row[moved] for row in rows], [row[force] for row in rows], color=SKY)
    axes.set_xlabel(moved)
    axes.set_ylabel(force)
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=min(0.0, *(row[force] for row in rows)))
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    return figure
