"""How pieces move, and when they fall."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from .assembly import GivenAssembly, Vector, length, plus, turned
from .records import EngineOutcome

STILL_FASTEST = 0.9  # of its largest speed since the last equilibrium: less is coming to rest
STEADY = 0.1  # of the way in the first half of the time: less in the second is coming to rest
FASTER = 1.1  # times the way in the time before: more is running away
SWING = 1e-4  # over the motion that is a fall: less may be a swing
DRIVEN = 0.01  # displacement that the load works on over the motion: less is a drift


class PieceMotion(NamedTuple):
    """Displacement (m) of a piece's centroid, and its rotation as a vector (rad)."""

    displacement: Vector
    rotation: Vector


STILL = PieceMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Fall:
    """Watches pieces on their way from one equilibrium to the next.

    ``limit`` (m): they fall that have moved further, and move as fast as never before on this way.
    What slows down may come to rest, wherever that is.
    """

    def __init__(self, assembly: GivenAssembly, limit: float, start: Sequence[PieceMotion]) -> None:
        """``start``: the motions of all pieces at the last equilibrium."""
        self.limit, self.way, self.fastest = limit, [(0, 0.0)], 0.0
        self.assembly, self.before = assembly, assembly.displacement(start.__getitem__)
        self.start = start

    def sees(self, motions: Sequence[PieceMotion], steps: int) -> bool:
        """Whether a piece falls, ``steps`` of time after the last look; exits if it is nowhere."""
        ways = [
            way(self.assembly, index, self.start[index], motions[index])
            for index in self.assembly.free
        ]
        if not math.isfinite(sum(ways)):
            raise SystemExit(f"the computation has diverged: displacements {ways} m")
        (time, before), moved = self.way[-1], max(ways)
        self.way.append((time + steps, moved))
        self.fastest = max(self.fastest, (moved - before) / steps)
        return moved > self.limit and moved - before >= STILL_FASTEST * self.fastest * steps

    def runs_away(self) -> bool:
        """Whether a piece has been faster in the last third of the time than in the second one."""
        second, last, end = self._after(1 / 3), self._after(2 / 3), self.way[-1][1]
        return end - last > max(FASTER * (last - second), SWING * self.limit)

    def _after(self, share: float) -> float:
        """How far (m) a piece had moved after a ``share`` of the time."""
        end = self.way[-1][0]
        return next(far for time, far in self.way if time >= share * end)

    def at_last(self, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """Outcome where nobody waits longer: just above the peak, pieces may fall very slowly."""
        middle, moved = self._after(1 / 2), self.way[-1][1]
        goes_on = moved - middle > max(STEADY * middle, SWING * self.limit)
        return self.outcome(motions) if goes_on else EngineOutcome.UNSETTLED

    def ahead(self, motions: Sequence[PieceMotion]) -> list[PieceMotion]:
        """Motions where pieces that go on as from the start to ``motions`` have fallen."""
        factor = max(0.0, self.limit / self.way[-1][1] - 1.0)
        return [
            PieceMotion(*(plus(b, plus(b, a, -1.0), factor) for a, b in zip(*each, strict=True)))
            for each in zip(self.start, motions, strict=True)
        ]

    def outcome(self, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """Whether what falls collapses under the load, or drifts off where that does no work."""
        worked = self.assembly.displacement(motions.__getitem__) - self.before
        drifts = abs(worked) <= DRIVEN * self.way[-1][1]
        return EngineOutcome.DRIFT if drifts else EngineOutcome.COLLAPSE


def way(assembly: GivenAssembly, piece: int, since: PieceMotion, now: PieceMotion) -> float:
    """How far (m) a piece has moved: its centroid, and its rotation over its radius of gyration."""
    turn = assembly.pieces[piece].gyration_m * math.dist(now.rotation, since.rotation)
    return math.dist(now.displacement, since.displacement) + turn


def moved(position: Vector, centre: Vector, motion: PieceMotion) -> list[float]:
    """Displacement (m) of a point of a piece with this ``centre``."""
    arm = plus(position, centre, -1.0)
    angle = length(motion.rotation)
    if angle == 0.0:
        return list(motion.displacement)
    axis = [part / angle for part in motion.rotation]
    return plus(motion.displacement, plus(turned(arm, axis, angle), arm, -1.0))
