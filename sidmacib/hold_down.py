"""What holds the joint down, against rocking."""

from dataclasses import dataclass
from enum import StrEnum

from sidmacib.validation import refused, require_member, require_not_negative


class Hold(StrEnum):
    """The kind of a hold-down."""

    PLATE = "plate"  # fixed and frictionless, above the upper block; it can only push
    FORCE = "force"  # given, whatever the upper block does
    PRESSURE = "pressure"  # the same, per area of the upper block's top
    WEIGHT = "weight"  # nothing but self-weight


@dataclass(frozen=True)
class HoldDown:
    """What acts on the top of the upper block: by default the fixed plate of the paper.

    ``amount``: of a force, in N, or of a pressure, in Pa; it acts downwards and is spread evenly
    over the top. ValueError if it is negative, not finite, or given with anything else.
    """

    kind: Hold = Hold.PLATE
    amount: float = 0.0

    def __post_init__(self) -> None:
        require_member(Hold, hold_down=self.kind)
        require_not_negative(**{f"hold_down {self.kind}": self.amount})
        if self.amount and self.kind in (Hold.PLATE, Hold.WEIGHT):
            raise refused(f"hold_down {self.kind}", self.amount, "0: it has no amount")

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
