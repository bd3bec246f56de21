"""Pieces of an assembly as convex solids, in the arrays that compiled code takes."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from sidmacib.dynamics.bodies import Bodies
from sidmacib.dynamics.collide import CORNERS
from sidmacib.dynamics.contacts import Places, Solids
from sidmacib.dynamics.roots import inertia_of
from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly, Cuboid, Floats, Integers, Piece
from sidmacib.structure.blocks import Block, Compound, box, solids_of
from sidmacib.structure.overlaps import meeting_boxes, solid_of

FLAT = 1e-6  # over a block's size: what is thinner is not there
DIGITS = 9  # of directions of edges that are the same
ROUNDED = 1e-6  # of a volume
PLANE = 1e-5  # of normals and, over the size, of distances: triangles that are one side
MOST_PARTS = 200  # convex ones of a block


@dataclass(frozen=True, eq=False)
class Convex:
    """A convex solid: vertices about the origin (m), outlines of sides, normals outwards."""

    places: Floats
    outlines: tuple[tuple[int, ...], ...]
    normals: Floats

    @property
    def edges(self) -> Integers:
        """The numbers of both ends of each edge, (E, 2)."""
        ends = {
            (min(a, b), max(a, b)) for each in self.outlines for a, b in pairwise((*each, each[0]))
        }
        return np.array(sorted(ends), np.int64)

    @property
    def directions(self) -> Floats:
        """Of edges, each once, (D, 3)."""
        along = np.diff(self.places[self.edges], axis=1)[:, 0]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        largest = along[np.arange(len(along)), np.abs(along).argmax(axis=1)]
        rounded = np.round(along * np.sign(largest)[:, None], DIGITS)
        return np.asarray(np.unique(rounded, axis=0))


def convex_parts(piece: Piece) -> Iterator[Convex]:
    """The convex solids that a ``piece`` is made of, where it was built.

    `CapacityError` for more than `MOST_PARTS` in a block.
    """
    blocks = solids_of(piece)
    if isinstance(piece, Cuboid):
        blocks = (box(piece.name, piece.low, piece.high, 1.0),)
    for block in blocks:
        yield from (_sides(each) for each in _convex_hulls(block))


def _convex_hulls(block: Block) -> Iterator[ConvexHull]:
    """A block, cut along the planes of its sides until all parts are convex."""
    if block.reentrant is None:
        yield ConvexHull(block.places)
        return
    middle, size = block.places.mean(axis=0), block.size
    left, found = [solid_of(block, middle, size)], []
    while left:
        solid = left.pop()
        mesh = solid.to_mesh64()
        body = trimesh.Trimesh(mesh.vert_properties[:, :3], mesh.tri_verts, process=False)
        bodies, places = _halves(body, solid)
        left += bodies
        if not bodies:
            found.append(ConvexHull(middle + size * places))
        if len(found) + len(left) > MOST_PARTS:
            raise CapacityError(f"in time: {block.name} has more than {MOST_PARTS} convex parts")
    if abs(sum(each.volume for each in found) / block.volume - 1.0) > ROUNDED:
        raise CapacityError(f"in time: {block.name} cannot be cut into convex parts")
    yield from found


def _halves(body: trimesh.Trimesh, solid: Any) -> tuple[list[Any], Floats]:
    """The bodies on both sides of the plane of a side that cuts a ``solid``; its vertices.

    No bodies of one that is convex. Vertices are without those of flaps: what earlier cuts left
    without a volume, on one side of a plane.
    """
    places = body.vertices
    for side in np.argsort(-body.area_faces)[: int((body.area_faces > FLAT).sum())]:
        normal = body.face_normals[side]
        heights = (places - body.triangles[side][0]) @ normal
        if heights.max() < FLAT or heights.min() > -FLAT:
            continue
        halves = solid.split_by_plane(tuple(normal), float(body.triangles[side][0] @ normal))
        least = FLAT * solid.volume()
        front, behind = (each.volume() > least for each in halves)
        if front and behind:
            bodies = [each for half in halves for each in half.decompose()]
            return [each for each in bodies if each.volume() > least], places
        places = places[heights <= FLAT] if behind else places[heights >= -FLAT]
    return [], places


def _sides(hull: ConvexHull) -> Convex:
    """A convex hull with one side for all triangles in a plane."""
    used = hull.vertices
    number = np.zeros(len(hull.points), np.int64)
    number[used] = np.arange(len(used))
    places, triangles = hull.points[used], number[hull.simplices]
    near = np.array([1.0, 1.0, 1.0, np.linalg.norm(np.ptp(places, axis=0))]) * PLANE
    planes: list[int] = []
    for k, plane in enumerate(hull.equations):
        if not any((np.abs(hull.equations[other] - plane) <= near).all() for other in planes):
            planes.append(k)
    outlines, normals = [], hull.equations[planes, :3]
    for k, normal in zip(planes, normals, strict=True):
        same = (np.abs(hull.equations - hull.equations[k]) <= near).all(axis=1)
        ends = np.unique(triangles[same])
        across = places[ends] - places[ends].mean(axis=0)
        x = across[0] / np.linalg.norm(across[0])
        turn = np.arctan2(across @ np.cross(normal, x), across @ x)
        outlines.append(tuple(ends[np.argsort(turn)].tolist()))
    return Convex(places, tuple(outlines), normals)


@dataclass(frozen=True, eq=False)
class Shapes:
    """All pieces of an assembly: ``solids``, as ``built`` about bodies' centroids, and ``bodies``.

    ``centre``: of each body, m, (P, 3). ``part``: the piece of each solid, (S,).
    """

    solids: Solids
    built: Places
    bodies: Bodies
    centre: Floats
    part: Integers

    @classmethod
    def of(cls, assembly: Assembly, body: Integers) -> "Shapes":
        """Of all pieces; ``body``: the piece that each is one body with, (P,).

        `CapacityError` for too many convex parts, or corners of a side.
        """
        centre, bodies = _bodies(assembly, body)
        parts = [
            (number, each)
            for number, piece in enumerate(assembly.pieces)
            for each in convex_parts(piece)
        ]
        bounds = {name: [0] for name in ("vertices", "sides", "edges", "rims", "outlines")}
        corners: list[int] = []
        ends: list[Integers] = []
        for number, each in parts:
            if max(map(len, each.outlines)) > CORNERS:
                name = assembly.pieces[number].name
                raise CapacityError(f"in time: {name} has a side of more than {CORNERS} corners")
            start = bounds["vertices"][-1]
            for outline in each.outlines:
                corners += [start + vertex for vertex in outline]
                bounds["outlines"].append(len(corners))
            ends.append(each.edges + start)
            for name, count in (
                ("vertices", len(each.places)),
                ("sides", len(each.outlines)),
                ("edges", len(each.directions)),
                ("rims", len(each.edges)),
            ):
                bounds[name].append(bounds[name][-1] + count)
        of = {name: np.array(each, np.int64) for name, each in bounds.items()}
        solids = Solids(
            body[[number for number, _ in parts]],
            of["vertices"],
            of["sides"],
            of["outlines"],
            np.array(corners, np.int64),
            of["edges"],
            of["rims"],
            np.concatenate(ends),
            np.array([np.linalg.norm(np.ptp(each.places, axis=0)) for _, each in parts]),
        )
        centres = [centre[body[number]] for number, _ in parts]
        built = Places(
            np.concatenate([e.places - c for (_, e), c in zip(parts, centres, strict=True)]),
            np.concatenate([each.normals for _, each in parts]),
            np.concatenate([each.directions for _, each in parts]),
        )
        of_solids = np.array([number for number, _ in parts], np.int64)
        return cls(solids, built, bodies, centre, of_solids)

    @property
    def _owner(self) -> Integers:
        """The piece of each vertex, (V,)."""
        return np.repeat(self.solids.piece, np.diff(self.solids.vertices))

    @property
    def least(self) -> Floats:
        """The least width of each body between two planes along one of its sides, m, (P,).

        Infinite of pieces that are in the body of another.
        """
        sides = np.repeat(self.solids.piece, np.diff(self.solids.sides))
        built, owner = self.built, self._owner
        found = np.full(len(self.bodies.mass), np.inf)
        for number in np.unique(owner):
            along = built.vertices[owner == number] @ built.normals[sides == number].T
            found[number] = np.ptp(along, axis=0).min()
        return found

    def places(self, centre: Floats, turn: Floats) -> Floats:
        """Vertices where centroids are (m), (P, 3), after turns, (P, 3, 3); m, (V, 3)."""
        owner = self._owner
        return np.asarray(centre[owner] + np.einsum("kij,kj->ki", turn[owner], self.built.vertices))

    def pairs(self, places: Floats, near: float) -> Integers:
        """Pairs of solids of different pieces whose boxes are within ``near`` (m), (K, 2).

        ``places``: of vertices.
        """
        piece = self.solids.piece
        first = self.solids.vertices[:-1]
        low = np.minimum.reduceat(places, first) - 0.5 * near
        high = np.maximum.reduceat(places, first) + 0.5 * near
        found = meeting_boxes(low, high)
        one, other = piece[found].T
        free = self.bodies.mass > 0.0
        return np.ascontiguousarray(found[(one != other) & (free[one] | free[other])])


def _bodies(assembly: Assembly, body: Integers) -> tuple[Floats, Bodies]:
    """Centroids (m), (P, 3), and bodies; pieces that are in the body of another have no mass."""
    centre = np.array([piece.centre for piece in assembly.pieces])
    mass, tensor = np.zeros(len(body)), np.zeros((len(body), 3, 3))
    inverse = np.zeros_like(tensor)
    for number in np.unique(body).tolist():
        whole = assembly.pieces[number]
        if whole.fixed or not whole.mass:
            continue
        if (body == number).sum() > 1:
            pieces = (assembly.pieces[piece] for piece in np.flatnonzero(body == number))
            whole = Compound(whole.name, tuple(chain.from_iterable(map(solids_of, pieces))))
        centre[number], mass[number], tensor[number] = whole.centre, whole.mass, inertia_of(whole)
        inverse[number] = np.linalg.inv(tensor[number])
    return centre, Bodies(mass, tensor, inverse)
