"""The keys of a structure's file for a vehicle that moves over it."""

import math
from collections.abc import Iterator, Sequence
from itertools import accumulate
from typing import Annotated, Self

import numpy as np
from pydantic import model_validator

from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.loads import Loads
from sidmacib.quantities import Newtons, Number
from sidmacib.reading import Keys, PlanPoint, Some
from sidmacib.structure.loads import Permanent
from sidmacib.structure.vehicle import Deck, Position

BESIDE = 1e-3  # m: from a joint, of an axle that would be on it
DIGITS = 9  # of a position (m) after the decimal point
MOVING = "vehicle: moves, and is for multilock assembly only"


class VehicleSection(Keys):
    """A vehicle that moves over the blocks; each axle presses on the highest face under it.

    At each position all its axles are raised together, but for those beside the free blocks.
    """

    axles: Annotated[tuple[Newtons, ...], Some]
    """axle loads, the leading one first, N"""
    spacings: tuple[Annotated[float, Number(above=0, unit="m")], ...] = ()
    """distances from each axle to the one behind it, m"""
    start: PlanPoint
    """x and y of the leading axle at the first position"""
    end: PlanPoint
    """likewise at the last; the other axles follow in this line"""
    positions: Annotated[int, Number(at_least=2, at_most=1000, whole=True)] = 21
    """how many, at equal distances; two for one at which an axle would be on a joint"""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if len(self.spacings) != len(self.axles) - 1:
            raise ValueError(
                f"spacings: {list(self.spacings)} is not allowed; it must have "
                f"{len(self.axles) - 1} distances for {len(self.axles)} axles"
            )
        if self.start == self.end:
            raise ValueError(f"end: {list(self.end)} is not allowed; it must differ from start")
        apart = math.dist(self.start, self.end) / (self.positions - 1)
        if apart < 4.0 * BESIDE:
            allowed = f"they must be at least {4.0 * BESIDE:g} m apart"
            raise ValueError(f"positions: {self.positions} is not allowed; {allowed}")
        return self

    def on(
        self, assembly: Assembly, beside: Permanent, key: str
    ) -> list[tuple[Position, Loads, float]]:
        """Each position with an axle on a free block, the loads, and how much presses there (N).

        ``beside``: permanent loads beside weight. ValueError, which names the ``key``, without one.
        """
        deck, start, end = Deck(assembly), np.array(self.start), np.array(self.end)
        unit = (end - start) / math.dist(start, end)
        straight = [name for name, part in zip("xy", unit, strict=True) if abs(part) == 1.0]
        behind = list(accumulate(self.spacings, initial=0.0))
        found: list[tuple[Position, Loads, float]] = []
        for leading in self._places(deck, start, end, behind):
            axles = self._axles(leading, unit, behind)
            loads, pressing = deck.standing(axles, beside)
            if pressing:
                at = leading @ abs(unit) if straight else (leading - start) @ unit
                position = Position("".join(straight) or "s", round(float(at), DIGITS) + 0.0)
                found.append((position, loads, pressing))
        if not found:
            raise ValueError(f"{key}.vehicle: no axle is above a free block at any position")
        return found

    def _axles(
        self, leading: Floats, unit: Floats, behind: Sequence[float]
    ) -> list[tuple[float, float, float]]:
        """Place (x, y in m) and load (N) of each axle; ``unit``: the direction of travel."""
        places = [leading - distance * unit for distance in behind]
        return [(x, y, newtons) for (x, y), newtons in zip(places, self.axles, strict=True)]

    def _places(
        self, deck: Deck, start: Floats, end: Floats, behind: Sequence[float]
    ) -> Iterator[Floats]:
        """Places of the leading axle: where an axle would be on a joint, just before and behind.

        There it presses on one block at a time, which may carry less than both.
        """
        unit = (end - start) / math.dist(start, end)
        for leading in np.linspace(start, end, self.positions):
            axles = self._axles(leading, unit, behind)
            on_joint = any(len(deck.under(x, y)[1]) > 1 for x, y, _ in axles)
            yield from (leading + k * BESIDE * unit for k in ((-1, 1) if on_joint else (0,)))
