"""Whether a structure stands under permanent loads alone, and what it has in reserve."""

from collections.abc import Callable
from dataclasses import dataclass

from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.limit import require_standing
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.reserve import (
    Push,
    geometrical_factor,
    least_push,
    pushes,
    strength_factor,
)
from sidmacib.structure.loads import StructureLoads, naming_permanent


@dataclass(frozen=True, eq=False)
class Reserve:
    """What limit analysis and the static model answer without a load that is raised.

    ``factor``: the geometrical safety factor; None where it has no limit, or bonds or locks are
    there. ``least``: the least horizontal acceleration; None if there is none; ``tried``: others.
    ``static``: what the static model says against it, or nothing; ``falls``: whether that is that
    it does not stand, or that a bond fails. ``strength``: compressive strength over the strength
    needed; None where there is none, or no limit.
    """

    factor: float | None
    least: Push | None
    tried: tuple[Push, ...]
    static: str
    falls: bool
    strength: float | None


def reserve(problem: Problem, tell: Callable[[str], object]) -> Reserve:
    """The reserve of a structure; `CapacityError` if it does not stand in limit analysis.

    ``tell`` is told what is found.
    """
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    with naming_permanent(loads):
        require_standing(assembly, loads, friction=True)
        tell("stands in limit analysis; horizontal accelerations ...")
        tried = pushes(assembly, loads, tell)
        tell("geometrical safety factor ...")
        factor, least = geometrical_factor(assembly, loads), least_push(assembly, loads, tried)
        strength = strength_factor(assembly, loads)
    static, falls = "", False
    try:
        with naming_permanent(loads):
            _require_static(problem)
    except CapacityError as error:
        static, falls = str(error), isinstance(error, NoEquilibriumError)
    return Reserve(factor, least, tried, static, falls, strength)


def _require_static(problem: Problem) -> None:
    """`CapacityError` unless the structure stands in the static model, and no bond fails."""
    assembly = problem.assembly
    if reason := assembly.without_stiffness:
        raise CapacityError(reason)
    try:
        state = RigidSolver(*problem).start()
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    for face in interface_forces(assembly, state.force):
        if face.bonded and face.utilisation > 1.0:
            raise NoEquilibriumError(f"the bond of {face.name} fails under its own weight")
