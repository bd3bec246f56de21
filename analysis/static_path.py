"""The static model's path of a case once more: records keep its loads, pictures show its nodes."""

from itertools import islice

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.solution import Equilibrium, StaticSolution
from sidmacib.mechanics.static.peaks import after_peak, lowest_peak
from sidmacib.problem import Problem
from workflow.case import JointSubject

MOST_ELASTIC = 1_000  # nodes of elastic blocks: more take minutes
MOST_BEHIND = 1_050  # bonded nodes that are followed behind the peak, where they fail one by one


def path_again(subject: JointSubject) -> tuple[Problem, StaticSolution] | None:
    """The path to the lowest peak; None if there is none, or elastic blocks have too many nodes."""
    try:
        problem = subject.problem()
        if problem.assembly.elastic and len(problem.assembly.nodes.area) > MOST_ELASTIC:
            return None
        return problem, lowest_peak(*problem)
    except CapacityError:
        return None


def behind(
    problem: Problem, peak: Equilibrium, eccentricity: float, most: int
) -> list[Equilibrium] | None:
    """At most so many points behind the ``peak``, see `after_peak`.

    None if nodes would fail one by one and there are too many of them, or blocks are elastic. In
    pure shear, where the ``eccentricity`` is 0, whole locks fail at once.
    """
    bonded = np.count_nonzero(ContactLaw.of(problem.assembly).cohesive)
    if eccentricity != 0.0 and (problem.assembly.elastic or bonded > MOST_BEHIND):
        return None
    return list(islice(after_peak(*problem, peak), most))
