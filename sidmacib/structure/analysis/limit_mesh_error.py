"""Mesh error of limit analysis of a structure.

Apart from `mesh_error`, so that following a path loads no solver of programmes.
"""

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import NodeLayout
from sidmacib.mechanics.contact_law import ContactLaw
from sidmacib.mechanics.limit import limit_load
from sidmacib.problem import Problem
from sidmacib.structure.structure import refined

AT_CORNERS = (NodeLayout.VERTICES, NodeLayout.LOBATTO)
MOST_NODES = 5000  # of the finer mesh: more take longer than the answer
FACTOR = 2.0  # on the change from a mesh to the finer one: all that errors of first order have left
DIGITS = 9  # of the error after the decimal point; the rest is the solver's


def limit_mesh_error(problem: Problem, load: float) -> float | None:
    """Mesh error of a limit ``load`` (N) with friction, over itself; None where it is unknown.

    0 without bonds: what a dry face can carry at any place its nodes carry too, if all its corners
    are nodes, as forces inside a face are means of forces at its corners. With bonds, from the load
    on cells of half the size.
    """
    assembly, loads = problem
    if not ContactLaw.of(assembly).cohesive.any():
        return 0.0 if assembly.layout in AT_CORNERS else None
    fine = refined(assembly)
    if loads.axis is not None or not load > 0.0 or len(fine.nodes.area) > MOST_NODES:
        return None
    try:
        change = limit_load(fine, loads, friction=True).load / load - 1.0
    except CapacityError:
        return None
    return round(FACTOR * abs(change), DIGITS)
