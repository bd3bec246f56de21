"""Contacts that follow the blocks: vertices of one on the flat side of another, wherever both are.

The point of a contact stays with the vertex and its normal with the flat side. A vertex that has
left the outline of the side carries nothing; where outlines cross, there is a contact at the
crossing. Contacts are sought between blocks that touched when they were built; `meeting` finds
others.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields

import numpy as np
import shapely
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation

from sidmacib.errors import CapacityError, InfeasibleError
from sidmacib.mechanics.assembly import Assembly, Face, Floats, Integers, Kind
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import solids_of
from sidmacib.structure.overlaps import Placed, candidates, overlap

SAME = 1e-6  # of the assembly's length: planes no further apart coincide
# Of it, how far a vertex may hang over the edge of a side that still carries it: as one that turns
# about where it was built may, as steps are finite, or as one that has slid.
OVER, SLID = 1e-3, 1e-5
MET = 1e-3  # of it: pieces that overlap by more have met
LEAST_ANGLE = 1e-9  # rad: less is no turn


@dataclass(frozen=True, eq=False)
class Placement:
    """Where pieces are: centroids as ``built`` and now (m), (P, 3), and turns since, (P, 3, 3)."""

    built: Floats
    centre: Floats
    turn: Floats

    @classmethod
    def of(cls, assembly: Assembly) -> "Placement":
        """As the assembly was built."""
        centre = np.array([piece.centre for piece in assembly.pieces])
        return cls(centre, centre, np.tile(np.eye(3), (len(centre), 1, 1)))

    def moved(self, motion: Floats) -> "Placement":
        """Each piece moved along the screw of its ``motion`` (m and rad at the centroid), (P, 6).

        Points on the axis of rotation stay where they are, however far the piece turns.
        """
        shift, turn = motion[:, :3], motion[:, 3:]
        angle = np.linalg.norm(turn, axis=1)[:, None]
        turns, safe = angle > LEAST_ANGLE, np.maximum(angle, LEAST_ANGLE)
        first = np.where(turns, (1.0 - np.cos(safe)) / safe**2, 0.5)
        second = np.where(turns, (safe - np.sin(safe)) / safe**3, 1.0 / 6.0)
        across = np.cross(turn, shift)
        centre = self.centre + shift + first * across + second * np.cross(turn, across)
        return Placement(self.built, centre, Rotation.from_rotvec(turn).as_matrix() @ self.turn)

    def at(self, piece: int, points: Floats) -> Floats:
        """Where ``points`` of a ``piece`` are that were built at (..., 3), in m."""
        arms = points - self.built[piece]
        return np.asarray(self.centre[piece] + arms @ self.turn[piece].T)


@dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts of pieces that are placed somewhere.

    ``place``: m, (K, 3). ``piece``: that with the vertex, and ``flat``: that with the side, both
    (K,). ``frames``: unit normal of the side, towards the vertex, and tangents, (K, 3, 3). ``gap``:
    along the normal, m, (K,). ``friction``: (K,). ``face``: index of the interface, (K,).
    """

    place: Floats
    piece: Integers
    flat: Integers
    frames: Floats
    gap: Floats
    friction: Floats
    face: Integers

    def closer(self, most: float) -> "Contacts":
        """Those whose gap is at most that wide (m)."""
        return self._of(self.gap <= most)

    def without(self, piece: int) -> "Contacts":
        """Those of other pieces."""
        return self._of((self.piece != piece) & (self.flat != piece))

    def _of(self, chosen: Flags) -> "Contacts":
        return Contacts(*(getattr(self, each.name)[chosen] for each in fields(self)))

    def matrix(self, centres: Floats) -> csr_array:
        """Forces and moments about ``centres``, (P, 3), of unit contact forces, (6 P, 3 K).

        A contact force acts along the axes of its frame on the piece with the vertex.
        """
        count = len(self.place)
        columns = np.repeat(3 * np.arange(count)[:, None] + np.arange(3), 6, axis=1).ravel()
        values, rows = [], []
        for piece, sign in ((self.piece, 1.0), (self.flat, -1.0)):
            arm = (self.place - centres[piece])[:, None]
            wrench = np.concatenate([self.frames, np.cross(arm, self.frames)], axis=2)
            values.append(sign * wrench)
            rows.append(np.tile(6 * piece[:, None] + np.arange(6), (1, 3)))
        where = np.array(rows).ravel(), np.tile(columns, 2)
        return csr_array((np.array(values).ravel(), where), (6 * len(centres), 3 * count))


