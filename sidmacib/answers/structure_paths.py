"""Paths of the static model for a structure on several meshes, and which of its loads counts.

It is solved on the cells of the file and on cells of half the size, with pressure on dry interfaces
integrated over their pressed parts: an edge gives way as it is pressed, whatever the cells. Where
no bond fails before the peak, the peak counts, and cells are halved until its mesh error is small:
a face on few cells resists twisting by more friction than it has.

Where a bond does fail before the peak, how far that moves from one mesh to another says little of
how far it still will: it counts only if three meshes agree on it, the third with cells of a quarter
of the size, on which the lowest peak is sought. Otherwise the first failure counts, which hardly
depends on the mesh, or what dry joints carry, if that is more.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, Floats
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.solution import LEAST_INCREMENT, Equilibrium
from sidmacib.mechanics.static import MOST_ROTATION, static_peak
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.mesh_error import SETTLED, structure_mesh_errors
from sidmacib.problem import Counts, Failures, MeshErrors, Problem
from sidmacib.structure.analysis.tilt import static_tilt
from sidmacib.structure.structure import refined

HALF, QUARTER = 2, 4  # cells, along a side, that one of the file is divided into
MOST_NODES = 6000  # on smaller cells than half: more take too much time and memory
SMALL = 0.02  # mesh error of a peak before which no bond fails, over the peak: cells are not halved
LOWER = 1e-3  # of a load: by less, the static model and limit analysis agree
CRUSHING = "crushing"  # the mode where it limits the load
NO_BOND, AGREE = "no bond fails before the peak", "three meshes agree on the peak"


@dataclass(frozen=True)
class FollowedPath:
    """A path of equilibria to the peak on the cells of ``assembly``; N, or degrees of a tilt.

    ``mode``: how it ends; ``mechanism``: how the blocks then move where gravity turns, see
    `StaticTilt`. ``spread``: of the peaks; None where the lowest was not sought.
    """

    assembly: Assembly
    failures: Failures
    path: tuple[Equilibrium, ...]
    mode: str
    mechanism: Floats | None = None
    spread: float | None = None


@dataclass(frozen=True, kw_only=True)
class StaticAnswer(FollowedPath):
    """What the static model answers for a structure: the path on the smallest cells."""

    mesh_errors: MeshErrors
    counts: Counts

    @property
    def load(self) -> float:
        """The load or the angle that counts."""
        return counting(self.failures, self.counts)

    @property
    def mesh_error(self) -> float | None:
        """The mesh error of that load, over it; None where it is not known."""
        return self.mesh_errors.peak if self.counts.peak else self.mesh_errors.first

    @property
    def state(self) -> Equilibrium:
        """The equilibrium at that load."""
        return next(point for point in self.path if point.load >= self.load)


def counting(failures: Failures, counts: Counts) -> float:
    """Which of the ``failures`` counts."""
    return failures.peak if counts.peak else failures.first


def without_other_meshes(failures: Failures) -> Counts:
    """What counts of ``failures`` that no other mesh confirms."""
    if bond_fails(failures):
        return Counts(peak=False, why="nothing shows how far the peak depends on the mesh")
    return Counts(peak=True, why=NO_BOND)


def bond_fails(failures: Failures) -> bool:
    """Whether a bond fails before the peak."""
    return failures.peak > failures.first * (1.0 + 2.0 * LEAST_INCREMENT)


def unbounded_answer(problem: Problem, most: float = math.inf) -> StaticAnswer:
    """The answer without limit analysis; errors of `sidmacib.answers.structure.static_answer`.

    ``most``: a load (N or degrees) that the peak on small cells should not exceed by far.
    """
    found = {each: followed(refined(problem.assembly, each), problem.loads) for each in (1, HALF)}
    if not found[HALF].failures.peak > 0.0:
        raise NoEquilibriumError(DOES_NOT_STAND)
    _refine(problem, found, most)
    fails = bond_fails(found[max(found)].failures)
    doubt = _doubt(problem, found) if fails else ""
    finest = found[max(found)]
    return StaticAnswer(
        **vars(finest),
        mesh_errors=_mesh_errors(found),
        counts=Counts(peak=not doubt, why=doubt or (AGREE if fails else NO_BOND)),
    )


def _refine(problem: Problem, found: dict[int, FollowedPath], most: float) -> None:
    """Add paths on smaller cells to those ``found`` as long as the peak depends on the cells.

    It does if it is above ``most``.
    """
    while not bond_fails((last := found[max(found)]).failures):
        error, divided = _mesh_errors(found).peak, 2 * max(found)
        if error is None or (error <= SMALL and last.failures.peak <= (1.0 + SMALL) * most):
            return
        smaller = refined(problem.assembly, divided)
        if len(smaller.nodes.area) > MOST_NODES:
            return
        found[divided] = followed(smaller, problem.loads)


def _doubt(problem: Problem, found: dict[int, FollowedPath]) -> str:
    """Why the peak does not count though a bond fails before it, or nothing.

    A path on a third mesh is added to those that are ``found`` if it may decide.
    """
    if unsettled := _unsettled(found):
        return unsettled
    third = refined(problem.assembly, QUARTER)
    if len(third.nodes.area) > MOST_NODES:
        return "a third mesh, which shows whether the peak depends on it, is too large"
    try:
        found[QUARTER] = followed(third, problem.loads, lowest=True)
    except CapacityError as error:
        return f"there is no peak on a third mesh: {error}"
    return _unsettled(found)


def _unsettled(found: Mapping[int, FollowedPath]) -> str:
    """That the peak has not converged, or nothing."""
    error = _mesh_errors(found).peak
    if error is None:
        return "the peak is 0 on one of the meshes"
    if error > SETTLED:
        return f"peak not converged (its mesh error: {100.0 * error:.0f} %)"
    if QUARTER not in found:
        return ""
    # No equilibrium counts in which rotations are large, and where a block leans on a corner they
    # grow from mesh to mesh by a factor: on the next, the path may end below the peak.
    half, path = found[HALF].path[-1].rotation, found[QUARTER].path
    growth = max(path[-1].rotation / half, 1.0) if half else 1.0
    counted = (point.load for point in path if point.rotation * growth <= MOST_ROTATION)
    ends_below = max(counted, default=0.0) < (1.0 - error) * path[-1].load
    return "blocks turn further on each smaller mesh" if ends_below else ""


def followed(assembly: Assembly, loads: Loads, *, lowest: bool = False) -> FollowedPath:
    """The path under ``loads``; ``lowest``: to the lowest peak, where loads are raised."""
    try:
        if loads.raised.axis:
            tilt = static_tilt(assembly, loads)
            failures = Failures(float(tilt.first_failure), float(tilt.angle))
            return FollowedPath(assembly, failures, tilt.path, str(tilt.motion), tilt.mechanism)
        found = (lowest_peak if lowest else static_peak)(assembly, loads)
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    failures = Failures(float(found.first_failure_load), float(found.peak.load))
    spread = found.spread if lowest else None
    return FollowedPath(assembly, failures, found.path, str(found.mode), spread=spread)


def _mesh_errors(found: Mapping[int, FollowedPath]) -> MeshErrors:
    failures = {divided: each.failures for divided, each in found.items()}
    return structure_mesh_errors(found[1].assembly, failures)
