"""What the command `assembly` prints and draws of load cases, also of a vehicle that moves."""

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from sidmacib.answers.ask import Solved, Tell
from sidmacib.answers.verdict import Verdict, factor_of, governing, on_all
from sidmacib.command.answers import Row
from sidmacib.command.output import plot
from sidmacib.drawing import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION
from sidmacib.structure.files.structure_file import Demand

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = BLUE, ORANGE, GREEN, PURPLE  # of vehicles
SHOWN = 4.0  # times the lowest factor: higher ones are beyond the picture


def case_rows(demands: Sequence[Demand], tell: Tell = str) -> tuple[list[Row], Verdict, Solved]:
    """One row for each load case, the verdict on all of them, and the case that governs.

    ``tell`` is told which is computed.
    """
    solved, moves = [], any(demand.position for demand in demands)
    for demand in demands:
        tell(f"{demand.case} ...")
        solved.append(Solved.of(demand))
    found = [each.verdict for each in solved if each.verdict is not None]
    names = [str(demand.case) for demand in demands]
    first = governing(found)
    rows: list[Row] = [
        {
            "case": name,
            **(_place(answer.demand) if moves else {}),
            "required (N)": each.newtons,
            "carried": "yes" if each.passes else "no",
            "factor": each.factor,
            "to first failure": each.first,
            "to peak": each.peak,
            "to limit": each.limit,
            "decides": each.decides,
            "mesh error / load": answer.of_static.mesh_error,
            "governs": "yes" if each is found[first] else "",
            "note": each.note or each.words,
        }
        for name, answer, each in zip(names, solved, found, strict=True)
    ]
    return rows, on_all(names, found), solved[first]


def _place(demand: Demand) -> Row:
    return {"position (m)": demand.position and demand.position.value}


def factor_picture(title: str, demands: Sequence[Demand], rows: Sequence[Row]) -> "Figure | None":
    """The factor over the position of each vehicle; None where nothing moves, or has a factor.

    ``rows``: of `case_rows`, of these ``demands``.
    """
    points = [
        (str(demand.case).removesuffix(str(demand.position)), demand.position, row["factor"])
        for demand, row in zip(demands, rows, strict=True)
        if demand.position is not None and row["factor"] is not None
    ]
    if not points:
        return None
    axis = {position.axis for _, position, _ in points}
    figure, axes = plot(title, f"{'/'.join(sorted(axis))} of the leading axle (m)", "load factor")
    for number, (name, those) in enumerate(groupby(points, key=lambda point: point[0])):
        x, y = zip(*((position.value, factor) for _, position, factor in those), strict=True)
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(x, y, color=colour, marker="o", markersize=3, label=name.rstrip(", "))
    _, lowest, factor = min(points, key=lambda point: point[2])
    axes.plot(lowest.value, factor, color=VERMILION, marker="v", markersize=9)
    words = f"{factor_of(factor)} at {lowest.axis} = {lowest.value:.4g} m"
    axes.annotate(words, (lowest.value, factor), (0, -18), textcoords="offset points", ha="center")
    axes.axhline(1.0, color=GREY, linewidth=0.8)
    axes.set_ylim(0.0, SHOWN * max(factor, 0.5))
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    if len({name for name, *_ in points}) > 1:
        axes.legend(loc="upper right")
    return figure
