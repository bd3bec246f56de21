"""What a model says of a structure, as it is drawn."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from sidmacib.mechanics.assembly import Assembly
from sidmacib.problem import Outcome, Problem
from sidmacib.quantities import four_digits
from sidmacib.scene.forces import Reaction, arrows_of, forces_of, reactions, thrust
from sidmacib.structure.analysis.forces import (
    BlockRow,
    InterfaceRow,
    block_rows,
    interfaces_of,
    most_used,
)
from sidmacib.structure.analysis.tilt import tilt_of_load

MOTION = ("move_x_m", "move_y_m", "move_z_m", "turn_x", "turn_y", "turn_z")


@dataclass(frozen=True, eq=False)
class Drawn:
    """The ``outcome`` of a ``model`` for a structure, or the ``error`` why there is none."""

    model: str
    problem: Problem
    outcome: Outcome | None = None
    error: str | None = None

    @cached_property
    def assembly(self) -> Assembly:
        """The pieces on the cells that the outcome is from."""
        return (self.outcome and self.outcome.cells) or self.problem.assembly

    @cached_property
    def interfaces(self) -> tuple[InterfaceRow, ...]:
        """At the load that counts; none without forces."""
        return interfaces_of(self.assembly, self.outcome) if self.outcome else ()

    @cached_property
    def blocks(self) -> tuple[BlockRow, ...]:
        """Centroids and motions; none without an outcome."""
        return block_rows(self.assembly, self.outcome) if self.outcome else ()

    @cached_property
    def reactions(self) -> tuple[Reaction, ...]:
        """Of the supports, at the load that counts; none without forces."""
        return reactions(self.assembly, self.interfaces)

    @cached_property
    def thrust(self) -> list[list[dict[str, Any]]]:
        """Lines of thrust at the load that counts, see `sidmacib.scene.forces.thrust`."""
        return thrust(self.assembly, self.interfaces)

    @property
    def load(self) -> float | None:
        """The load (N) that counts, or the angle (degrees) where gravity turns."""
        return None if self.outcome is None else self.shown(self.outcome.state.load)

    @property
    def load_words(self) -> str:
        """That load in a legend."""
        if self.load is None:
            return "no answer"
        if self.problem.loads.axis is None:
            return f"load, {four_digits(self.load)} N"
        return f"weight, tilted by {self.load:.4g}°"

    @property
    def arrows(self) -> dict[str, Any]:
        """Forces (N) at the load that counts, see `arrows_of`; without an outcome at none."""
        return arrows_of(*self.problem, self.outcome.state.load if self.outcome else 0.0)

    @property
    def failing(self) -> list[tuple[str, float]]:
        """Interfaces whose bonds fail on the way to the peak, and the load of the first of them.

        In N, or degrees where gravity turns; the first to fail is the first.
        """
        lost = self.outcome.broken_at if self.outcome else {}
        return [(self.assembly.faces[face].name, self.shown(load)) for face, load in lost.items()]

    def shown(self, load: float) -> float:
        """A ``load`` (N) as the command prints it: where gravity turns in degrees."""
        loads = self.problem.loads
        return load if loads.axis is None else tilt_of_load(load, loads.scale)

    def values(self) -> dict[str, Any]:
        """Plain values for `structure.js`."""
        tilts = self.problem.loads.axis is not None
        first = self.failing[0] if self.failing else (None, None)
        return {
            "row": {
                "model": self.model,
                "error": self.error,
                "refused": None,
                "load_N": None if tilts else self.load,
                "tilt_degrees": self.load if tilts else None,
                "first_interface": first[0],
                "first_failure_load_N": None if tilts else first[1],
                "first_failure_tilt_degrees": first[1] if tilts else None,
                "most_used_interface": most_used(self.interfaces),
            },
            "blocks": [*self._moving()],
            "interfaces": [asdict(row) for row in self.interfaces],
            **forces_of(self.assembly, self.interfaces),
        }

    def _moving(self) -> Iterator[dict[str, Any]]:
        for block in self.blocks:
            row = asdict(block)
            move = row.pop("move") or (None,) * len(MOTION)
            yield row | dict(zip(MOTION, move, strict=True))
