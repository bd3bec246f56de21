"""Blocks from surfaces as files have them: welded, closed, turned outwards, of plane faces."""

import math
from collections.abc import Callable, Iterator, Sequence
from fnmatch import fnmatchcase
from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import (
    FLAT,
    Block,
    area_vector,
    compact,
    fans,
    grouped,
    normal_of,
    off_plane,
    require_few_faces,
    vectors,
)
from sidmacib.validation import refused

MOST_NAMES = 8  # in a message
Face = tuple[int, ...]
Edge = tuple[int, int]
Surface = tuple[Floats, list[Face]]  # vertices, (V, 3), and faces: numbers of these
AS_IT_IS: Floats = np.eye(3)
SAME = 1e-7  # over the size of all bodies of a file: vertices no further apart are one
DEPTH = 0.1  # over its size: of a block in place of a flat support
FLATTEST = 0.99  # least cosine between the normals of its faces
MOST_CORNERS = 16  # of a folded face whose cuts are all tried
INSIDE = 0.5  # least part of all directions in which a surface is seen from a point inside it


def repaired(name: str, places: Floats, faces: Sequence[Sequence[int]], density: float) -> Block:
    """The block that closed ``faces`` bound, however a program has written them.

    ``places`` of vertices (m), (V, 3); ``faces``: numbers of their vertices; ``density`` in kg/m3.
    Vertices at one place are joined, and those that no face has left out; faces that are there
    twice count once; where a vertex lies on an edge, that is divided. Faces are turned outwards, or
    inwards where they close a cavity. Those in one plane become one. ValueError, which begins with
    ``name``, for what is not closed: with the place and a remedy.
    """
    places, faces = _welded(places, faces, FLAT)
    if not faces:
        raise ValueError(f"{name}: has no faces with an area")
    places, faces = compact(places, faces)  # as other bodies may have vertices, too
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    thick = [face for face in faces if _thickness(places[list(face)]) > FLAT * size]
    kept = _divided(_once(thick), places, FLAT * size)
    kept = [plane for face in kept for plane in planes(face, places, size)]
    kept = _outwards(name, kept, places)
    places, kept = compact(places, _in_planes(name, kept, places, size))
    return Block(name, vectors(places), tuple(kept), density)


def with_depth(places: Floats, faces: Sequence[Face]) -> Surface:
    """A surface with sides and a bottom, if it is open and flat: the ground is often one face.

    Arguments as of `repaired`; z is up. What is closed, or stands upright, stays as it is.
    """
    places, welded = _welded(places, faces, FLAT)
    once = _once(welded)
    border = [edge for edge, beside in _sides(once).items() if len(beside) == 1]
    size, count = float(np.linalg.norm(np.ptp(places, axis=0))), len(places)
    normals = np.array([normal_of(places[list(face)]) for face in once])
    flat = np.abs(normals @ normals[0]).min() > FLATTEST
    if not border or not flat or abs(normals[0, 2]) <= FLAT:
        return places, welded
    sides = [(one, other, other + count, one + count) for one, other in border]
    bottom = [tuple(vertex + count for vertex in face) for face in once]
    down = -np.sign(normals[0, 2]) * DEPTH * size * normals[0]
    return np.vstack([places, places + down]), [*once, *sides, *bottom]


def chosen(asked: Sequence[object], names: Sequence[str], allowed: str) -> set[str]:
    """Those of ``names`` that are ``asked`` for by name or by a pattern with `*`; ValueError.

    ``allowed``: begins what an error says is allowed.
    """
    held: set[str] = set()
    for each in map(str, asked):
        fit = [name for name in names if fnmatchcase(name, each)]
        if not fit:
            some = ", ".join(names[:MOST_NAMES]) + ", ..." * (len(names) > MOST_NAMES)
            raise refused("fixed", each, f"{allowed} {some}")
        held |= set(fit)
    return held


