"""What happens to a structure in time: whether it stands, how far it moves, what fells it."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sidmacib.dynamics.motion import FALLEN, History, history
from sidmacib.dynamics.roots import SURE
from sidmacib.mechanics.assembly import Floats
from sidmacib.problem import Problem
from sidmacib.quantities import four_digits
from sidmacib.structure.shaking import TimeLoads

STEEPEST = 64.0  # largest factor on the ground motion that is tried, and its inverse the least
PRECISION = 0.01  # of the factor at which a structure falls
PRESSED = 0.02  # of the smallest dimension: solids that reach deeper into each other are wrong
LOOSE = 1e-2  # changes of impulses, over the largest one: more is said
FELL = f"turned by {math.degrees(FALLEN):g} degrees, or sunk by half of its smallest dimension"


@dataclass(frozen=True)
class Extreme:
    """How far a ``block`` has moved (m) or turned (rad), the farthest of all, at a time (s)."""

    size: float
    block: str
    time: float


@dataclass(frozen=True, eq=False)
class TimeAnswer:
    """What happens to the structure of a ``problem``."""

    problem: Problem
    history: History

    @classmethod
    def of(
        cls, problem: Problem, progress: Callable[[str], object] = str, factor: float = 1.0
    ) -> "TimeAnswer":
        """What happens; ``factor`` and ``progress`` as of `history`, and its errors."""
        assembly, loads = problem
        assert isinstance(loads, TimeLoads), "loads in time"
        return cls(problem, history(assembly, loads, factor, progress=progress))

    @cached_property
    def largest_shift(self) -> Extreme:
        """Of a centroid from where it was built."""
        return self._extreme(self.history.shift)

    @cached_property
    def largest_turn(self) -> Extreme:
        """Of a block since it was built."""
        return self._extreme(self.history.turn)

    @cached_property
    def last_shift(self) -> Extreme:
        """As `largest_shift`, at the end."""
        return self._extreme(self.history.shift, len(self.history.time) - 1)

    @cached_property
    def last_turn(self) -> Extreme:
        """As `largest_turn`, at the end."""
        return self._extreme(self.history.turn, len(self.history.time) - 1)

    def _extreme(self, vectors: Floats, start: int = 0) -> Extreme:
        size = np.linalg.norm(vectors[start:], axis=2)
        when, piece = np.unravel_index(int(size.argmax()), size.shape)
        name = self.problem.assembly.pieces[int(piece)].name
        return Extreme(float(size[when, piece]), name, float(self.history.time[start + when]))

    @property
    def said(self) -> str:
        """Yes, no, or open: where blocks reach too far into each other, or a bond would fail."""
        if not self.history.stands:
            return "No"
        pressed = self.history.pressed > PRESSED * self.history.thin
        return "Open" if pressed or not self.history.holds else "Yes"

    @property
    def bond(self) -> tuple[str, float] | None:
        """The piece whose bond holds least surely, and its part of the strength; None if none."""
        used = self.history.used
        if not used.size:
            return None
        most = int(used[1].argmax())
        name = self.problem.assembly.pieces[int(self.history.roots[most])].name
        return name, float(used[0, most])

    @property
    def words(self) -> str:
        """The answer in a line, with yes or no."""
        return f"{self.said}: {self._reasons}"

    @property
    def _reasons(self) -> str:
        first, end = self.history.first_fallen, float(self.history.time[-1])
        if first is not None:
            name, time = self.problem.assembly.pieces[first].name, float(self.history.fallen[first])
            return f"{name} falls first, at {time:g} s ({FELL})"
        if self.bond and not self.history.holds:
            name, used = self.bond
            return (
                f"the bond of {name} may break: it has to carry {four_digits(used)} of its "
                f"strength, and where contacts share the load only {SURE:g} is sure; this model "
                "breaks no bonds"
            )
        if self.said == "Open":
            return f"blocks reach into each other by {self.history.pressed:.2g} m; halve load.step"
        moved, turned = self.largest_shift, self.largest_turn
        return (
            f"it stands for {end:g} s; {moved.block} moves most, by {four_digits(moved.size)} m, "
            f"and {turned.block} turns most, by {four_digits(math.degrees(turned.size))} degrees"
        )

    @property
    def note(self) -> str:
        """What the answer rests on."""
        loose = self.history.left > LOOSE
        doubt = f"; impulses are found to {100 * self.history.left:.2g} % only" if loose else ""
        pressed = f"blocks reach into each other by {self.history.pressed:.2g} m at most"
        roots = ""
        if self.bond:
            used = f"{self.history.used[0].max():.3f} of their strength"
            roots = f"what is bonded is one block, with bonds that carry at most {used}, as a mean "
            roots += "over a step; "
        return f"rigid blocks, inelastic impacts; {roots}{pressed}{doubt}"


def falls_at(
    problem: Problem, known: bool | None = None, tell: Callable[[str], object] = str
) -> float | None:
    """The factor on the ground motion at which the structure falls; None up to `STEEPEST`.

    0 if it falls down to the inverse of that. ``known``: whether it holds under the motion itself.

    By doubling or halving until it falls or stands, and bisection in between. It may stand again at
    larger factors, and fall at smaller ones that were not tried. A bond of which it is not sure
    that it holds counts as a fall. ``tell`` is told what is found.
    """
    assembly, loads = problem
    assert isinstance(loads, TimeLoads), "loads in time"

    def holds(factor: float) -> bool:
        found = history(assembly, loads, factor, until_it_falls=True)
        told = "a bond may break" if found.stands else "falls"
        tell(f"factor {factor:.4g}: {'stands' if found.holds else told}")
        return found.holds

    low = high = 1.0
    if holds(1.0) if known is None else known:
        while high == low or holds(high):
            low, high = high, 2.0 * high
            if high > STEEPEST:
                return None
    else:
        while high == low or not holds(low):
            low, high = 0.5 * low, low
            if low < 1.0 / STEEPEST:
                return 0.0
    while high - low > PRECISION * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return high
