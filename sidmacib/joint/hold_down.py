"""Hold-down: the plate, force, pressure or weight that prevents rocking."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from typing import Annotated, Any

from sidmacib.quantities import Number, ReadBy, shown
from sidmacib.validation import require_member


class Hold(StrEnum):
    """The kind of a hold-down."""

    PLATE = "plate"  # fixed and frictionless, above the upper block; it can only push
    FORCE = "force"  # given, whatever the upper block does
    PRESSURE = "pressure"  # the same, per area of the upper block's top
    WEIGHT = "weight"  # nothing but self-weight


AMOUNTS = {
    Hold.FORCE: Number(at_least=0, unit="N"),
    Hold.PRESSURE: Number(at_least=0, unit="Pa"),
}
_NOTHING = Number(at_least=0, at_most=0)  # amount of a plate or of nothing


@dataclass(frozen=True)
class HoldDown:
    """Support or load on the top of the upper block; by default the fixed plate of the paper.

    ``amount``: of a force, in N, or of a pressure, in Pa; it acts downwards and is spread evenly
    over the top. ValueError if it is negative, not finite, or given with anything else.
    """

    kind: Hold = Hold.PLATE
    amount: float = 0.0

    def __post_init__(self) -> None:
        require_member(Hold, hold_down=self.kind)
        AMOUNTS.get(self.kind, _NOTHING).require(f"hold_down {self.kind}", self.amount)

    @classmethod
    def read(cls, value: Any) -> "HoldDown":
        """The hold-down given in a file: a name, or the amount by name, such as {force: 2000}.

        ValueError for anything else.
        """
        if isinstance(value, HoldDown):
            return value
        if isinstance(value, str) and value in (Hold.PLATE, Hold.WEIGHT):
            return cls(Hold(value))
        if isinstance(value, Mapping) and len(value) == 1:
            ((kind, amount),) = value.items()
            if kind in AMOUNTS:
                try:
                    return cls(Hold(kind), AMOUNTS[Hold(kind)].read(amount))
                except ValueError as error:
                    raise ValueError(f"{kind}: {error}") from None
        names = ", ".join(kind for kind in Hold if kind not in AMOUNTS)
        amounts = " or ".join(f"{{{kind}: a number ({x.unit})}}" for kind, x in AMOUNTS.items())
        raise ValueError(f"{_shown(value)} is not allowed; it must be {names}, {amounts}")

    @property
    def spelled(self) -> str | dict[str, float]:
        """The value as `read` accepts it."""
        kind = str(self.kind)
        return {kind: self.amount} if self.kind in AMOUNTS else kind

    @classmethod
    def plate(cls) -> "HoldDown":
        """A fixed, frictionless plate."""
        return cls(Hold.PLATE)

    @classmethod
    def force(cls, newtons: float) -> "HoldDown":
        """A force in N."""
        return cls(Hold.FORCE, newtons)

    @classmethod
    def pressure(cls, pascals: float) -> "HoldDown":
        """A pressure in Pa."""
        return cls(Hold.PRESSURE, pascals)

    @classmethod
    def weight(cls) -> "HoldDown":
        """Self-weight alone."""
        return cls(Hold.WEIGHT)

    def force_on(self, area: float) -> float | None:
        """The force (N) on a top of this ``area`` (m2); None for a plate, which only reacts."""
        if self.kind is Hold.PLATE:
            return None
        return self.amount * area if self.kind is Hold.PRESSURE else self.amount


HeldDown = Annotated[
    HoldDown,
    ReadBy(
        HoldDown.read,
        {
            "anyOf": [
                {"enum": [str(kind) for kind in Hold if kind not in AMOUNTS]},
                *(
                    {
                        "type": "object",
                        "properties": {str(kind): number.schema},
                        "required": [str(kind)],
                        "additionalProperties": False,
                    }
                    for kind, number in AMOUNTS.items()
                ),
            ],
            "allowed": "`plate`, `weight`, `{force: N}` or `{pressure: Pa}`",
        },
        lambda hold_down: hold_down.spelled,
    ),
]


def _shown(value: Any) -> str:
    """``value`` in a message; of a mapping its first keys."""
    if isinstance(value, Mapping) and value:
        return f"a mapping of {', '.join(map(shown, islice(value, 5)))}"
    return shown(value)