def bodies_in(places: Floats, faces: Sequence[Face]) -> tuple[Floats, list[list[Face]]]:
    """The vertices (m), (W, 3), and the faces of each body that ``faces`` bound, in their order.

    ``places`` of vertices (m), (V, 3). Faces that share vertices are of one body, if all bodies are
    closed so. Else vertices at one place are joined, and a body ends where all edges are in an even
    number of its faces, so that bodies which follow each other may touch; where that leads to no
    end, faces that share an edge with no third one are of one body. A surface inside a body is a
    cavity of it; one that is there twice counts once.
    """
    surfaces = _connected(faces)
    if not all(len(sides) == 2 for part in surfaces for sides in _sides(part).values()):
        places, faces = _welded(places, faces, SAME)
        surfaces = _in_order(faces) or _connected(_once(faces))
    once = {frozenset(map(frozenset, surface)): surface for surface in reversed(surfaces)}
    return places, _with_cavities(list(once.values())[::-1], places)


def _welded(
    places: Floats, faces: Sequence[Sequence[int]], near: float
) -> tuple[Floats, list[Face]]:
    """Vertices of which those at one place are one, and those faces that have an area.

    Vertices are at one place if no further apart than ``near`` over the size of all that faces
    have.
    """
    if not faces:
        return places, []
    used = places[sorted({vertex for face in faces for vertex in face})]
    size = float(np.linalg.norm(np.ptp(used, axis=0)))
    label = grouped(len(places), cKDTree(places).query_pairs(near * size, output_type="ndarray"))
    cleaned = (_without_repeats(label[[*face]].tolist()) for face in faces)
    kept = places[np.unique(label, return_index=True)[1]]
    return kept, [face for face in cleaned if len(set(face)) > 2]


def planes(face: Face, places: Floats, size: float) -> list[Face]:
    """The face itself if it is plane, otherwise parts of it that are, or triangles.

    It is cut where it is folded: by the diagonal that leaves the flattest parts, of equal ones the
    shortest, so that two blocks which share a warped face are cut alike.
    """
    if len(face) == 3 or off_plane(places[list(face)]) <= FLAT * size:
        return [face]
    whole = normal_of(places[list(face)])

    def bent(cut: tuple[Face, Face]) -> tuple[bool, int, float, tuple[float, ...]]:
        parts = [places[list(part)] for part in cut]
        outside = min(float(normal_of(part) @ whole) for part in parts) <= 0.0
        ends = sorted(places[[cut[0][0], cut[0][-1]]].tolist())
        length = round(math.dist(*ends) / size / FLAT) * FLAT
        off = max(map(off_plane, parts))
        return outside, math.ceil(off / size / FLAT - 1.0), length, tuple(ends[0])

    cuts = [
        (face[one : other + 1], (*face[other:], *face[: one + 1]))
        for one, other in combinations(range(len(face)), 2)
        if 1 < other - one < len(face) - 1
        and (len(face) <= MOST_CORNERS or other - one == len(face) // 2)
    ]
    return [plane for part in min(cuts, key=bent) for plane in planes(part, places, size)]


def _thickness(corners: Floats) -> float:
    """Twice the area of a face over its longest edge (m)."""
    longest = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).max()
    return float(np.linalg.norm(area_vector(corners)) / longest)


def _without_repeats(face: list[int]) -> Face:
    """A face without vertices that follow themselves, and without spikes."""
    length = 0
    while length != len(face):
        length = len(face)
        face = [v for k, v in enumerate(face) if v != face[k - 1] or len(face) == 1]
        spike = next((k for k in range(len(face)) if face[k - 2] == face[k]), None)
        if spike is not None and len(face) > 2:
            face = [v for k, v in enumerate(face) if k not in (spike, (spike - 1) % len(face))]
    return tuple(face)


def _once(faces: Sequence[Face]) -> list[Face]:
    """Faces without those that have the vertices of one before."""
    return list({frozenset(face): face for face in reversed(faces)}.values())[::-1]


def _edges(face: Face) -> Iterator[Edge]:
    return zip(face, (*face[1:], face[0]), strict=True)


def _sides(faces: Sequence[Face]) -> dict[Edge, list[tuple[int, bool]]]:
    """The faces at each edge, and whether they run from its lower to its higher vertex."""
    sides: dict[Edge, list[tuple[int, bool]]] = {}
    for number, face in enumerate(faces):
        for one, other in _edges(face):
            sides.setdefault((min(one, other), max(one, other)), []).append((number, one < other))
    return sides


