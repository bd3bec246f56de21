"""The lateral load on the joint's pieces."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sidmacib.joint import Direction, Joint
from sidmacib.mechanics.assembly import Assembly, Kind, Loads, Nodes, self_weight
from sidmacib.pieces import lock_name, upper_bodies
from sidmacib.validation import refused, require_member


class LoadShare(StrEnum):
    """The part of the upper block's lateral face that is loaded."""

    FACE = "face"  # the whole face: column and, where it belongs to the upper block, lock
    BODY = "body"  # the main body only


class Push(StrEnum):
    """The direction in which the lateral load acts."""

    PLUS_Y = "+y"  # on the face y = 0, where lock 1 is
    MINUS_Y = "-y"  # on the opposite face


@dataclass(frozen=True)
class Loading:
    """The direction of the lateral load in the (V, M) plane, and where it acts."""

    direction: Direction
    share: LoadShare = LoadShare.FACE
    push: Push = Push.PLUS_Y

    def __post_init__(self) -> None:
        if not isinstance(self.direction, Direction):
            raise refused("direction", self.direction, "a Direction")
        require_member(LoadShare, share=self.share)
        require_member(Push, push=self.push)


def lateral_load(joint: Joint, assembly: Assembly, loading: Loading) -> Loads:
    """Self-weight, and 1 N of load along the direction of ``loading`` on the pieces of ``joint``.

    The paper (section 3) applies a pressure that is uniform in z and linear in x to the lateral
    face of the upper block: its resultant is V at mid-length and the torque M about z. Each loaded
    piece takes both in proportion to its height. The scale is the strength of a lock, or the
    weight of the free pieces where they have no cohesion.
    """
    direction = loading.direction
    sign = 1.0 if loading.push is Push.PLUS_Y else -1.0
    names = _loaded(joint, loading)
    loaded = [i for i, piece in enumerate(assembly.pieces) if piece.name in names]
    height = np.array([assembly.pieces[i].size[2] for i in loaded])
    part = height / height.sum()
    variable = np.zeros((len(assembly.pieces), 6))
    variable[loaded, 1] = sign * direction.shear * part
    variable[loaded, 5] = direction.torque * joint.a * part
    weight = sum(piece.weight for piece in assembly.pieces if not piece.fixed)
    sides = tuple((piece, 1, sign < 0.0) for piece in loaded)
    return Loads(self_weight(assembly.pieces), variable, joint.T0 or weight, sides)


def pressed(
    joint: Joint, assembly: Assembly, loads: Loads, overload: float
) -> tuple[Assembly, Loads]:
    """The joint with a force (N, down, shared by the upper bodies) in place of the fixed plate."""
    kept = [i for i, face in enumerate(assembly.faces) if face.kind is not Kind.PLATE]
    own = np.isin(assembly.nodes.face, kept)
    nodes = Nodes(
        np.searchsorted(kept, assembly.nodes.face[own]),
        assembly.nodes.position[own],
        assembly.nodes.area[own],
    )
    bodies = [i for i, p in enumerate(assembly.pieces) if p.name in upper_bodies(joint)]
    permanent = loads.permanent.copy()
    permanent[bodies, 2] -= overload / len(bodies)
    faces = tuple(assembly.faces[i] for i in kept)
    return replace(assembly, faces=faces, nodes=nodes), replace(loads, permanent=permanent)


def _loaded(joint: Joint, loading: Loading) -> set[str]:
    """Names of the pieces that the load acts on."""
    first = loading.push is Push.PLUS_Y
    lock = 1 if first else joint.locks
    names = {upper_bodies(joint)[0 if first else -1]}
    if loading.share is LoadShare.FACE and joint.is_upper(lock):
        names.add(lock_name(lock))
    return names
