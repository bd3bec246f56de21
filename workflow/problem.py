"""What a model is asked: pieces under loads."""

from typing import NamedTuple

from sidmacib.loading import lateral_load
from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.pieces import assemble
from workflow.case import Case


class Problem(NamedTuple):
    """Pieces with their faces and nodes, and the loads on them."""

    assembly: Assembly
    loads: Loads


def problem_of(case: Case) -> Problem:
    """The problem that ``case`` poses to its model.

    ValueError for a mesh that is too coarse, `CapacityError` if the joint can carry nothing.
    """
    assembly = assemble(case.joint, case.mesh, case.nodes)
    return Problem(assembly, lateral_load(case.joint, assembly, case.loading))
