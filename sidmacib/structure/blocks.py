"""Blocks: polyhedra given by vertices and faces, with mass, centroid and inertia of their shape.

Their surfaces may be closed and bound no body: where faces cross, or bodies are inside one another.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sidmacib.mechanics.assembly import CLOSE, Floats, Integers, Piece, Vector
from sidmacib.validation import LARGE, require_positive

FLAT = 1e-6  # over a block's size: how far a face's vertices may be from its plane
MOST_FACES = 5_000  # of a block: checking one of as many takes seconds
THROUGH = 0.01  # over it: how far faces may cross, as small folds of modelled blocks weigh little


@dataclass(frozen=True)
class Block(Piece):
    """A rigid polyhedron, convex or not.

    ``vertices`` in m; ``faces``: for each, numbers of its vertices, anticlockwise seen from
    outside; ``density`` in kg/m3. ValueError, which names the block, unless its faces are plane and
    close one volume.
    """

    name: str
    vertices: tuple[Vector, ...]
    faces: tuple[tuple[int, ...], ...]
    density: float
    fixed: bool = False
    material: str | None = None  # its name, by which laws of interfaces may be chosen

    def __post_init__(self) -> None:
        require_positive(**{f"{self.name}, density (kg/m3)": self.density})
        require_near(self.name, self.places)
        require_few_faces(self.name, len(self.faces))
        self._require_outlines()
        self._require_closed()
        for number, (corners, normal) in enumerate(zip(self.outlines, self.normals, strict=True)):
            if (apart := off_plane(corners)) > FLAT * self.size:
                raise ValueError(f"{self.name}, face {number}: must be plane (off by {apart:g} m)")
            flat = np.delete(corners, int(np.abs(normal).argmax()), axis=1)
            if not shapely.Polygon(flat).is_valid:
                raise ValueError(f"{self.name}, face {number}: its outline must not cross itself")
        if not self.volume > 0.0:
            raise ValueError(
                f"{self.name}: the vertices of each face must run anticlockwise seen from outside "
                f"(the volume would be {self.volume:g} m3)"
            )
        if self.reentrant is not None:  # surfaces of convex blocks cross nowhere
            self._require_body()

    def _require_outlines(self) -> None:
        """At least three vertices a face, all of them there, none twice."""
        for number, face in enumerate(self.faces):
            if len(face) < 3 or len(set(face)) < len(face):
                raise ValueError(f"{self.name}, face {number}: must have 3 or more vertices")
            if not all(0 <= vertex < len(self.vertices) for vertex in face):
                last = len(self.vertices) - 1
                raise ValueError(f"{self.name}, face {number}: vertices must be from 0 to {last}")
        for vertex in set(range(len(self.vertices))).difference(*self.faces):
            raise ValueError(f"{self.name}: vertex {vertex} must belong to a face")
        near = np.round(self.places / (CLOSE * self.size))
        if len(np.unique(near, axis=0)) < len(near):
            raise ValueError(f"{self.name}: no two vertices may be at the same place")

    def _require_closed(self) -> None:
        """Each edge as often in one direction as in the other: more than once if bodies pinch."""
        edges = Counter(edge for f in self.faces for edge in zip(f, (*f[1:], f[0]), strict=True))
        twice = len({*map(frozenset, self.faces)}) < len(self.faces)
        if twice or any(edges[other, one] != count for (one, other), count in edges.items()):
            raise ValueError(f"{self.name}: its faces must close a volume, each edge between two")

    def _require_body(self) -> None:
        """One body, with faces that do not cross: volume and mass would be wrong."""
        if pair := crossing(self.places, self.faces, self.normals, THROUGH * self.size):
            one, other = sorted(pair)
            raise ValueError(f"{self.name}: faces {one} and {other} must not cross each other")
        if (count := bodies(self.places, self.faces)) != 1:
            raise ValueError(f"{self.name}: must be one body (its faces close {count} volumes)")

    @cached_property
    def places(self) -> Floats:
        """The vertices in m, (V, 3)."""
        return np.array(self.vertices, float).reshape(-1, 3)

    @cached_property
    def outlines(self) -> tuple[Floats, ...]:
        """The vertices of each face, (K, 3) each."""
        return tuple(self.places[list(face)] for face in self.faces)

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around it, in m."""
        return float(np.linalg.norm(np.ptp(self.places, axis=0)))

    @cached_property
    def normals(self) -> Floats:
        """Unit normals of the faces, outwards, (F, 3)."""
        return np.array([normal_of(corners) for corners in self.outlines])

    @cached_property
    def reentrant(self) -> int | None:
        """A face that a vertex is in front of; None if the block is convex."""
        for number, (corners, normal) in enumerate(zip(self.outlines, self.normals, strict=True)):
            if float(((self.places - corners.mean(axis=0)) @ normal).max()) > FLAT * self.size:
                return number
        return None

    @cached_property
    def _solid(self) -> trimesh.triangles.MassProperties:
        middle = self.places.mean(axis=0)  # about which less is lost to rounding
        return trimesh.triangles.mass_properties((self.places - middle)[fans(self.faces)])

    @property
    def volume(self) -> float:
        """In m3."""
        return float(self._solid.volume)

    @property
    def mass(self) -> float:
        """In kg."""
        return self.density * self.volume

    @property
    def centre(self) -> Floats:
        """Centroid, in m, shape (3,)."""
        return np.asarray(self._solid.center_mass + self.places.mean(axis=0))

    @property
    def inertia_tensor(self) -> Floats:
        """About the centroid, in kg m2, shape (3, 3)."""
        return np.asarray(self.density * self._solid.inertia)

    @property
    def inertia(self) -> Floats:
        """Principal moments of inertia about the centroid, in kg m2, shape (3,)."""
        return np.asarray(np.linalg.eigvalsh(self.inertia_tensor))


