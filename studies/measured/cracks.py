"""Where walls cracked in laboratories, beside the mechanism of limit analysis.

A wall that rocks leaves a part behind: in each course, what turns about the toe reaches as far as
the stair of the crack.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from sidmacib.answers.ask import limit_of
from sidmacib.drawing import SKY, VERMILION
from sidmacib.mechanics.assembly import Floats
from sidmacib.mechanics.limit import LimitState
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.structure_file import structure_of
from workflow.results.tables import Table

CRACKS = Table("cracks", ("specimen", "course", "crack_m", "computed_m"), ("specimen", "course"))
STONE = "c"  # begins the names of stones
TURNS = 0.5  # of the largest rotation: less stays behind


@dataclass(frozen=True, eq=False)
class Cracked:
    """A wall in elevation: corners of its stones (m) and whether each turns, and its crack.

    ``low``, ``high``: (K, 2), along the wall and up. ``crack``: how far from the toe, course by
    course from the lowest, m.
    """

    specimen: str
    low: Floats
    high: Floats
    turns: Floats
    crack: Sequence[float]

    @classmethod
    def of(cls, specimen: str, description: Mapping[str, Any], crack: Sequence[float]) -> "Cracked":
        """By the mechanism of limit analysis of a structure's file."""
        problem = structure_of(description)
        limit = limit_of(problem)
        assert isinstance(limit, LimitState)
        turn = np.abs(limit.mechanism[:, 4])
        stones = [
            (np.array(piece.vertices)[:, [0, 2]], turn[k] > TURNS * turn.max())
            for k, piece in enumerate(problem.assembly.pieces)
            if isinstance(piece, Block) and piece.name.startswith(STONE) and not piece.fixed
        ]
        low, high = (
            np.array([end(each, axis=0) for each, _ in stones]) for end in (np.min, np.max)
        )
        return cls(specimen, low, high, np.array([turns for _, turns in stones]), crack)

    @property
    def toe(self) -> float:
        """Where the wall is pushed to, m."""
        return float(self.high[:, 0].max())

    @property
    def rows(self) -> Iterable[dict[str, Any]]:
        """Rows of `CRACKS`."""
        courses = np.unique(self.low[:, 1].round(6))
        for number, (bottom, crack) in enumerate(zip(courses, self.crack, strict=False), start=1):
            here = self.turns & np.isclose(self.low[:, 1], bottom)
            far = self.toe - self.low[here, 0].min() if here.any() else 0.0
            yield {
                **{"specimen": self.specimen, "course": number, "crack_m": crack},
                "computed_m": round(float(far), 6),
            }

    def draw(self, axes: Axes) -> None:
        """Stones that turn in colour, and the crack."""
        for low, high, turns in zip(self.low, self.high, self.turns, strict=True):
            look = {"facecolor": SKY if turns else "white", "edgecolor": "black", "linewidth": 0.6}
            axes.add_patch(Rectangle(low, *(high - low), **look))
        levels = np.unique(np.concatenate([self.low[:, 1], self.high[:, 1]]).round(6))
        x = np.repeat(self.toe - np.array(self.crack), 2)
        z = np.repeat(levels, 2)[1 : len(x) + 1]
        axes.plot(x, z, color=VERMILION, linewidth=2.5, label="crack in the test")
        axes.set(title=self.specimen, xlabel="along the wall (m)", aspect="equal")
        axes.autoscale_view()


def cracks_figure(walls: Sequence[Cracked]) -> Figure:
    """All walls, one beside the other."""
    figure = Figure(figsize=(4.0 * len(walls), 4.6), layout="constrained")
    for axes, wall in zip(figure.subplots(1, len(walls), squeeze=False)[0], walls, strict=True):
        wall.draw(axes)
    figure.axes[0].set_ylabel("height (m)")
    figure.axes[0].legend(loc="lower left", fontsize=8)
    return figure
