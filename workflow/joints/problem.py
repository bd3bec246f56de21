"""The problem that a case poses to its model."""

from sidmacib.joint.loading import posed
from sidmacib.problem import Problem
from workflow.joints.case import Case


def problem_of(case: Case) -> Problem:
    """The pieces of ``case`` under its loads.

    ValueError for a mesh that is too coarse, `CapacityError` if the joint can carry nothing.
    """
    return posed(case.joint, case.loading, case.mesh, case.nodes)