@dataclass(frozen=True)
class Compound(Piece):
    """A piece of several solids that touch and move as one; see `Block`."""

    name: str
    solids: tuple[Block, ...]
    fixed: bool = False

    @property
    def volume(self) -> float:
        """In m3."""
        return math.fsum(solid.volume for solid in self.solids)

    @property
    def mass(self) -> float:
        """In kg."""
        return math.fsum(solid.mass for solid in self.solids)

    @cached_property
    def centre(self) -> Floats:
        """Centroid, in m, shape (3,)."""
        return np.asarray(sum(solid.mass * solid.centre for solid in self.solids) / self.mass)

    @property
    def inertia_tensor(self) -> Floats:
        """About the centroid, in kg m2, shape (3, 3)."""
        tensor = np.zeros((3, 3))
        for solid in self.solids:  # Huygens and Steiner
            arm = solid.centre - self.centre
            tensor += solid.inertia_tensor
            tensor += solid.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return tensor

    @property
    def inertia(self) -> Floats:
        """Principal moments of inertia about the centroid, in kg m2, shape (3,)."""
        return np.asarray(np.linalg.eigvalsh(self.inertia_tensor))

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around it, in m."""
        places = np.concatenate([solid.places for solid in self.solids])
        return float(np.linalg.norm(np.ptp(places, axis=0)))


def require_few_faces(name: str, count: int) -> None:
    """ValueError, which begins with ``name``, for more faces than `MOST_FACES`."""
    if count > MOST_FACES:
        raise ValueError(f"{name}: has {count} plane faces; at most {MOST_FACES} are allowed")


def require_near(name: str, places: Floats) -> None:
    """ValueError, which begins with ``name``, for coordinates (m) beyond `LARGE`, or not finite."""
    if not (np.abs(places) <= LARGE).all():
        raise ValueError(f"{name}: all coordinates must be finite, and at most {LARGE:g} m")


def vectors(places: Floats) -> tuple[Vector, ...]:
    """Points, (K, 3), as plain numbers."""
    return tuple((x, y, z) for x, y, z in places.tolist())


def compact(places: Floats, faces: Sequence[Sequence[int]]) -> tuple[Floats, list[tuple[int, ...]]]:
    """The vertices, (V, 3), that faces have, and the faces with their new numbers."""
    used = sorted({vertex for face in faces for vertex in face})
    number = {vertex: new for new, vertex in enumerate(used)}
    return places[used], [tuple(number[vertex] for vertex in face) for face in faces]


_YZX, _ZXY = (1, 2, 0), (2, 0, 1)


def area_vector(corners: Floats) -> Floats:
    """Twice the area of an outline, (K, 3), along its normal (Newell), (3,)."""
    after = np.concatenate((corners[1:], corners[:1]))
    # Components of a cross product: on a few corners `numpy.cross` takes four times as long.
    yzx, zxy = ((each.take(_YZX, 1), each.take(_ZXY, 1)) for each in (corners, after))
    return np.asarray((yzx[0] * zxy[1] - yzx[1] * zxy[0]).sum(axis=0))


def normal_of(corners: Floats) -> Floats:
    """Unit normal of a plane outline, (K, 3), anticlockwise about it, (3,); 0 of none."""
    around = area_vector(corners)
    length = np.linalg.norm(around)
    return np.asarray(around / length) if length > 0.0 else np.zeros(3)


def off_plane(corners: Floats) -> float:
    """Largest distance (m) of an outline's corners, (K, 3), from the plane that fits it."""
    return float(np.abs((corners - corners.mean(axis=0)) @ normal_of(corners)).max())


