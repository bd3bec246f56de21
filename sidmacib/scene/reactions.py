"""Reactions of the supports of a structure, from forces at nodes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Vector

STEEP = 1e-6  # of the force: a normal part below leaves no point of action


@dataclass(frozen=True)
class Reaction:
    """What a fixed block exerts on the blocks that touch it.

    ``force`` in N; ``moment`` in N m about the ``middle`` (m) of where they touch; ``at``: the
    point (m) through which the force acts in the mean plane there, torsion apart; None where the
    force is along that plane.
    """

    support: str
    force: Vector
    moment: Vector
    middle: Vector
    at: Vector | None


def reactions(assembly: Assembly, force: Floats) -> tuple[Reaction, ...]:
    """The reaction of each fixed block that touches one that can move.

    ``force``: of nodes, (N, 3) in N, on the piece above in the frame of the face.
    """
    fixed = np.array([piece.fixed for piece in assembly.pieces])
    below, above = np.array([(face.below, face.above) for face in assembly.faces]).T
    at_support = fixed[below] != fixed[above]
    support = np.where(fixed[below], below, above)
    towards = np.where(fixed[below], 1.0, -1.0)  # of the normal, away from the support
    axes = np.array([face.axes for face in assembly.faces])
    of_node = assembly.nodes.face
    world = towards[of_node, None] * np.einsum("ni,nij->nj", force, axes[of_node])
    found = []
    for number in dict.fromkeys(support[at_support].tolist()):
        faces = at_support & (support == number)
        nodes = faces[of_node]
        area = assembly.nodes.area[nodes]
        places = assembly.nodes.position[nodes]
        middle = area @ places / area.sum()
        normal = (towards[:, None] * axes[:, 0])[of_node[nodes]].T @ area
        own = world[nodes]
        moment = np.cross(places - middle, own).sum(axis=0)
        found.append(
            _reaction(assembly.pieces[number].name, own.sum(axis=0), moment, middle, normal)
        )
    return tuple(found)


def _reaction(
    support: str, force: Floats, moment: Floats, middle: Floats, normal: Floats
) -> Reaction:
    at = None
    size = float(np.linalg.norm(normal))
    if size > 0.0:
        unit = normal / size
        pressed = float(force @ unit)
        if abs(pressed) > STEEP * float(np.linalg.norm(force)):
            at = _vector(middle + np.cross(unit, moment) / pressed)
    return Reaction(support, _vector(force), _vector(moment), _vector(middle), at)


def total(found: Sequence[Reaction]) -> Vector:
    """The sum of the forces, N."""
    return _vector(np.sum([each.force for each in found], axis=0))


def _vector(values: Floats) -> Vector:
    x, y, z = values.tolist()
    return x, y, z
