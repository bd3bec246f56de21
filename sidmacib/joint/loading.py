"""The lateral load on the joint's pieces, and both as the input of a model."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint import Direction, Joint
from sidmacib.joint.pieces import assemble, lock_name, upper_bodies
from sidmacib.mechanics.assembly import Assembly, NodeLayout
from sidmacib.mechanics.equilibrium import self_weight
from sidmacib.mechanics.loads import Loads, SideLoad
from sidmacib.problem import Problem
from sidmacib.validation import refused, require_member

SMOOTH = 1e-3  # friction that does not hold an upper block along locks that have turned


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
    """Permanent loads, and 1 N along the direction of ``loading``, on the pieces of ``joint``.

    Permanent are self-weight and a given force or pressure that acts evenly on the top. The paper
    (section 3) applies a pressure that is uniform in z and linear in x to the lateral face of the
    upper block: its resultant is V at mid-length and the torque M about z. Each loaded piece takes
    both in proportion to its height. Flanks turn with their locks, so that a part of V pushes the
    upper block along them: where friction is at most `SMOOTH`, what pushes holds it. The scale is
    the strength of the strongest lock, or without cohesion the permanent loads on the free pieces;
    `CapacityError` if both are 0.
    """
    direction = loading.direction
    sign = 1.0 if loading.push is Push.PLUS_Y else -1.0
    names = _loaded(joint, loading)
    loaded = [i for i, piece in enumerate(assembly.pieces) if piece.name in names]
    pieces = assembly.cuboids
    height = np.array([pieces[i].size[2] for i in loaded])
    part = height / height.sum()
    variable = np.zeros((len(assembly.pieces), 6))
    variable[loaded, 1] = sign * direction.shear * part
    variable[loaded, 5] = direction.torque * joint.a * part
    sides = [SideLoad(i, 1, sign < 0.0, tuple(variable[i].tolist())) for i in loaded]
    permanent = self_weight(assembly.pieces)
    pressing, bodies = joint.pressing_force or 0.0, upper_bodies(joint)
    for i, piece in enumerate(pieces):
        if pressing and piece.name in bodies:
            share = pressing * (piece.size[1] / joint.total_width)
            permanent[i, 2] -= share
            sides.append(SideLoad(i, 2, True, (0.0, 0.0, -share, 0.0, 0.0, 0.0), permanent=True))
    weight = math.fsum(piece.weight for piece in assembly.pieces if not piece.fixed)
    scale = max(joint.strengths) or weight + pressing
    if not scale:
        raise CapacityError(
            "no capacity: the joint has no cohesion and no weight, and nothing presses on it"
        )
    guided = None if joint.dry.friction > SMOOTH else max(loaded)  # a main body is last
    return Loads(permanent, variable, scale, tuple(sides), guided=guided)


def _loaded(joint: Joint, loading: Loading) -> set[str]:
    """Names of the pieces that the load acts on."""
    first = loading.push is Push.PLUS_Y
    lock = 1 if first else joint.locks
    names = {upper_bodies(joint)[0 if first else -1]}
    if loading.share is LoadShare.FACE and joint.is_upper(lock):
        names.add(lock_name(lock))
    return names


def posed(
    joint: Joint,
    loading: Loading,
    mesh: float,
    nodes: NodeLayout = NodeLayout.LOBATTO,
    *,
    least: int | None = None,
) -> Problem:
    """The pieces of ``joint`` on cells of at most ``mesh`` (m), under ``loading``.

    ``least`` and errors as for `sidmacib.assemble`; errors of `sidmacib.lateral_load`.
    """
    assembly = assemble(joint, mesh, nodes, least=least)
    return Problem(assembly, lateral_load(joint, assembly, loading))
