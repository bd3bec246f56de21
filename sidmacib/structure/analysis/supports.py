"""Supports that settle, spread or turn: reactions by limit analysis, and where the structure falls.

The reaction is the force (N) of the structure on the support along its movement, or the moment
(N m) about the axis about which it turns. As a support yields, the reaction drops to the least that
limit analysis admits (as it is pushed back, it rises to the greatest): the structure becomes a
mechanism that follows the support. Its blocks are then followed as they move, see
`sidmacib.structure.analysis.kinematics`, until no forces balance their weight. Joints are rigid and
dry.
"""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import DOES_NOT_STAND, InfeasibleError, UnboundedError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.structure.analysis.kinematics import (
    FALL,
    PRESSED,
    REACHED,
    STILL,
    Kinematics,
    Path,
    Position,
)
from sidmacib.structure.loads import SupportMotion


@dataclass(frozen=True, eq=False)
class Reaction:
    """A reaction (N or N m), the mechanism, (P, 6) per m or rad, and its joints by name."""

    size: float
    mechanism: Floats
    hinges: tuple[str, ...]
    slides: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class SupportPath:
    """The reaction (N or N m) over the ``movement`` of the support (m or rad), both (K,).

    ``hinges``, ``slides``: at the last movement. ``path``: the positions.
    """

    movement: Floats
    reaction: Floats
    hinges: tuple[str, ...]
    slides: tuple[str, ...]
    path: Path

    @property
    def falls(self) -> bool:
        """Whether the structure falls at the last movement."""
        return self.path.end == FALL

    @property
    def free(self) -> bool:
        """Whether the structure stands without the support, which no longer carries anything."""
        return self.path.end == REACHED


def least_reaction(assembly: Assembly, loads: SupportMotion) -> Reaction:
    """The reaction when the support yields.

    `InfeasibleError` if the structure does not stand, `CapacityError` for interfaces that are not
    dry.
    """
    return _reaction(assembly, loads, -1.0)


def greatest_reaction(assembly: Assembly, loads: SupportMotion) -> Reaction | None:
    """The reaction when the support is pushed back; None without limit. Errors of the least."""
    against = replace(loads, along=tuple(-each for each in loads.along))
    try:
        return _reaction(assembly, against, 1.0)
    except UnboundedError:
        return None


def _reaction(assembly: Assembly, loads: SupportMotion, sign: float) -> Reaction:
    kinematics = Kinematics.of(assembly, loads)
    try:
        start = kinematics.start()
    except InfeasibleError:
        raise InfeasibleError(DOES_NOT_STAND) from None
    return Reaction(sign * start.load + 0.0, start.motion, *kinematics.moving(start))


def support_path(assembly: Assembly, loads: SupportMotion) -> SupportPath:
    """Follow the structure as the support yields, until it falls or no longer needs the support.

    Errors of `least_reaction`.
    """
    kinematics = Kinematics.of(assembly, loads)
    free = [number for number, piece in enumerate(assembly.pieces) if not piece.fixed]

    def stands_alone(here: Position) -> bool:
        moves = np.abs(here.motion[free].reshape(-1, 2, 3)).max(axis=(0, 2)) @ [1, assembly.length]
        return abs(here.load) <= PRESSED * loads.scale and bool(moves <= STILL)

    try:
        path = kinematics.path(stands_alone)
    except InfeasibleError:
        raise InfeasibleError(DOES_NOT_STAND) from None
    movement, load = np.array([(each.moved, each.load) for each in path.positions]).T
    return SupportPath(movement, -load, *kinematics.moving(path.positions[-1]), path)