@dataclass(frozen=True, eq=False)
class Side:
    """The plane side of a ``piece`` at an interface, as built.

    ``corners``: m, (C, 3). ``axes``: unit normal outwards, and tangents, (3, 3). ``outline``: along
    the tangents from the ``middle`` (m) of the interface.
    """

    piece: int
    corners: Floats
    axes: Floats
    middle: Floats
    outline: shapely.Polygon

    def frame(self, placed: Placement) -> Floats:
        """The axes where the piece is placed, (3, 3)."""
        return np.asarray(self.axes @ placed.turn[self.piece].T)

    def seen(self, placed: Placement, points: Floats) -> Floats:
        """``points`` in space (m), (K, 3), along these axes from the middle."""
        return np.asarray((points - placed.at(self.piece, self.middle)) @ self.frame(placed).T)

    def contacts(
        self, other: "Side", placed: Placement, over: float
    ) -> Iterator[tuple[Floats, float]]:
        """Place and gap (m) where vertices of an ``other`` side are on this one, or outlines cross.

        A vertex that has not slid may hang ``over`` the edge by so much (m).
        """
        places = placed.at(other.piece, other.corners)
        seen = self.seen(placed, places)
        slid = np.linalg.norm(seen - (other.corners - self.middle) @ self.axes.T, axis=1) > over
        vertices = shapely.points(seen[:, 1:])
        near = shapely.distance(self.outline, vertices) <= np.where(slid, SLID / OVER * over, over)
        yield from zip(places[near], seen[near, 0].tolist(), strict=True)
        both = shapely.union_all([*vertices[near], shapely.extract_unique_points(self.outline)])
        shared = shapely.Polygon(seen[:, 1:]).intersection(self.outline)
        corners = shapely.get_coordinates(shared)[:-1]
        for corner in corners[shapely.distance(both, shapely.points(corners)) > over]:
            place = placed.at(self.piece, self.middle) + corner @ self.frame(placed)[1:]
            yield place, float(other.seen(placed, place)[0])


def contacts_of(
    assembly: Assembly, sides: Sequence[tuple[Side, Side]], placed: Placement
) -> Contacts:
    """The contacts where the pieces are ``placed``; `InfeasibleError` if none is left.

    ``sides``: of each interface of ``assembly``, by `sides_of`.
    """
    over = OVER * assembly.length
    found = [
        (place, other.piece, side.piece, frame, gap, face.material.friction, number)
        for number, face in enumerate(assembly.faces)
        for side, other in (sides[number], sides[number][::-1])
        for frame in (side.frame(placed),)
        for place, gap in side.contacts(other, placed, over)
    ]
    if not found:
        raise InfeasibleError("finite displacements: no blocks touch any more")
    return Contacts(*map(np.array, zip(*found, strict=True)))


def sides_of(assembly: Assembly, face: Face) -> tuple[Side, Side]:
    """The sides of the pieces below and above a ``face``; `CapacityError` unless it is dry."""
    if not isinstance(face, Polygon) or face.kind is not Kind.DRY:
        raise CapacityError(
            f"finite displacements: {face.name} is not dry; leave out cohesion, tensile strength "
            "and condensed locks"
        )
    turned = face.axes * np.array([[-1.0], [1.0], [1.0]])
    return _side(assembly, face.below, face, face.axes), _side(assembly, face.above, face, turned)


def _side(assembly: Assembly, piece: int, face: Polygon, axes: Floats) -> Side:
    """The whole side of a ``piece`` that an interface is part of; ``axes``: outwards from it."""
    near, outline, parts = SAME * assembly.length, face.outline, []
    solids = solids_of(assembly.pieces[piece])
    for corners in (corners for solid in solids for corners in solid.outlines):
        local = (corners - np.array(face.middle)) @ axes.T
        if np.abs(local[:, 0]).max() <= near:
            part = shapely.Polygon(local[:, 1:])
            if part.intersection(face.outline).area > near * face.outline.length:
                parts.append(part)
    if parts:
        whole = parts[0] if len(parts) == 1 else shapely.union_all(parts, grid_size=near)
        outline = whole.simplify(near) if isinstance(whole, shapely.Polygon) else outline
    flat = shapely.get_coordinates(outline.exterior)[:-1]
    middle = np.array(face.middle)
    return Side(piece, middle + flat @ axes[1:], axes, middle, outline)


def meeting(assembly: Assembly, placed: Placement) -> tuple[str, str] | None:
    """Names of two pieces that did not touch when they were built, and now overlap.

    Solids that are not convex are left out.
    """
    touching = {frozenset((face.below, face.above)) for face in assembly.faces}
    solids = [
        Placed(
            number,
            piece.fixed,
            placed.at(number, solid.places),
            solid.normals @ placed.turn[number].T,
            tuple(placed.at(number, outline) for outline in solid.outlines),
        )
        for number, piece in enumerate(assembly.pieces)
        for solid in solids_of(piece)
        if solid.reentrant is None
    ]
    over = MET * assembly.length
    for one, other in candidates(solids, over):
        apart = one.piece != other.piece and frozenset((one.piece, other.piece)) not in touching
        if apart and overlap(one, other, over) > over:
            return assembly.pieces[one.piece].name, assembly.pieces[other.piece].name
    return None