def _divided(faces: list[Face], places: Floats, near: float) -> list[Face]:
    """Faces whose open edges are divided by the vertices of others that lie on them."""
    open_edges = [edge for edge, beside in _sides(faces).items() if len(beside) == 1]
    if not open_edges:
        return faces
    ends = np.unique(open_edges)
    between: dict[Edge, list[int]] = {}
    for low, high in open_edges:
        along = places[high] - places[low]
        length = float(np.linalg.norm(along))
        arms = places[ends] - places[low]
        at = arms @ along / length
        beside = np.linalg.norm(arms - np.outer(at, along / length), axis=1)
        on = (at > near) & (at < length - near) & (beside <= near)
        if on.any():
            between[low, high] = [int(v) for v in ends[on][np.argsort(at[on])]]
    divided = []
    for face in faces:
        whole: list[int] = []
        for one, other in _edges(face):
            more = between.get((min(one, other), max(one, other)), [])
            whole += [one, *(more if one < other else more[::-1])]
        divided.append(tuple(whole))
    return divided


def _connected(
    faces: Sequence[Face], fits: Callable[[Face, Face], bool] = lambda one, other: True
) -> list[list[Face]]:
    """Groups of ``faces``, in their order: linked by edges of two of them that ``fits`` takes."""
    both = [(beside[0][0], beside[1][0]) for beside in _sides(faces).values() if len(beside) == 2]
    pairs = [(one, other) for one, other in both if fits(faces[one], faces[other])]
    label = grouped(len(faces), np.array(pairs, int).reshape(-1, 2))
    groups: dict[int, list[Face]] = {}
    for number, face in zip(label.tolist(), faces, strict=True):
        groups.setdefault(number, []).append(face)
    return list(groups.values())


def _in_order(faces: Sequence[Face]) -> list[list[Face]]:
    """Closed surfaces that follow each other; none if that is not how ``faces`` are written."""
    found: list[list[Face]] = []
    surface: list[Face] = []
    once: set[Edge] = set()  # edges that an odd number of faces have
    for face in faces:
        surface.append(face)
        for one, other in _edges(face):
            once ^= {(min(one, other), max(one, other))}
        if not once:
            if len(_once(surface)) < 4:
                return []
            found.append(surface)
            surface = []
    return [] if surface else found


def _with_cavities(surfaces: list[list[Face]], places: Floats) -> list[list[Face]]:
    """Surfaces, those within an odd number of others as part of the smallest of these."""
    corners = [places[sorted({v for face in each for v in face})] for each in surfaces]
    low = np.array([each.min(axis=0) for each in corners])
    high = np.array([each.max(axis=0) for each in corners])
    bodies = {number: list(surface) for number, surface in enumerate(surfaces)}
    for number, around in enumerate(corners):
        boxes = (low < low[number]).all(axis=1) & (high > high[number]).all(axis=1)
        outside = [
            int(k)
            for k in np.flatnonzero(boxes)
            if all(_is_inside(point, surfaces[k], places) for point in around)
        ]
        if len(outside) % 2:
            smallest = min(outside, key=lambda k: float(np.prod(high[k] - low[k])))
            bodies[smallest] += bodies.pop(number)
    return list(bodies.values())


def _is_inside(point: Floats, faces: Sequence[Face], places: Floats) -> bool:
    """Whether a ``point`` (m) is in what closed ``faces`` bound, which may be turned either way."""
    one, two, three = np.moveaxis(places[fans(faces)] - point, 1, 0)  # van Oosterom and Strackee
    a, b, c = (np.linalg.norm(each, axis=1) for each in (one, two, three))
    volume = np.einsum("ij,ij->i", one, np.cross(two, three))
    dots = [np.einsum("ij,ij->i", x, y) for x, y in ((one, two), (two, three), (three, one))]
    angle = 2.0 * np.arctan2(volume, a * b * c + dots[0] * c + dots[1] * a + dots[2] * b)
    return bool(abs(angle.sum()) > 4.0 * np.pi * INSIDE)


