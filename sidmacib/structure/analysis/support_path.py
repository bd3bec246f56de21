"""The reaction of a support that moves in the static model, at small displacements.

The support becomes a free piece on a spring much stiffer than the joints, to ground, and the force
that moves the spring by as much is the load. The path follows the history of friction.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from sidmacib.errors import DOES_NOT_STAND, NoEquilibriumError
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Floats, Kind, Loads, Nodes
from sidmacib.mechanics.equilibrium import equilibrium_matrix
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.rigid import RigidSolver
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.loads import SupportMotion

STIFFER = 1e3  # stiffness of the spring over that of the stiffest joint
STRONG = 1e30  # Pa: the spring never fails
GROUND = "ground below the support"
FIRST = 0.1  # of the movement that the softest joint makes under the weight
GROWTH = 1.3  # of the movement from one equilibrium to the next
SETTLED = 0.01  # of the drop to the least reaction: what may be left of it
SMALL = 0.01  # of the assembly's length: largest movement


@dataclass(frozen=True, eq=False)
class StaticReactions:
    """The reaction (N or N m) over the ``movement`` of the support (m or rad), both (K,)."""

    movement: Floats
    reaction: Floats

    @property
    def rest(self) -> float:
        """Before the support moves."""
        return float(self.reaction[0])

    def dropped(self, least: float) -> bool:
        """Whether the reaction has dropped to the ``least`` (N or N m)."""
        return bool(self.reaction[-1] <= least + SETTLED * (self.rest - least))


def static_reactions(assembly: Assembly, loads: SupportMotion, least: float) -> StaticReactions:
    """Move the support until its reaction has dropped to the ``least`` (N or N m).

    Or until no equilibrium follows, or the displacements are no longer small.
    `NoEquilibriumError` if the structure does not stand before.
    """
    sprung, moving = _on_spring(assembly, loads)
    solver = RigidSolver(sprung, moving)
    try:
        point = solver.start()
    except NoEquilibriumError:
        raise NoEquilibriumError(DOES_NOT_STAND) from None
    # What the piece above exerts on the support, along its movement, per node force.
    on_support = equilibrium_matrix(assembly)[6 * loads.support : 6 * loads.support + 6]
    along = -(loads.motion(assembly.pieces[loads.support].centre) @ on_support)

    def reaction(at: Equilibrium) -> float:
        return float(along @ at.force[: len(assembly.nodes.area)].ravel())

    softest = min(
        face.area * min(face.material.normal_stiffness, face.material.shear_stiffness)
        for face in assembly.faces
    )
    step = FIRST * loads.scale / softest / (assembly.length if loads.turns else 1.0)
    found = [(0.0, reaction(point))]
    largest = SMALL * (1.0 if loads.turns else assembly.length)
    while found[-1][0] < largest and found[-1][1] > least + SETTLED * (found[0][1] - least):
        try:
            point = solver.solve(found[-1][0] + step, point.unknowns, point.state, thorough=True)
        except NoEquilibriumError:
            break
        found.append((point.load, reaction(point)))
        step = max(step, (GROWTH - 1.0) * point.load)
    movement, reactions = np.array(found).T
    return StaticReactions(movement, reactions)


def _on_spring(assembly: Assembly, loads: SupportMotion) -> tuple[Assembly, Loads]:
    """The assembly with its support on a spring to ground, and the force per movement."""
    support = assembly.pieces[loads.support]
    assert isinstance(support, Block | Compound)
    laws = [face.material for face in assembly.faces]
    stiffness = STIFFER * max(max(law.normal_stiffness, law.shear_stiffness) for law in laws)
    size, middle = assembly.length, support.centre
    half = size / 2.0
    law = FaceMaterial(stiffness, stiffness, 0.0, STRONG, STRONG)
    pieces = list(assembly.pieces)
    pieces[loads.support] = replace(support, fixed=False)
    pieces.append(replace(support, name=GROUND))
    x, y, z = middle.tolist()
    spring = Polygon(
        GROUND,
        Kind.INNER,
        law,
        len(pieces) - 1,
        loads.support,
        np.eye(3),
        (x, y, z),
        shapely.box(-half, -half, half, half),
    )
    corners = np.array([(0.0, p, q) for p in (-half, half) for q in (-half, half)])
    nodes = Nodes(
        np.append(assembly.nodes.face, [len(assembly.faces)] * 4),
        np.concatenate([assembly.nodes.position, middle + corners]),
        np.append(assembly.nodes.area, [size**2 / 4.0] * 4),
    )
    motion = loads.motion(middle)
    turning = size**2 / 4.0 * np.array([2.0, 1.0, 1.0])  # second moments of the nodes' areas
    force = stiffness * size**2 * np.concatenate([motion[:3], turning * motion[3:]])
    zero, variable = np.zeros((1, 6)), np.zeros((len(pieces), 6))
    variable[loads.support] = force
    sprung = replace(assembly, pieces=tuple(pieces), faces=(*assembly.faces, spring), nodes=nodes)
    permanent = np.concatenate([loads.permanent, zero])
    return sprung, Loads(permanent, variable, loads.scale)
