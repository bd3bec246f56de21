"""What the static model answers for a joint: its lowest peak, on the finer of two meshes."""

from dataclasses import dataclass
from functools import lru_cache

from sidmacib.joint import Joint
from sidmacib.joint.loading import Loading, posed
from sidmacib.joint.pieces import APART, FAR
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.solution import MOVED, Equilibrium, Mode, StaticSolution
from sidmacib.mechanics.static import static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.mesh_error import cells_of, kind_of, mesh_errors

# Coarse and fine mesh over the shorter side of a lock; both give the mesh error on the fine one.
# Elastic pieces take much longer.
RIGID, ELASTIC = (0.4995, 0.24975), (0.999, 0.4995)
KEPT = 64  # answers: what a page asks about one joint


@dataclass(frozen=True)
class JointAnswer:
    """What the static model answers for a ``joint`` along a direction, on the fine mesh.

    ``solution``: its path to the lowest peak that is found, on the pieces of ``assembly``.
    """

    joint: Joint
    assembly: Assembly
    solution: StaticSolution

    @property
    def load(self) -> float:
        """The peak along the direction, in N."""
        return float(self.solution.peak.load)

    @property
    def first_failure(self) -> float | None:
        """The first failure over the peak; None where nothing is carried."""
        first = float(self.solution.first_failure_load)
        return first / self.load if self.load else None

    @property
    def why(self) -> str:
        """Which load that is."""
        if not self.load:
            return "nothing is carried"
        which = "lowest peak found" if self.solution.spread else "peak"
        if self.solution.mode is Mode.APART:
            return f"{which}; beyond it locks come apart by over {100 * APART:g} % of their height"
        at = self._at_first_failure
        fails = self.solution.mode not in MOVED or at.load < self.load
        if fails and at.moved > FAR * self.joint.b:
            return (
                f"{which}; blocks move by over {100 * FAR:g} % of a lock's width before a bond "
                "fails: too loose or too soft to rely on"
            )
        return f"{which}; beyond it pieces turn by over 2 degrees" if self.solution.turns else which

    @property
    def _at_first_failure(self) -> Equilibrium:
        first = self.solution.first_failure_load
        return next(point for point in self.solution.path if point.load >= first)


def meshes(joint: Joint) -> tuple[float, float]:
    """The coarse and the fine mesh (m) that ``joint`` is solved on."""
    coarse, fine = RIGID if joint.elastic is None else ELASTIC
    return coarse * joint.least_side, fine * joint.least_side


def quick_path(joint: Joint, loading: Loading) -> tuple[Assembly, StaticSolution]:
    """Pieces and one path on the fine mesh: there may be a lower peak.

    Errors of `sidmacib.joint.loading.posed` and `sidmacib.static_peak`.
    """
    problem = posed(joint, loading, meshes(joint)[1])
    return problem.assembly, static_peak(*problem)


@lru_cache(maxsize=KEPT)
def joint_answer(joint: Joint, loading: Loading) -> JointAnswer:
    """The answer of the static model for ``joint`` under ``loading``.

    `sidmacib.errors.CapacityError` if it has none.
    """
    problem = posed(joint, loading, meshes(joint)[1])
    return JointAnswer(joint, problem.assembly, lowest_peak(*problem))


def joint_mesh_error(joint: Joint, loading: Loading) -> float | None:
    """The mesh error of the load of `joint_answer`, over it; None where nothing is carried.

    From the coarse mesh, too. Where a joint moves before a bond fails, two meshes may agree by
    chance: there, for rigid pieces, from one of half the size as well. Errors of `joint_answer`.
    """
    (coarse, fine), found = meshes(joint), joint_answer(joint, loading).solution
    moves = found.mode is not Mode.BONDS
    others = (coarse, fine / 2) if moves and not joint.elastic else (coarse,)
    every = {fine: found, **{each: lowest_peak(*posed(joint, loading, each)) for each in others}}
    loads = {cells_of(joint, mesh): float(each.peak.load) for mesh, each in every.items()}
    if not min(loads.values()) > 0.0:
        return None
    both = [(each.peak.load, each.first_failure_load) for each in every.values()]
    kind = kind_of(both, moves=moves)
    return mesh_errors(loads, NodeLayout.LOBATTO, kind)[cells_of(joint, fine)]
