"""How pieces move: when they fall, and which vertices have left the side that they touched."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from .assembly import GivenAssembly, Vector, dot, length, plus, turned
from .records import EngineOutcome

STILL_FASTEST = 0.9  # of its largest speed since the last equilibrium: less is coming to rest
STEADY = 0.1  # of the way in the first half of the time: less in the second is coming to rest
SWING = 1e-4  # over the motion that is a fall: less may be a swing
DRIVEN = 0.01  # displacement that the load works on over the motion: less is a drift
BEYOND_EDGE = 0.05  # over the mean size of pieces: a vertex further outside a side has left it
LOOK = 0.01  # over that size: after so much motion, vertices may have left


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
        self.stride, self.far = LOOK * assembly.length_m, 0
        self.start = [
            (index, math.sqrt(piece.inertia_kgm2 / piece.mass_kg), start[index])
            for index, piece in enumerate(assembly.pieces)
            if not piece.fixed
        ]

    def sees(self, motions: Sequence[PieceMotion], steps: int) -> bool:
        """Whether a piece falls, ``steps`` of time after the last look; exits if it is nowhere."""
        ways = [
            math.dist(motions[index].displacement, start.displacement)
            + arm * math.dist(motions[index].rotation, start.rotation)
            for index, arm, start in self.start
        ]
        if not math.isfinite(sum(ways)):
            raise SystemExit(f"the computation has diverged: displacements {ways} m")
        (time, before), moved = self.way[-1], max(ways)
        self.way.append((time + steps, moved))
        self.fastest = max(self.fastest, (moved - before) / steps)
        return moved > self.limit and moved - before >= STILL_FASTEST * self.fastest * steps

    def at_last(self, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """Outcome where nobody waits longer: just above the peak, pieces may fall very slowly."""
        end, moved = self.way[-1]
        middle = next(far for time, far in self.way if 2 * time >= end)
        goes_on = moved - middle > max(STEADY * middle, SWING * self.limit)
        return self.outcome(motions) if goes_on else EngineOutcome.UNSETTLED

    def outcome(self, motions: Sequence[PieceMotion]) -> EngineOutcome:
        """Whether what falls collapses under the load, or drifts off where that does no work."""
        worked = self.assembly.displacement(motions.__getitem__) - self.before
        drifts = abs(worked) <= DRIVEN * self.way[-1][1]
        return EngineOutcome.DRIFT if drifts else EngineOutcome.COLLAPSE

    def went_on(self) -> bool:
        """Whether a piece has moved on so far that a vertex may have left its side since."""
        before, self.far = self.far, int(self.way[-1][1] / self.stride)
        return self.far > before


def nodes_off_sides(assembly: GivenAssembly, motions: Sequence[PieceMotion]) -> list[int]:
    """Numbers of the nodes whose vertex is off the other piece's side; ``motions``: of pieces."""
    off = []
    for number, node in enumerate(assembly.nodes):
        face = assembly.faces[node.face]
        flat, vertex, edges = face.above, face.below, face.edges_above
        if node.vertex_above:
            flat, vertex, edges = face.below, face.above, face.edges_below
        to, back = (
            moved(node.position_m, assembly.pieces[piece].centre_m, motions[piece])
            for piece in (vertex, flat)
        )
        place = plus(node.position_m, plus(to, back, -1.0))
        if any(dot(place, edge[:3]) - edge[3] > BEYOND_EDGE * assembly.length_m for edge in edges):
            off.append(number)
    return off


def moved(position: Vector, centre: Vector, motion: PieceMotion) -> list[float]:
    """Displacement (m) of a point of a piece with this ``centre``."""
    arm = plus(position, centre, -1.0)
    angle = length(motion.rotation)
    if angle == 0.0:
        return list(motion.displacement)
    axis = [part / angle for part in motion.rotation]
    return plus(motion.displacement, plus(turned(arm, axis, angle), arm, -1.0))
