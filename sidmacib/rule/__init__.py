"""The first-failure law of a joint, and the safe rule for design.

The static model finds the load at which a bonded face reaches its strength, with the history of
friction, on the coarsest nodes that represent all stresses of a rigid lock: Lobatto points, which
integrate linear stresses exactly. Up to this load it makes no difference how bonds fail.

``law`` is the best estimate of the first failure, on which all models agree. ``safe`` is that of a
joint whose strengths are divided by `SAFETY`, less the change on a finer mesh, and at most that of
``law`` divided by `path_of`. Both refuse joints outside `sidmacib.rule.spans.SPANS`, the tested
ranges of the groups that the answer depends on. `make attack` searches inside them for the joint
with the highest safe load relative to its first failure.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Hold, Joint
from sidmacib.joint.loading import Loading, Push, lateral_load
from sidmacib.joint.pieces import FAR, assemble, roots
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.contact_law.kernels import utilisation
from sidmacib.mechanics.equilibrium import face_frames, self_weight
from sidmacib.mechanics.loads import Loads
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import MOVED, Mode, Solver
from sidmacib.mechanics.static import first_failure_of, solver_of
from sidmacib.quantities import four_digits
from sidmacib.rule.pairs import bearing_pairs
from sidmacib.rule.spans import STIFF, require_covered, require_row, spans_of

# Cells along the shorter side of a lock. Two, so that dry faces may open in part; more show how far
# a load depends on them. Elastic blocks cost more, and three nodes a side represent their bending.
COARSE, FINE = 2, 4
FINEST = 6  # where four cells may not be enough: dry faces that are stiff, or joints that slide
MESHES = COARSE, FINE, FINEST
ELASTIC, FINE_ELASTIC = 1, 2
SAFETY, SAFETY_ELASTIC = 1.06, 1.12  # on strengths, and on a load at which a joint slides or rocks
SHUT = 0.7  # of the opening at which locks come apart, which differs by a quarter between meshes
# On a load that strengths hardly matter to: by 0.3 % it depends on the increments, and of elastic
# blocks by up to 3.4 % on the mesh, of which `law` takes the coarsest.
PATH, PATH_ELASTIC = 1.01, 1.05
NOTHING = 1e-6  # over the strength of a lock: a load that is none
ALONE = 0.1  # of a load: where friction adds the rest, it holds the joint alone
SETTLED = 0.01  # of a load: less from one mesh to the next is no sign that it goes on to change
CLEAR = 1.5  # on strengths: by as much, the load at which a joint moves is less on finer meshes
JUST_BEFORE = 1.001  # on strengths whose bonds fail as a joint moves: they fail before
STIFFER = 10.0  # than this: the safe rule looks at a third mesh

MOVES = {
    Mode.MECHANISM: "slides before a bond fails",
    Mode.ROCKING: "rocks before a bond fails",
    Mode.APART: "locks come apart before a bond fails",
}


@dataclass(frozen=True)
class JointFailure:
    """The state of a joint at its first failure, lock by lock.

    ``load``: along the direction of loading, N. ``mode``: whether a bond fails there, or the joint
    slides or rocks before one does. ``force_x``, ``force_y`` in N and ``torque`` in
    N m, across each root on the piece above it, shape (n,). ``utilisation``: largest stress over
    strength at each root, shape (n,), all below 1 where a cut between columns fails first;
    ``cuts``: at each of these, (c,), none of a block in one piece.
    """

    load: float
    mode: Mode
    force_x: Floats
    force_y: Floats
    torque: Floats
    utilisation: Floats
    cuts: Floats

    @property
    def bonds(self) -> Floats:
        """``utilisation`` of roots, then of cuts, (n + c,)."""
        return np.concatenate([self.utilisation, self.cuts])


@lru_cache(maxsize=256)  # law, safe rule and explorer need the same results
def first_failure(
    joint: Joint, loading: Loading, cells: int | None = None, opening: float = 1.0
) -> JointFailure:
    """The state in which the first face of ``joint`` reaches its strength, or the joint moves away.

    ``cells``: along the shorter side of a lock; None for the least that suffice. ``opening``: of
    faces, at most, over that at which locks come apart. ValueError for joints that the law does not
    cover: fewer than two locks, locks that differ, joined columns, bonds with friction or without
    strength. `CapacityError` if no pair of locks bears, if permanent loads alone make the joint
    fail, if nothing holds it, or if blocks move by more than `FAR` before a bond fails.
    """
    require_row(joint)
    if not bearing_pairs(joint, loading.push):
        raise CapacityError(f"law: no pair of {joint.locks} locks bears in this direction")
    cells = cells or (COARSE if joint.elastic is None else ELASTIC)
    assembly = _cut(joint, cells)
    loads = lateral_load(joint, assembly, loading)
    if joint.elastic is None:
        solver: Solver = _rigid(joint, cells).under(loads)
    else:
        solver = solver_of(assembly, loads)
    solver.most_opening *= opening
    failure = first_failure_of(solver)
    if not failure.point.load > NOTHING * loads.scale:
        why = "fail under their permanent loads alone"
        if failure.mode is not Mode.BONDS:
            why = "carry nothing in this direction: the upper block moves freely"
        raise CapacityError(f"law: {joint.locks} locks {why}")
    if failure.mode not in MOVED and failure.point.moved > FAR * joint.b:
        raise CapacityError(
            f"law: blocks move by {failure.point.moved / joint.b:.2g} of a lock's width before a "
            f"bond fails, more than {FAR:g}, so that they bear on less than is computed; hold the "
            "joint down, or give stiffer faces, or ask yade"
        )
    point, nodes, order = failure.point, assembly.nodes, roots(joint, assembly)
    start = np.searchsorted(nodes.face, np.arange(len(assembly.faces)))
    used = np.maximum.reduceat(utilisation(solver.contact_law, point.state, point.force), start)
    force = np.einsum("nk,nkx->nx", point.force, face_frames(assembly))
    middle = np.array([face.middle for face in assembly.faces])
    arm = nodes.position - middle[nodes.face]
    torque = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
    x, y, turned = (np.add.reduceat(each, start)[order] for each in (*force.T[:2], torque))
    inner = [n for n, face in enumerate(assembly.faces) if face.kind is Kind.INNER]
    cuts = used[sorted(set(inner).difference(order))]
    return JointFailure(float(point.load), failure.mode, x, y, turned, used[order], cuts)


def weakened(joint: Joint, margin: float) -> Joint:
    """``joint`` with all its strengths divided by ``margin``."""
    inner = joint.inner
    cohesion, tensile_strength = inner.cohesion / margin, inner.tensile_strength / margin
    weak = replace(inner, cohesion=cohesion, tensile_strength=tensile_strength)
    return replace(joint, inner=weak)


@lru_cache(maxsize=8)  # a curve asks for many directions of one joint
def _cut(joint: Joint, cells: int) -> Assembly:
    """The pieces of ``joint`` with that many ``cells`` along the shorter side of a lock.

    Under a plate half of them, at least, along its height, on which first failures may hang as
    well; without one as many as `assemble` puts there.
    """
    half = max(1, cells // 2) if joint.hold_down.kind is Hold.PLATE else None
    return assemble(joint, joint.least_side / cells, least=half)


@lru_cache(maxsize=8)
def _rigid(joint: Joint, cells: int) -> RigidSolver:
    """A solver of `_cut`, with any loads."""
    assembly = _cut(joint, cells)
    weight = self_weight(assembly.pieces)
    return RigidSolver(assembly, Loads(weight, np.zeros_like(weight), 1.0))


@dataclass(frozen=True)
class LawCapacity:
    """A load along its direction (N), its shear V (N) and its torque M (N m).

    ``mode``: whether bonds fail first, or the joint slides or rocks before they do.
    """

    load: float
    shear: float
    torque: float
    mode: Mode = Mode.BONDS

    @property
    def moves(self) -> str:
        """How the joint moves away before a bond fails; empty where a bond fails first."""
        return MOVES.get(self.mode, "")


def law(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """The load at which ``joint`` first fails, by the static model on coarse nodes.

    ValueError outside `sidmacib.rule.spans.SPANS`; errors of `sidmacib.rule.first_failure`.
    """
    require_covered(joint)
    loading = Loading(direction, push=push)
    found = first_failure(joint, loading)
    if found.mode in MOVED:  # how far it moves before it slides or rocks depends on the mesh
        finer = FINE if joint.elastic is None else FINE_ELASTIC
        found = first_failure(joint, loading, finer)
    return capacity_of(joint, direction, found.load, found.mode)


def safe(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> LawCapacity:
    """A load that ``joint`` carries, for design: that of `weak_failure`.

    Where friction or weight decides, a loss of strength changes little: so it is at most the load
    of `law` divided by `path_of`.

    Errors of `law`. `CapacityError` too if the meshes differ too much.
    """
    found = weak_failure(joint, direction, push)
    most = law(joint, direction, push).load / path_of(joint)
    if found.load <= 0.0:
        raise CapacityError(_unsettled(found.loads))
    return capacity_of(joint, direction, min(found.load, most), found.mode)


@dataclass(frozen=True)
class WeakFailure:
    """The ``loads`` (N) with the margin of the safe rule on each of its meshes, from the coarsest.

    ``mode``: how the joint fails.
    """

    loads: tuple[float, ...]
    mode: Mode

    @property
    def load(self) -> float:
        """The lowest of the loads (N), less what they differ by."""
        return min(self.loads) - (max(self.loads) - min(self.loads))


def weak_failure(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> WeakFailure:
    """The first failure of ``joint`` with the margin of the safe rule.

    That with all strengths divided by `SAFETY` or `SAFETY_ELASTIC`, where bonds fail first, and
    would do so with `CLEAR` times the strength. Else the load is divided by the margin too. Where
    locks come apart first, meshes must agree on it. Where the joint slides or rocks, how much
    friction adds depends on the history of the contacts, and so on the mesh and the increments: the
    load is at most that without friction, over `path_of`, if there is any. Faces open by no more
    than `SHUT` of what the law allows.

    Up to the first failure forces do not depend on strengths, so that what stands with weaker bonds
    stands with these: the load is no less than the safe one with bonds so weak that they decide.

    It is computed on two meshes, and on a third where dry faces are more than `STIFFER` times as
    stiff as roots, where friction alone holds the joint, or where locks come apart first.

    Errors of `law`, and `CapacityError` where friction alone holds it and the loads do not settle,
    or under a plate: how far it turns, and so how hard the plate presses, depends on the mesh.
    """
    require_covered(joint)
    margin, loading = margin_of(joint), Loading(direction, push=push)
    weak, meshes = weakened(joint, margin), _meshes(joint)
    rough, without = _on_meshes(weak, loading, meshes), []
    stronger = _with_stronger_bonds(joint, loading)
    modes = {each.mode for each in (*rough, stronger) if each}
    if modes == {Mode.BONDS}:
        return WeakFailure(tuple(each.load for each in rough), Mode.BONDS)
    smooth = replace(weak, dry=replace(weak.dry, friction=0.0))
    with suppress(CapacityError):
        without = _on_meshes(smooth, loading, meshes)
    alone = _friction_alone(rough, without)
    if alone and joint.hold_down.kind is Hold.PLATE:
        raise CapacityError(
            "safe: without friction the joint would carry next to nothing in this direction, and "
            "with it how far it turns under the plate depends on the mesh; use the static model"
        )
    apart = modes.isdisjoint(MOVED)
    if joint.elastic is None and (alone or apart):
        meshes = MESHES
        rough = _on_meshes(weak, loading, meshes)
        loads = [each.load for each in rough]
        if not _settles(loads):
            apart = False
            if alone:
                raise CapacityError(_unsettled(loads))
    mode = min(rough, key=lambda each: each.load).mode

    def way(failures: Sequence[JointFailure], divisor: float = 1.0) -> WeakFailure:
        return WeakFailure(tuple(each.load / divisor for each in failures), mode)

    ways = [way(rough, margin)]
    if without and not apart:
        ways.append(way(without, path_of(joint)))
    least, used = min(ways, key=lambda way: way.load), stronger and float(stronger.bonds.max())
    if used and used > NOTHING:
        with suppress(CapacityError):
            failing = _on_meshes(weakened(weak, JUST_BEFORE / used), loading, meshes)
            if all(each.mode is Mode.BONDS for each in failing):
                # Only as far as the meshes agree on when the joint moves.
                capped = tuple(min(each.load, way(rough).load) for each in failing)
                return max(least, WeakFailure(capped, mode), key=lambda way: way.load)
    return least


def _on_meshes(joint: Joint, loading: Loading, meshes: Sequence[int]) -> list[JointFailure]:
    return [first_failure(joint, loading, cells, SHUT) for cells in meshes]


def _with_stronger_bonds(joint: Joint, loading: Loading) -> JointFailure | None:
    """The first failure with bonds that must fail before the joint moves, too, if its own decide.

    None where blocks move far before that.
    """
    clear = CLEAR if joint.elastic is None and joint.dry.friction > 0.0 else 1.0
    with suppress(CapacityError):
        return first_failure(weakened(joint, 1.0 / clear), loading)
    return None


def _friction_alone(rough: Sequence[JointFailure], without: Sequence[JointFailure]) -> bool:
    """Whether next to nothing is carried ``without`` friction."""
    held = max((each.load for each in without), default=0.0)
    return held <= ALONE * min(each.load for each in rough)


def _settles(loads: Sequence[float]) -> bool:
    """Whether ``loads`` on ever finer meshes change by ever less."""
    before, last = (abs(one - other) for one, other in pairwise(loads))
    return last <= max(before / 2.0, SETTLED * loads[-1])


def _unsettled(loads: Sequence[float]) -> str:
    return (
        f"safe: the first failure depends too much on the mesh: from {four_digits(min(loads))} to "
        f"{four_digits(max(loads))} N; use the static model"
    )


def _meshes(joint: Joint) -> tuple[int, ...]:
    """Cells along the shorter side of a lock on the meshes of the safe rule, the coarsest first."""
    if joint.elastic is not None:
        return ELASTIC, FINE_ELASTIC
    stiff = spans_of(joint)[STIFF] > STIFFER
    return MESHES if stiff else MESHES[:2]


def safe_at_most(joint: Joint, direction: Direction, push: Push = Push.PLUS_Y) -> float:
    """An upper bound (N) of the safe load, from one mesh. Errors of `law`."""
    require_covered(joint)
    weak = weakened(joint, margin_of(joint))
    return first_failure(weak, Loading(direction, push=push), _meshes(joint)[0], SHUT).load


def margin_of(joint: Joint) -> float:
    """What the safe rule divides the strengths of ``joint`` by."""
    return SAFETY if joint.elastic is None else SAFETY_ELASTIC


def path_of(joint: Joint) -> float:
    """What the safe rule divides a load of ``joint`` by that strengths hardly matter to."""
    return PATH if joint.elastic is None else PATH_ELASTIC


def capacity_of(joint: Joint, direction: Direction, load: float, mode: Mode) -> LawCapacity:
    """A ``load`` (N) along ``direction`` as shear and torque."""
    return LawCapacity(load, load * direction.shear, load * direction.torque * joint.a, mode)


RULES = {"law": law, "safe": safe}  # by the names of their models in studies
