"""The contacts of an assembly in YADE: forces of nodes, and what YADE's law does otherwise."""

from typing import Any

from ..scripts.assembly import GivenFace
from ..scripts.records import NodeForce
from .program import O, Vector3, create_interaction


def contact(pair: tuple[int, int]) -> Any:
    """YADE's contact of two spheres; None if they do not touch."""
    touches = O.interactions.has(*pair) and O.interactions[pair].isReal
    return O.interactions[pair] if touches else None


def node_force(pair: tuple[int, int], face: GivenFace) -> NodeForce:
    """The force between two spheres."""
    found = contact(pair)
    if found is None:
        return NodeForce(0.0, (0.0, 0.0, 0.0), False)
    normal = found.geom.normal
    # YADE's forces act on the second body; the normal points from the first to the second.
    on_above = 1.0 if normal.dot(Vector3(face.normal)) > 0 else -1.0
    bonded = face.cohesive and not found.phys.cohesionBroken
    shear = tuple(on_above * found.phys.shearForce)
    return NodeForce(found.phys.normalForce.dot(normal), shear, bonded)


def without_friction_of_bonds(pairs: list[tuple[int, int]], faces: list[GivenFace]) -> None:
    """Let a rough face rub only where its bond has failed.

    By default YADE adds friction to the cohesion of a bond, and in tension takes it off.
    """
    for pair, face in zip(pairs, faces, strict=True):
        if face.cohesive and face.material.friction and O.interactions.has(*pair):
            O.interactions[pair].phys.cohesionDisablesFriction = True


def keep_in_tension(pairs: list[tuple[int, int]]) -> None:
    """Let bonds yield in tension without limit.

    By default YADE breaks a bond at its first plastic opening, also one that is not fragile.
    """
    for pair in pairs:
        found = contact(pair)
        if found is not None and not found.phys.cohesionBroken:
            found.phys.unpMax = -1.0


def watch(pairs: list[tuple[int, int]]) -> None:
    """Have every node looked at in each step, whether it is in contact or not."""
    for pair in pairs:
        if not O.interactions.has(*pair):
            create_interaction(*pair, virtualI=True)
