"""Contacts that follow the blocks: points of blocks on plane faces of others, wherever both move.

A contact is a vertex of one block on the flat side of another: the point stays with the vertex, the
normal with the flat side. Where edges of both blocks cross, the point belongs to either of them.
A point that has left the outline of the face carries nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Kind, Piece
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block, Compound

SAME = 1e-6  # of the assembly's length: points and planes no further apart coincide
OVER = 1e-3  # of it: how far a point may hang over the edge of a face that still carries it
SMALL_TURN = 1e-12  # rad


@dataclass(frozen=True, eq=False)
class Placement:
    """Where the pieces are: their centroids (m), (P, 3), and how far each has turned, (P, 3, 3)."""

    built: Floats
    centre: Floats
    turn: Floats

    @classmethod
    def of(cls, assembly: Assembly) -> "Placement":
        """As the assembly was built."""
        centre = np.array([piece.centre for piece in assembly.pieces])
        return cls(centre, centre, np.tile(np.eye(3), (len(centre), 1, 1)))

    def moved(self, motion: Floats) -> "Placement":
        """Each piece moved along the screw of its ``motion`` (m and rad about the centroid), (P, 6).

        Points at the axis of rotation stay where they are, however far the piece turns.
        """
        shift, turn = motion[:, :3], motion[:, 3:]
        angle = np.linalg.norm(turn, axis=1)[:, None]
        safe = np.maximum(angle, SMALL_TURN)
        bent = np.cross(turn, shift)
        first = np.where(angle > SMALL_TURN, (1.0 - np.cos(safe)) / safe**2, 0.5)
        second = np.where(angle > SMALL_TURN, (safe - np.sin(safe)) / safe**3, 1.0 / 6.0)
        centre = self.centre + shift + first * bent + second * np.cross(turn, bent)
        return Placement(
            self.built, centre, Rotation.from_rotvec(turn).as_matrix() @ self.turn
        )

    def at(self, piece: Integers, point: Floats) -> Floats:
        """Where the ``point`` (m, as built) of each ``piece`` is, (K, 3) of (K,) and (K, 3)."""
        arm = point - self.built[piece]
        return np.asarray(self.centre[piece] + self.turned(piece, arm))

    def turned(self, piece: Integers, vector: Floats) -> Floats:
        """The ``vector`` of each ``piece`` as it has turned with it, (K, 3)."""
        return np.asarray(np.einsum("kij,kj->ki", self.turn[piece], vector))


@dataclass(frozen=True, eq=False)
class Contacts:
    """Points of pieces on faces of others, as built.

    ``point``: m, (K, 3). ``piece``: that the point belongs to, and ``flat``: that with the face,
    both (K,). ``axes``: unit normal of the face, towards the point, and tangents, (K, 3, 3).
    ``middle``: a point of the face (m), from which its ``outline`` is drawn along the tangents.
    ``friction``: (K,). ``face``: index of the interface, (K,).
    """

    point: Floats
    piece: Integers
    flat: Integers
    axes: Floats
    middle: Floats
    outline: tuple[shapely.Polygon, ...]
    friction: Floats
    face: Integers

    @classmethod
    def of(cls, assembly: Assembly) -> "Contacts":
        """Of all interfaces, which must be dry; `CapacityError` that names one that is not."""
        rows = [
            (point, *ends, axes, face.middle, outline, face.material.friction, number)
            for number, face in enumerate(assembly.faces)
            for point, ends, axes, outline in _of_face(assembly, _dry(face))
        ]
        point, piece, flat, axes, middle, outline, friction, number = zip(*rows, strict=True)
        return cls(
            *(np.array(each) for each in (point, piece, flat, axes, middle)),
            outline,
            np.array(friction),
            np.array(number),
        )

    def seen(self, placed: Placement) -> tuple[Floats, Floats, Floats]:
        """Places of the points (m) in space, the frames of the faces, and places from the faces.

        (K, 3), (K, 3, 3) and (K, 3): along the normal, which is the gap, and the tangents.
        """
        place = placed.at(self.piece, self.point)
        frames = np.einsum("kij,knj->kni", placed.turn[self.flat], self.axes)
        apart = place - placed.at(self.flat, self.middle)
        return place, frames, np.einsum("kni,ki->kn", frames, apart)

    def over(self, flat: Floats, near: float) -> Flags:
        """Whether points at places along the tangents, (K, 2), are on their faces, to ``near`` m."""
        points = shapely.points(flat)
        return np.asarray(shapely.distance(np.array(self.outline, object), points) <= near)

    def matrix(self, placed: Placement, places: Floats, frames: Floats) -> csr_array:
        """Forces and moments about the centroids of all pieces under unit contact forces, (6 P, 3 K).

        A contact force acts along the axes of the face on the piece with the point.
        """
        count, width = len(places), 6 * len(placed.centre)
        columns = np.repeat(3 * np.arange(count)[:, None] + np.arange(3), 6, axis=1).ravel()
        values, rows = [], []
        for piece, sign in ((self.piece, 1.0), (self.flat, -1.0)):
            arm = (places - placed.centre[piece])[:, None]
            values.append(sign * np.concatenate([frames, np.cross(arm, frames)], axis=2))
            rows.append(np.tile(6 * piece[:, None] + np.arange(6), (1, 3)))
        return csr_array(
            (np.array(values).ravel(), (np.array(rows).ravel(), np.tile(columns, 2))),
            (width, 3 * count),
        )


def _dry(face: object) -> Polygon:
    if not isinstance(face, Polygon) or face.kind is not Kind.DRY:
        name = getattr(face, "name", "interface")
        raise CapacityError(
            f"finite displacements: {name} is not dry; leave out cohesion, tensile strength and "
            "condensed locks"
        )
    return face


def _of_face(
    assembly: Assembly, face: Polygon
) -> Iterator[tuple[Floats, tuple[int, int], Floats, shapely.Polygon]]:
    """The contacts of an interface: point, its piece and that with the flat side, axes, outline."""
    near = SAME * assembly.length
    ends = face.below, face.above
    outlines = [_flat_side(assembly.pieces[end], face, near) for end in ends]
    for this, other, sign in ((1, 0, 1.0), (0, 1, -1.0)):
        axes = face.axes * np.array([[sign], [1.0], [1.0]])
        corners = shapely.get_coordinates(outlines[this].exterior)[:-1]
        for flat in (*corners, *_crossings(face, outlines, near)):
            yield face.at(flat), (ends[this], ends[other]), axes, outlines[other]


def _crossings(face: Polygon, outlines: list[shapely.Polygon], near: float) -> Floats:
    """Corners of an interface that are no vertices of either block, (K, 2) in m."""
    vertices = shapely.multipoints(np.concatenate([shapely.get_coordinates(o) for o in outlines]))
    corners = shapely.get_coordinates(face.outline.exterior)[:-1]
    apart = shapely.distance(vertices, shapely.points(corners))
    return np.asarray(corners[apart > near])


def _flat_side(piece: Piece, face: Polygon, near: float) -> shapely.Polygon:
    """The whole side of a ``piece`` that an interface is part of, along the interface's tangents."""
    assert isinstance(piece, Block | Compound)
    solids = piece.solids if isinstance(piece, Compound) else (piece,)
    sides = []
    for solid in solids:
        for corners in solid.outlines:
            local = (corners - np.array(face.middle)) @ face.axes.T
            if np.abs(local[:, 0]).max() <= near:
                side = shapely.Polygon(local[:, 1:])
                if side.intersection(face.outline).area > near * face.outline.length:
                    sides.append(side)
    if len(sides) < 2:
        return sides[0] if sides else face.outline
    whole = shapely.union_all(sides, grid_size=near).simplify(near)
    return whole if isinstance(whole, shapely.Polygon) else face.outline
