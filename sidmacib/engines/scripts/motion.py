"""How pieces move, and when they fall."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from .assembly import GivenAssembly, Vector, length, plus, turned
from .records import EngineOutcome

STILL_FASTEST = 0.9  # of its largest speed since the last equilibrium: less is coming to rest
STEADY = 0.1  # of the way in the first half of the time: less in the second is coming to rest
SLOWER = 0.95  # times the way in the time before: more goes on
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

    def goes_on(self) -> bool:
        """Whether a piece has hardly slowed down from the second third of the time to the last."""
        end, moved = self.way[-1]
        second, last = self._at(end / 3), self._at(2 * end / 3)
        return moved - last > max(SLOWER * (last - second), SWING * self.limit)

    def _at(self, when: float) -> float:
        """How far (m) a piece had moved by then."""
        return next(far for time, far in self.way if time >= when)

    def at_last(self, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """Outcome where nobody waits longer: just above the peak, pieces may fall very slowly."""
        end, moved = self.way[-1]
        middle = self._at(end / 2)
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
    return plus(motion.displacement, plus(spun(arm, motion.rotation), arm, -1.0))


def built(position: Vector, centre: Vector, motion: PieceMotion) -> list[float]:
    """Where the point of a piece was at the start that is at ``position`` (m) now."""
    back = [-part for part in motion.rotation]
    return plus(centre, spun(plus(plus(position, centre, -1.0), motion.displacement, -1.0), back))


def spun(vector: Vector, rotation: Vector) -> list[float]:
    """A ``vector`` turned by a rotation vector (rad)."""
    angle = length(rotation)
    return turned(vector, [part / angle for part in rotation], angle) if angle else list(vector)