def _outwards(name: str, faces: list[Face], places: Floats) -> list[Face]:
    """Closed faces with their vertices anticlockwise seen from outside; ValueError."""
    same: list[Edge] = []  # faces as they are have even numbers, turned ones odd numbers
    for (one, other), sides in _sides(faces).items():
        if len(sides) != 2:
            ends = [", ".join(f"{value:.6g}" for value in places[end]) for end in (one, other)]
            fault = (
                f"is of {len(sides)} faces: bodies that touch there must be objects of their own"
            )
            if len(sides) == 1:
                fault = "is of one face only: close the hole there"
            where = f"the edge between ({ends[0]}) and ({ends[1]})"
            raise ValueError(f"{name}: its faces must close a volume; {where} {fault}")
        (first, along), (second, back) = sides
        against = along == back
        same += [(2 * first, 2 * second + against), (2 * first + 1, 2 * second + 1 - against)]
    label = grouped(2 * len(faces), np.array(same, int).reshape(-1, 2)).reshape(-1, 2)
    _, start, of = np.unique(label.min(axis=1), return_index=True, return_inverse=True)
    turned = label[:, 0] != label[start[of], 0]
    parts = [np.flatnonzero(of == number).tolist() for number in range(len(start))]
    ordered = [face[::-1] if turned[k] else face for k, face in enumerate(faces)]
    for part in parts:
        others = [[ordered[k] for k in each] for each in parts if each is not part]
        point = places[ordered[part[0]][0]]
        hollow = sum(_is_inside(point, each, places) for each in others) % 2 == 1
        triangles = places[fans([ordered[k] for k in part])]
        volume = np.linalg.det(triangles - places[list(ordered[part[0]])].mean(axis=0)).sum()
        if (volume < 0.0) != hollow:
            for k in part:
                ordered[k] = ordered[k][::-1]
    return ordered


def _in_planes(name: str, faces: list[Face], places: Floats, size: float) -> list[Face]:
    """Faces of which those in one plane are one, without vertices on straight edges."""

    def in_one_plane(face: Face, beside: Face) -> bool:
        """Whether a face continues another; the plane is that of the larger."""
        one, other = (places[list(each)] for each in (face, beside))
        if np.ptp(one, axis=0).max() < np.ptp(other, axis=0).max():
            one, other = other, one
        normal = normal_of(one)
        away = np.abs((other - one.mean(axis=0)) @ normal).max()
        return float(normal @ normal_of(other)) > 0.0 and bool(away <= FLAT * size)

    groups = _connected(faces, in_one_plane)
    require_few_faces(name, len(groups))
    if len(groups) == len(faces):
        return faces
    joined = [face for group in groups for face in _outline(group, places, size)]
    return _without_straight(joined, places, size)


def _outline(faces: list[Face], places: Floats, size: float) -> list[Face]:
    """The outline of faces; these themselves if it has a hole or is not plane."""
    if len(faces) == 1:
        return faces
    edges = {edge for face in faces for edge in _edges(face)}
    border = [(a, b) for a, b in edges if (b, a) not in edges]
    onward, outline = dict(border), [min(a for a, _ in border or edges)]
    while len(outline) < len(border) and (after := onward[outline[-1]]) != outline[0]:
        outline.append(after)
    whole = len(outline) == len(border) == len(onward) and onward[outline[-1]] == outline[0]
    if whole and off_plane(places[outline]) <= FLAT * size:
        return [tuple(outline)]
    return faces


def _without_straight(faces: list[Face], places: Floats, size: float) -> list[Face]:
    """Faces without vertices on a straight edge of the only two faces that have them."""
    count = np.bincount([v for face in faces for v in face], minlength=len(places))
    straight: set[int] = set()
    for face in faces:
        around = zip((face[-1], *face[:-1]), face, (*face[1:], face[0]), strict=True)
        for before, vertex, after in around:
            if count[vertex] == 2:
                along = places[after] - places[before]
                away = np.cross(places[vertex] - places[before], along)
                if np.linalg.norm(away) <= FLAT * size * np.linalg.norm(along):
                    straight.add(vertex)
    shorter = [tuple(v for v in face if v not in straight) for face in faces]
    return shorter if all(len(face) > 2 for face in shorter) else faces
