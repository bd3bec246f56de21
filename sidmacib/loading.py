"""The lateral load on the pieces of the joint."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sidmacib.discretisation import Block, Discretisation, Floats, Piece
from sidmacib.joint import Direction


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
    """Where the lateral load acts, and its eccentricity in m (``inf`` is pure torsion)."""

    eccentricity: float
    share: LoadShare = LoadShare.FACE
    push: Push = Push.PLUS_Y


@dataclass(frozen=True)
class PieceLoad:
    """Force (N) and moment about the piece's centroid (N m), both of shape (3,)."""

    piece: int
    force: Floats
    moment: Floats


def lateral_load(model: Discretisation, loading: Loading) -> tuple[PieceLoad, ...]:
    """Loads on the pieces for a load of 1 N along the direction of ``loading``.

    The paper (section 3) applies a pressure that is uniform in z and linear in x to the lateral
    face of the upper block: its resultant is V at mid-length and the torque M about z. Each loaded
    piece takes both in proportion to its height.
    """
    direction = Direction.at_eccentricity(loading.eccentricity, model.joint.a)
    sign = 1.0 if loading.push is Push.PLUS_Y else -1.0
    loaded = [i for i, piece in enumerate(model.pieces) if _is_loaded(piece, model, loading)]
    height = sum(model.pieces[i].size[2] for i in loaded)

    def load(index: int) -> PieceLoad:
        part = float(model.pieces[index].size[2] / height)
        force = np.array([0.0, sign * direction.shear * part, 0.0])
        return PieceLoad(index, force, np.array([0.0, 0.0, direction.torque * part]))

    return tuple(load(i) for i in loaded)


def _is_loaded(piece: Piece, model: Discretisation, loading: Loading) -> bool:
    if piece.block is not Block.UPPER or (loading.share is LoadShare.BODY and piece.lock):
        return False
    if loading.push is Push.PLUS_Y:
        return piece.low[1] == 0.0
    return bool(np.isclose(piece.high[1], model.joint.locks * model.joint.b))
