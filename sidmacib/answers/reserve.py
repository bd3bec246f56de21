"""What a structure has in reserve under permanent loads alone, by both models.

The static model, which follows elastic joints and blocks that move, has the last word: whether the
structure stands, and the least horizontal acceleration that it carries. The direction of that is
sought on the cells of the file, first where limit analysis finds least, then beside the weakest.
There, the answer is that of the same acceleration as a load.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

from sidmacib.answers.structure import static_answer
from sidmacib.answers.structure_paths import LOWER, StaticAnswer
from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError, UnboundedError
from sidmacib.mechanics.assembly import Vector
from sidmacib.mechanics.equilibrium import is_dry
from sidmacib.mechanics.limit import require_standing
from sidmacib.mechanics.static import first_failure_of, solver_of
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.reserve import (
    NEARER,
    Push,
    geometrical_factor,
    least_push,
    pushes,
    strength_factor,
)
from sidmacib.structure.loads import StructureLoads, free_weight, naming_permanent, pushed
from sidmacib.structure.structure import refined, with_dry_joints

# Over the least acceleration in the static model: directions with more in limit analysis are left.
FURTHER = 1.25
QUARTERS = [k * math.pi / 2.0 for k in range(4)]  # along x and y
BESIDE, HALVINGS = math.pi / 8.0, 2  # how far beside the weakest others are, and again half of it


@dataclass(frozen=True, eq=False)
class Followed:
    """What the static model answers to a horizontal acceleration, and the ``direction`` of that.

    ``weight``: of all that is free, N.
    """

    answer: StaticAnswer
    direction: Vector
    weight: float

    @property
    def acceleration(self) -> float:
        """What is carried, in g."""
        return self.answer.load / self.weight

    @property
    def bonds(self) -> bool:
        """Whether that is the first failure of a bond, after which it may carry more."""
        return not self.answer.counts.peak


@dataclass(frozen=True, eq=False)
class Reserve:
    """What limit analysis and the static model answer without a load that is raised.

    ``factor``: the geometrical safety factor; None where it has no limit, or bonds or locks are
    there. ``least``: the least horizontal acceleration by limit analysis; None if there is none;
    ``tried``: others. ``followed``: the least by the static model; None without an answer.
    ``static``: what the static model says against it, or nothing; ``falls``: whether that is that
    it does not stand, or that a bond fails. ``strength``: compressive strength over the strength
    needed; None where there is none, or no limit. ``dry``: whether all joints are. ``bonds``: how
    far bonds reach, where the same blocks with dry joints carry more: all else is then of these;
    else nothing.
    """

    factor: float | None
    least: Push | None
    tried: tuple[Push, ...]
    followed: Followed | None
    static: str
    falls: bool
    strength: float | None
    dry: bool
    bonds: str = ""

    @property
    def decides(self) -> Followed | Push | None:
        """The least acceleration of both models; None where none fells the structure.

        With bonds the static model's counts, wherever it has one.
        """
        push, followed = self.least, self.followed
        least = (1.0 - LOWER) * push.acceleration if push and self.dry else math.inf
        return followed if followed and followed.acceleration < least else push


def reserve(problem: Problem, tell: Callable[[str], object]) -> Reserve:
    """The reserve of a structure; `CapacityError` if it does not stand in limit analysis.

    That with dry joints, where these carry more and count. ``tell`` is told what is found.
    """
    found = _reserve(problem, tell)
    bonded = found.followed
    if found.dry or not (found.falls or (bonded and bonded.answer.counts.dry)):
        return found
    try:
        tell("with dry joints ...")
        dry = _reserve(with_dry_joints(problem), tell)
    except CapacityError:
        return found
    if dry.falls:
        return found
    fails = found.static
    if bonded is not None:
        fails = f"the first fails at {bonded.answer.failures.first / bonded.weight:.3g} g"
    return replace(dry, bonds=f"with bonds, {fails}")


def _reserve(problem: Problem, tell: Callable[[str], object]) -> Reserve:
    """The reserve with the bonds that there are; the rest as `reserve`."""
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    with naming_permanent(loads):
        require_standing(assembly, loads, friction=True)
        tell("stands in limit analysis; horizontal accelerations ...")
        tried = pushes(assembly, loads, tell)
        tell("geometrical safety factor ...")
        factor, least = geometrical_factor(assembly, loads), least_push(assembly, loads, tried)
        strength = strength_factor(assembly, loads)
    static, falls, found = "", False, None
    try:
        with naming_permanent(loads):
            found = _followed(problem, least, tried, tell)
    except CapacityError as error:
        static, falls = str(error), isinstance(error, NoEquilibriumError)
    dry = is_dry(assembly)
    return Reserve(factor, least, tried, found, static, falls, strength, dry)


def _followed(
    problem: Problem, least: Push | None, tried: Sequence[Push], tell: Callable[[str], object]
) -> Followed | None:
    """The least acceleration that the static model carries; None where none fells it.

    `NoEquilibriumError` where it does not stand, or a bond fails without a load, and no peak
    without that bond counts.
    """
    weak = _bond_that_fails(problem)
    by_way = {push.direction: push for push in (*filter(None, (least,)), *tried)}
    weakest = _weakest(problem, [*by_way.values()], tell)
    if weakest is None:
        return None
    ways = [weakest]
    if least is not None and not is_dry(problem.assembly):
        ways.insert(0, least.direction)  # where a bond fails first more may be carried than here
    found: Followed | None = None
    for way in dict.fromkeys(ways):
        tell(f"static model towards ({way[0]:.3g}, {way[1]:.3g}), on several meshes ...")
        try:
            answer = static_answer(under(problem, way))
        except CapacityError:
            if weak:
                raise weak from None
            raise
        if weak and (answer.counts.dry or not answer.counts.peak):
            raise weak
        here = Followed(answer, way, free_weight(problem.assembly))
        if found is None or here.acceleration < (1.0 - NEARER) * found.acceleration:
            found = here
    return found


def under(problem: Problem, way: Vector) -> Problem:
    """The ``problem`` with an acceleration along a horizontal ``way``, beside permanent loads."""
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    return Problem(assembly, pushed(assembly, loads, way))


def _weakest(
    problem: Problem, found: Sequence[Push], tell: Callable[[str], object]
) -> Vector | None:
    """The direction in which the static model carries least, on the cells of the file.

    Of those that limit analysis ``found`` with up to `FURTHER` times as much, or along x and y
    where it found none, and then beside the weakest.
    """
    assembly = refined(problem.assembly, 1)
    least, weakest = math.inf, math.nan

    @cache  # a step goes back to where the last one came from
    def ask(angle: float) -> None:
        nonlocal least, weakest
        way = _way(angle)
        try:
            point = first_failure_of(solver_of(assembly, under(problem, way).loads)).point
        except UnboundedError:
            return
        acceleration = point.load / free_weight(assembly)
        tell(f"static model: {acceleration:.4g} g towards ({way[0]:.3g}, {way[1]:.3g})")
        if acceleration < (1.0 - NEARER) * least:
            least, weakest = acceleration, angle

    for push in sorted(found, key=lambda each: each.acceleration):
        if push.acceleration > FURTHER * least:
            break
        ask(math.atan2(push.direction[1], push.direction[0]))
    for angle in [] if found else QUARTERS:
        ask(angle)
    if math.isinf(least):
        return None
    for halving in range(HALVINGS):
        middle = math.nan
        while middle != weakest:
            beside, middle = BESIDE / 2**halving, weakest
            ask(middle + beside)
            ask(middle - beside)
    return _way(weakest)


def _way(angle: float) -> Vector:
    """The horizontal direction at an ``angle`` (rad) from x."""
    return round(math.cos(angle), 9) + 0.0, round(math.sin(angle), 9) + 0.0, 0.0


def _bond_that_fails(problem: Problem) -> NoEquilibriumError | None:
    """That a bond fails without a load; None if none does. Without it more may be carried.

    Raises `NoEquilibriumError` unless the structure stands in the static model.
    """
    assembly = refined(problem.assembly, 1)
    try:
        state = solver_of(assembly, problem.loads).start()
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    for face in interface_forces(assembly, state.force):
        if face.bonded_share and (face.utilisation or 0.0) > 1.0:
            return NoEquilibriumError(f"the bond of {face.interface} fails under its own weight")
    return None
