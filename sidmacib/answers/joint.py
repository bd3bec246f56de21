"""What the static model answers for a joint, and which of its loads counts.

It is solved on two meshes, the finer of which gives the load. The peak counts; where it spreads too
far, see `sidmacib.mechanics.static.peak_spread`, the first failure does.
"""

from dataclasses import dataclass
from functools import lru_cache

from sidmacib.joint.joint import Joint
from sidmacib.joint.load_path import load_path
from sidmacib.joint.loading import Loading, posed
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static.peak_spread import StaticCapacity, static_capacity
from sidmacib.mesh_error import LoadKind, cells_of, kind_of, mesh_errors
from sidmacib.problem import Problem

# Coarse and fine mesh over the shorter side of a lock; both give the mesh error on the fine one.
# Elastic pieces take much longer.
RIGID, ELASTIC = (0.4995, 0.24975), (0.999, 0.4995)
KEPT = 64  # answers: what a page asks about one joint


@dataclass(frozen=True)
class JointAnswer:
    """What the static model answers for a joint along a direction, on the fine mesh.

    ``capacity``: its path on the pieces of ``assembly``, and which of its loads counts.
    """

    assembly: Assembly
    capacity: StaticCapacity

    @property
    def load(self) -> float:
        """The load that counts along the direction, in N."""
        return float(self.capacity.load)

    @property
    def first_failure(self) -> float | None:
        """The first failure over that load; None where nothing is carried."""
        first = float(self.capacity.solution.first_failure_load)
        return first / self.load if self.load else None

    @property
    def state(self) -> Equilibrium:
        """The equilibrium at that load."""
        return self.capacity.path[-1]

    @property
    def why(self) -> str:
        """Which load counts, and why."""
        if not self.load:
            return "nothing is carried"
        if self.capacity.is_peak:
            return "peak"
        spread = 100.0 * self.capacity.spread
        return f"first failure; peaks behind it spread by {spread:.0f} % or more"


def meshes(joint: Joint) -> tuple[float, float]:
    """The coarse and the fine mesh (m) that ``joint`` is solved on."""
    coarse, fine = RIGID if joint.elastic is None else ELASTIC
    return coarse * joint.least_side, fine * joint.least_side


def on_given_cells(problem: Problem) -> StaticCapacity:
    """The path of the static model for a joint's ``problem`` on its cells, and what counts there.

    `sidmacib.errors.CapacityError` if there is none.
    """
    return static_capacity(*problem)


def quick_path(joint: Joint, loading: Loading) -> tuple[Assembly, StaticSolution]:
    """Pieces and path on the fine mesh, without the spread of the peak, which may not count.

    Errors of `sidmacib.joint.load_path.load_path`.
    """
    return load_path(joint, loading, meshes(joint)[1])


@lru_cache(maxsize=KEPT)
def joint_answer(joint: Joint, loading: Loading) -> JointAnswer:
    """The answer of the static model for ``joint`` under ``loading``.

    `sidmacib.errors.CapacityError` if it has none.
    """
    problem = posed(joint, loading, meshes(joint)[1])
    return JointAnswer(problem.assembly, on_given_cells(problem))


def joint_mesh_error(joint: Joint, loading: Loading) -> float | None:
    """The mesh error of the load of `joint_answer`, over it; None where nothing is carried.

    From the coarse mesh, too. Errors of `joint_answer`.
    """
    coarse = load_path(joint, loading, meshes(joint)[0])[1]
    fine = joint_answer(joint, loading).capacity
    if not (fine.load > 0.0 and coarse.peak.load > 0.0):
        return None
    both = coarse, fine.solution
    cells = [cells_of(joint, mesh) for mesh in meshes(joint)]
    kind, loads = LoadKind.FIRST_FAILURE, [one.first_failure_load for one in both]
    if fine.is_peak:
        kind = kind_of((one.peak.load, one.first_failure_load) for one in both)
        loads = [one.peak.load for one in both]
    errors = mesh_errors(dict(zip(cells, loads, strict=True)), NodeLayout.LOBATTO, kind)
    return float(errors[cells[1]])