def prism(
    name: str, base: Sequence[Vector], along: Vector, density: float, *, fixed: bool = False
) -> Block:
    """The block that a plane outline ``base``, (K, 3) in m, sweeps when moved by ``along`` (m)."""
    low = np.array(base, float)
    require_near(name, np.array([*low, along]))
    if normal_of(low) @ np.array(along) > 0.0:
        low = low[::-1]  # so that the outline is seen anticlockwise from outside
    count = len(low)
    sides = [(k, (k - 1) % count, (k - 1) % count + count, k + count) for k in range(count)]
    faces = (tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1)), *sides)
    return Block(name, vectors(np.array([*low, *(low + along)])), faces, density, fixed)


def box(name: str, low: Vector, high: Vector, density: float, *, fixed: bool = False) -> Block:
    """The cuboid between two opposite corners, in m; ValueError unless it has a volume."""
    if any(one == other for one, other in zip(low, high, strict=True)):
        raise ValueError(f"{name}: high {list(high)} and low {list(low)} must differ on each axis")
    (x, y, z), (to_x, to_y, to_z) = low, high
    base = [(x, y, z), (to_x, y, z), (to_x, to_y, z), (x, to_y, z)]
    return prism(name, base, (0.0, 0.0, to_z - z), density, fixed=fixed)


def solids_of(piece: Piece) -> tuple[Block, ...]:
    """The blocks that a piece consists of; none of a cuboid."""
    if isinstance(piece, Compound):
        return piece.solids
    return (piece,) if isinstance(piece, Block) else ()


def crossing(
    places: Floats, faces: Sequence[Sequence[int]], normals: Floats, near: float
) -> tuple[int, int] | None:
    """Numbers of two faces of which one has an edge that pierces the other; None without any.

    ``places`` of vertices (m), (V, 3); ``faces``: numbers of their vertices; ``normals``: unit
    ones, (F, 3). What reaches through by ``near`` (m) or less does not count.
    """
    edges = np.array(
        [
            (number, *edge)
            for number, face in enumerate(faces)
            for edge in zip(face, (*face[1:], face[0]), strict=True)
            if edge[0] < edge[1]  # each edge is in two faces, once in either direction
        ]
    )
    for number, face in enumerate(faces):
        corners, normal = places[list(face)], normals[number]
        heights = (places - corners[0]) @ normal
        one, other = heights[edges[:, 1]], heights[edges[:, 2]]
        through = edges[(np.minimum(one, other) < -near) & (np.maximum(one, other) > near)]
        if not len(through):
            continue
        low, high = (heights[through[:, end]][:, None] for end in (1, 2))
        points = (places[through[:, 1]] * high - places[through[:, 2]] * low) / (high - low)
        kept = np.delete(np.arange(3), int(np.abs(normal).argmax()))
        outline, points = shapely.Polygon(corners[:, kept]), shapely.points(points[:, kept])
        inside = shapely.contains(outline, points)
        inside &= shapely.distance(outline.exterior, points) > near
        if inside.any():
            return int(through[inside][0, 0]), number
    return None


def bodies(places: Floats, faces: Sequence[Sequence[int]]) -> int:
    """Number of bodies that closed ``faces`` bound: parts of the surface that share no vertex.

    A part that is seen from inside bounds a cavity, not a body.
    """
    vertex_links = np.array([(face[0], v) for face in faces for v in face[1:]])
    part_of = grouped(len(places), vertex_links)
    triangles = fans(faces)
    volume = np.linalg.det((places - places.mean(axis=0))[triangles]) / 6.0
    return int((np.bincount(part_of[triangles[:, 0]], volume) > 0.0).sum())


def fans(faces: Sequence[Sequence[int]]) -> Integers:
    """Triangles about the first vertex of each face, by the numbers of their vertices, (T, 3).

    Of a face with a reentrant corner some run the other way round, so that sums over all are right.
    """
    return np.array([(f[0], one, other) for f in faces for one, other in pairwise(f[1:])])


def grouped(count: int, pairs: Integers) -> Integers:
    """The group, from 0, of each of ``count`` things that ``pairs``, (K, 2), connect; (count,)."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)
