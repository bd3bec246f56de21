"""Whether a structure stands under permanent loads alone, and what it has in reserve."""

from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import DOES_NOT_STAND, CapacityError, NoEquilibriumError
from sidmacib.mechanics.crushing import crushing_use
from sidmacib.mechanics.rigid.solver import RigidSolver
from sidmacib.problem import Problem
from sidmacib.structure.analysis.forces import interface_forces
from sidmacib.structure.analysis.reserve import Push, geometrical_factor, least_push, pushes
from sidmacib.structure.loads import StructureLoads, naming_permanent


@dataclass(frozen=True, eq=False)
class Reserve:
    """What limit analysis and the static model answer without a load that is raised.

    ``factor``: the geometrical safety factor; None where it has no limit, or bonds or locks are
    there. ``least``: the least horizontal acceleration; None if there is none; ``tried``: others.
    ``static``: what the static model says against it, or nothing; ``falls``: whether that is that
    it does not stand, or that a bond fails. ``crushing``: the name of the interface that uses most
    of its compressive strength in that model, and the part.
    """

    factor: float | None
    least: Push | None
    tried: tuple[Push, ...]
    static: str = ""
    falls: bool = False
    crushing: tuple[str, float] | None = None


def reserve(problem: Problem) -> Reserve:
    """The reserve of a structure; `CapacityError` if it does not stand in limit analysis."""
    assembly, loads = problem
    assert isinstance(loads, StructureLoads), "loads of a structure"
    with naming_permanent(loads):
        factor = geometrical_factor(assembly, loads)
        tried = pushes(assembly, loads)
        found = Reserve(factor, least_push(assembly, loads, tried), tried)
    try:
        with naming_permanent(loads):
            return replace(found, crushing=_crushing(problem))
    except CapacityError as error:
        falls = isinstance(error, NoEquilibriumError)
        return replace(found, static=str(error), falls=falls)


def _crushing(problem: Problem) -> tuple[str, float] | None:
    """The interface that is crushed most in the static model; CapacityError if it falls."""
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
    use = crushing_use(assembly, np.array(state.force[None, :, 0]))
    if not use:
        return None
    most = max(use, key=lambda number: float(use[number][0]))
    name, part = assembly.faces[most].name, float(use[most][0])
    if part > 1.0:
        raise NoEquilibriumError(f"{name} is crushed under its own weight")
    return name, part
