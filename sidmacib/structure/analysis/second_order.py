r"""How much finite rotation would change a load of the static model, to second order (P-Delta).

The static model balances forces where pieces were built. Where they have turned by :math:`\theta`,
forces act at other places, and have moments that it leaves out. Their work in the motion
:math:`\dot u` with which the path goes on, over that of the load, is the change of the load:

.. math::

    \Delta\lambda = - \frac{\sum_i \dot\theta_i \cdot
    \sum_n (\theta_i \times r_{in}) \times f_{in}}{q \cdot \dot u}

The first sum is over the pieces, the second over the forces on each, f at r from its centroid. For
a block that rocks it is the slope of its load, :math:`W \tan(\alpha - \theta)`, times its rotation.
The largest of :math:`\lambda + \Delta\lambda` on the path is the load that is left: as an edge is
pressed more it gives way ever faster, without end at the load of rigid blocks. Coarse cells do not
show it: a cell at the edge takes the place of the edge.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from itertools import pairwise

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Loads
from sidmacib.mechanics.equilibrium import face_frames, motion_of
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.structure.analysis.tilt import Turning, load_of_tilt, turning
from sidmacib.structure.loads import PointForce, StructureLoads

MATTERS = 0.05  # of the load: a change that is worth a note
HALVINGS = 5  # of the path, around the largest load that is left


def rotation_effect(assembly: Assembly, loads: Loads, path: Sequence[Equilibrium]) -> float | None:
    """The change of the load at the end of ``path`` by finite rotation, over it.

    ``loads``: whose variable part raises the path. None where it has no motion along the load.
    """
    if not path:
        return None
    turns = loads.axis is not None
    solver = Turning(assembly, loads) if turns else RigidSolver(assembly, loads)

    def left(path: Sequence[Equilibrium]) -> float:
        """The load at the last equilibrium with its change."""
        at, load, carried = loads, path[-1].load, path[-1].load
        if turns:
            at, load, carried = turning(loads, load), 0.0, load_of_tilt(load, loads)
        change = _change(assembly, at, path, load)
        return -math.inf if change is None else path[-1].load * (1.0 + change / carried)

    found = [(point, left(path[: number + 1])) for number, point in enumerate(path)]
    for _ in range(HALVINGS):
        best = max(range(len(found)), key=lambda number: found[number][1])
        for (one, _), (other, _) in pairwise(found[max(best - 1, 0) : best + 2]):
            with suppress(CapacityError):
                middle = (one.load + other.load) / 2.0
                point = solver.solve(middle, one.unknowns, one.state)
                found.append((point, left((one, point))))
        found.sort(key=lambda each: each[0].load)
    most = max(each for _, each in found)
    return None if math.isinf(most) else most / path[-1].load - 1.0


def _change(
    assembly: Assembly, loads: Loads, path: Sequence[Equilibrium], load: float
) -> float | None:
    """The change of the load by the rotations at the last equilibrium of ``path``, in N.

    ``load`` (N): the multiple of the variable ``loads`` that acts beside the permanent ones. None
    where the path has no motion along the load.
    """
    earlier = [point for point in path if point.load < path[-1].load]
    if not earlier:
        return None
    here, goes_on = (
        motion_of(assembly, unknowns)
        for unknowns in (path[-1].unknowns, path[-1].unknowns - earlier[-1].unknowns)
    )
    work = float(np.sum(loads.variable * goes_on))
    if not work > 0.0:
        return None
    moments = np.zeros((len(assembly.pieces), 3))
    on_above = np.einsum("nk,nkx->nx", path[-1].force, face_frames(assembly))
    for side, sign in (("above", 1.0), ("below", -1.0)):
        piece = np.array([getattr(face, side) for face in assembly.faces])[assembly.nodes.face]
        arms = assembly.nodes.position - np.array([each.centre for each in assembly.pieces])[piece]
        turned = np.cross(here[piece, 3:], arms)
        np.add.at(moments, piece, np.cross(turned, sign * on_above))
    if isinstance(loads, PointForce):
        moments += np.cross(np.cross(here[:, 3:], loads.arms), load * loads.variable[:, :3])
    if isinstance(loads, StructureLoads):
        moments += loads.turned_moments(np.cross(here[:, None, 3:], np.eye(3)).swapaxes(1, 2))
    return -float(np.sum(moments * goes_on[:, 3:])) / work


def rotation_words(change: float | None) -> str:
    """A note on a ``change`` of the load, over it; nothing if it does not matter."""
    if change is None or abs(change) <= MATTERS:
        return ""
    way = "lower" if change < 0.0 else "raise"
    return (
        f"small displacements: finite rotation would {way} it by about {100.0 * abs(change):.2g} %"
    )
