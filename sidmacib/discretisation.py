"""The joint cut into rigid pieces that meet across faces, with contact nodes on every face.

This is the one description of the geometry. Every model and every engine works from it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from sidmacib.joint import GRAVITY, FaceMaterial, Joint, UpperBody

Vector = tuple[float, float, float]
Floats = NDArray[np.float64]


class Block(StrEnum):
    """The body that a piece belongs to."""

    UPPER = "upper"
    LOWER = "lower"
    PLATE = "plate"


class Kind(StrEnum):
    """The kind of a face, which decides its material."""

    INNER = "inner"  # cohesive, inside one block
    DRY = "dry"  # frictional and unilateral, between the blocks
    PLATE = "plate"  # frictionless and unilateral, under the fixed plate


@dataclass(frozen=True)
class Piece:
    """A rigid cuboid, given by two opposite corners in m."""

    name: str
    block: Block
    low: Vector
    high: Vector
    mass: float  # kg
    fixed: bool = False
    lock: int = 0  # the lock's number, 0 if the piece is none

    @property
    def centre(self) -> Floats:
        """Centroid, in m, shape (3,)."""
        return (np.array(self.low) + np.array(self.high)) / 2

    @property
    def size(self) -> Floats:
        """Edge lengths, in m, shape (3,)."""
        return np.array(self.high) - np.array(self.low)

    @property
    def inertia(self) -> Floats:
        """Principal moments of inertia about the centroid, in kg m2, shape (3,)."""
        squares = self.size**2
        return self.mass / 12 * (squares.sum() - squares)

    @property
    def weight(self) -> float:
        """Self-weight in N."""
        return self.mass * GRAVITY


@dataclass(frozen=True)
class Face:
    """A plane rectangle across which two pieces meet.

    ``below`` and ``above`` are indices of pieces; the unit normal, along ``axis`` (0, 1, 2 for x,
    y, z), points from ``below`` to ``above``.
    """

    name: str
    kind: Kind
    below: int
    above: int
    axis: int
    low: Vector
    high: Vector
    lock: int = 0  # the lock whose inner (horizontal) face this is, 0 if none

    @property
    def normal(self) -> Floats:
        """Unit normal from ``below`` to ``above``, shape (3,)."""
        return np.eye(3)[self.axis]

    @property
    def area(self) -> float:
        """Area in m2."""
        return float(np.prod([s for s in np.subtract(self.high, self.low) if s > 0]))


@dataclass(frozen=True)
class Nodes:
    """Contact nodes of all faces, one row each."""

    face: NDArray[np.int64]  # (N,) index of the face
    position: Floats  # (N, 3) in m
    area: Floats  # (N,) tributary area in m2


@dataclass(frozen=True)
class Discretisation:
    """Pieces, faces and nodes of ``joint``; no cell of a face is longer than ``mesh`` (m)."""

    joint: Joint
    mesh: float
    pieces: tuple[Piece, ...]
    faces: tuple[Face, ...]
    nodes: Nodes

    def material(self, kind: Kind) -> FaceMaterial:
        """Material of a face of ``kind``."""
        dry = self.joint.dry
        if kind is Kind.INNER:
            return self.joint.inner
        if kind is Kind.DRY:
            return dry
        return FaceMaterial(dry.normal_stiffness, dry.shear_stiffness, 0.0, 0.0, 0.0)


def discretise(joint: Joint, mesh: float) -> Discretisation:
    """Cut ``joint`` into pieces and put nodes on their faces, no further apart than ``mesh`` (m).

    The nodes are the centres of equal cells. ValueError if the mesh is not positive, or not less
    than the shorter side of the locks' horizontal faces: one row of nodes would be a hinge.
    """
    if not 0 < mesh < min(joint.a, joint.b):
        raise ValueError(
            f"mesh: got {mesh} m, allowed is more than 0 and less than {min(joint.a, joint.b)} m, "
            "the shorter side of an inner face"
        )
    pieces = rigid_pieces(joint)
    faces = tuple(_faces(joint, pieces))
    return Discretisation(joint, mesh, pieces, faces, contact_nodes(faces, mesh))


def rigid_pieces(joint: Joint) -> tuple[Piece, ...]:
    """Lower body, plate, locks and upper body (or its columns), in this order."""
    return tuple(_pieces(joint))


def _pieces(joint: Joint) -> Iterator[Piece]:
    x = joint.a / 2
    width = joint.locks * joint.b
    top = joint.h + joint.H

    def cuboid(
        name: str, block: Block, y: tuple[float, float], z: tuple[float, float], lock: int = 0
    ) -> Piece:
        volume = joint.a * (y[1] - y[0]) * (z[1] - z[0])
        fixed = name in (Block.LOWER, Block.PLATE)
        low, high = (-x, y[0], z[0]), (x, y[1], z[1])
        return Piece(name, block, low, high, joint.density * volume, fixed, lock)

    # The lower body and the plate are fixed: their thickness is immaterial.
    yield cuboid("lower", Block.LOWER, (0.0, width), (-joint.H, 0.0))
    yield cuboid("plate", Block.PLATE, (0.0, width), (top, top + joint.h))
    for lock in range(1, joint.locks + 1):
        block = Block.UPPER if joint.is_upper(lock) else Block.LOWER
        yield cuboid(f"lock{lock}", block, _strip(joint, lock), (0.0, joint.h), lock)
    if joint.upper_body is UpperBody.MONOLITHIC:
        yield cuboid("body", Block.UPPER, (0.0, width), (joint.h, top))
        return
    for lock in range(1, joint.locks + 1):
        yield cuboid(f"column{lock}", Block.UPPER, _strip(joint, lock), (joint.h, top))


def _strip(joint: Joint, lock: int) -> tuple[float, float]:
    return (lock - 1) * joint.b, lock * joint.b


def _faces(joint: Joint, pieces: tuple[Piece, ...]) -> Iterator[Face]:
    index = {piece.name: i for i, piece in enumerate(pieces)}
    monolithic = joint.upper_body is UpperBody.MONOLITHIC

    def face(name: str, kind: Kind, below: str, above: str, axis: int, lock: int = 0) -> Face:
        """The rectangle that two pieces share across ``axis``."""
        first, second = pieces[index[below]], pieces[index[above]]
        low = [max(p, q) for p, q in zip(first.low, second.low, strict=True)]
        high = [min(p, q) for p, q in zip(first.high, second.high, strict=True)]
        low[axis] = high[axis] = first.high[axis]
        corners = (low[0], low[1], low[2]), (high[0], high[1], high[2])
        return Face(name, kind, index[below], index[above], axis, *corners, lock)

    for lock in range(1, joint.locks + 1):
        foot, head = (Kind.DRY, Kind.INNER) if joint.is_upper(lock) else (Kind.INNER, Kind.DRY)
        body = "body" if monolithic else f"column{lock}"
        inner = {Kind.INNER: lock, Kind.DRY: 0}
        yield face(f"{foot}-lower-lock{lock}", foot, "lower", f"lock{lock}", 2, inner[foot])
        yield face(f"{head}-lock{lock}-{body}", head, f"lock{lock}", body, 2, inner[head])
        if not monolithic:
            yield face(f"plate-{body}", Kind.PLATE, body, "plate", 2)
    for lock in range(1, joint.locks):
        yield face(f"dry-lock{lock}-lock{lock + 1}", Kind.DRY, f"lock{lock}", f"lock{lock + 1}", 1)
        if not monolithic:
            pair = f"column{lock}", f"column{lock + 1}"
            yield face(f"inner-{pair[0]}-{pair[1]}", Kind.INNER, *pair, 1)
    if monolithic:
        yield face("plate-body", Kind.PLATE, "body", "plate", 2)


def contact_nodes(faces: tuple[Face, ...], mesh: float) -> Nodes:
    """Nodes at the centres of equal cells of ``faces``, no cell longer than ``mesh`` (m)."""
    owner, position, area = [], [], []
    for number, face in enumerate(faces):
        axes = [_cell_centres(lo, hi, mesh) for lo, hi in zip(face.low, face.high, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        owner.append(np.full(len(grid), number))
        position.append(grid)
        area.append(np.full(len(grid), face.area / len(grid)))
    return Nodes(np.concatenate(owner), np.concatenate(position), np.concatenate(area))


def _cell_centres(low: float, high: float, mesh: float) -> Floats:
    count = max(1, math.ceil((high - low) / mesh - 1e-9))
    return low + (np.arange(count) + 0.5) * (high - low) / count
