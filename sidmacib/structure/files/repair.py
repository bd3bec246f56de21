"""Blocks from surfaces as files have them: welded, closed, turned outwards, of plane faces."""

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, pairwise

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
from sidmacib.structure.interfaces import tangents

Face = tuple[int, ...]
Edge = tuple[int, int]
Surface = tuple[Floats, list[Face]]  # vertices, (V, 3), and faces: numbers of these
AS_IT_IS: Floats = np.eye(3)
DEPTH = 0.1  # over its size: of a block in place of a flat support
FLATTEST = 0.99  # least cosine between the normals of its faces
MOST_CORNERS = 16  # of a folded face whose cuts are all tried
INSIDE = 0.5  # least part of all directions in which a surface is seen from a point inside it


def repaired(
    name: str,
    places: Floats,
    faces: Sequence[Sequence[int]],
    density: float,
    *,
    fixed: bool = False,
    material: str | None = None,
) -> Block:
    """The block that closed ``faces`` bound, however a program has written them.

    ``places`` of vertices (m), (V, 3); ``faces``: numbers of their vertices; else as `Block`.
    Vertices at one place are joined, and those that no face has left out; faces that are there
    twice count once; where a vertex lies on an edge, that is divided. Faces are turned outwards, or
    inwards where they close a cavity. Those in one plane become one. ValueError, which begins with
    ``name``, for what is not closed: with the place and a remedy.
    """
    places, faces = welded(places, faces, FLAT)
    if not faces:
        raise ValueError(f"{name}: has no faces with an area")
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    thick = [face for face in faces if _thickness(places[list(face)]) > FLAT * size]
    kept = _divided(once_each(thick), places, FLAT * size)
    kept = [plane for face in kept for plane in planes(face, places, size)]
    kept = _outwards(name, kept, places)
    places, kept = compact(places, _in_planes(name, kept, places, size))
    return Block(name, vectors(places), tuple(kept), density, fixed, material)


def with_depth(places: Floats, faces: Sequence[Face]) -> Surface:
    """A surface with sides and a bottom, if it is open and flat: the ground is often one face.

    Arguments as of `repaired`; z is up. What is closed, or stands upright, stays as it is.
    """
    places, joined = welded(places, faces, FLAT)
    once = once_each(joined)
    border = open_edges(once)
    size, count = float(np.linalg.norm(np.ptp(places, axis=0))), len(places)
    normal = normal_of(places[list(once[0])]) if once else np.zeros(3)
    if not border or abs(normal[2]) <= FLAT or not _is_flat(once, places):
        return places, joined
    sides = [(one, other, other + count, one + count) for one, other in border]
    bottom = [tuple(vertex + count for vertex in face) for face in once]
    down = -np.sign(normal[2]) * DEPTH * size * normal
    return np.vstack([places, places + down]), [*once, *sides, *bottom]


def _is_flat(faces: Sequence[Face], places: Floats) -> bool:
    normals = np.array([normal_of(places[list(face)]) for face in faces])
    return bool(np.abs(normals @ normals[0]).min() > FLATTEST)


def welded(
    places: Floats, faces: Sequence[Sequence[int]], near: float
) -> tuple[Floats, list[Face]]:
    """Vertices of which those at one place are one, and those faces that have an area.

    Vertices are at one place if no further apart than ``near`` over the size of all that faces
    have.
    """
    if not faces:
        return places, []
    places, faces = compact(places, faces)  # as other bodies may have vertices, too
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    near_ones = cKDTree(places).query_pairs(near * size, output_type="ndarray")
    label = grouped(len(places), near_ones) if len(near_ones) else np.arange(len(places))
    cleaned = (_without_repeats(label[[*face]].tolist()) for face in faces)
    kept = [face for face in cleaned if len(set(face)) > 2]
    return places[np.unique(label, return_index=True)[1]], kept


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
    kept = [v for k, v in enumerate(face) if v != face[k - 1]]
    spike = next((k for k in range(len(kept)) if kept[k - 2] == kept[k]), None)
    if len(kept) < 3 or spike is None:
        return tuple(kept)
    return _without_repeats(
        [v for k, v in enumerate(kept) if k not in (spike, (spike - 1) % len(kept))]
    )


def once_each(faces: Sequence[Face]) -> list[Face]:
    """Faces without those that have the vertices of one before."""
    return list({frozenset(face): face for face in reversed(faces)}.values())[::-1]


def edges_of(face: Face) -> Iterator[Edge]:
    """The edges of a face, in its direction."""
    return zip(face, (*face[1:], face[0]), strict=True)


def sides_of(faces: Sequence[Face]) -> dict[Edge, list[tuple[int, bool]]]:
    """The faces at each edge, and whether they run from its lower to its higher vertex."""
    sides: dict[Edge, list[tuple[int, bool]]] = {}
    for number, face in enumerate(faces):
        for one, other in edges_of(face):
            sides.setdefault((min(one, other), max(one, other)), []).append((number, one < other))
    return sides


def open_edges(faces: Sequence[Face]) -> list[Edge]:
    """The edges that one face only has."""
    return [edge for edge, beside in sides_of(faces).items() if len(beside) == 1]


def _divided(faces: list[Face], places: Floats, near: float) -> list[Face]:
    """Faces whose open edges are divided by the vertices of others that lie on them."""
    border = open_edges(faces)
    if not border:
        return faces
    ends = np.unique(border)
    between: dict[Edge, list[int]] = {}
    for low, high in border:
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
        for one, other in edges_of(face):
            more = between.get((min(one, other), max(one, other)), [])
            whole += [one, *(more if one < other else more[::-1])]
        divided.append(tuple(whole))
    return divided


def connected(
    faces: Sequence[Face], fits: Callable[[Face, Face], bool] = lambda one, other: True
) -> list[list[Face]]:
    """Groups of ``faces``, in their order: linked by edges of two of them that ``fits`` takes."""
    both = [(beside[0][0], beside[1][0]) for beside in sides_of(faces).values() if len(beside) == 2]
    pairs = [(one, other) for one, other in both if fits(faces[one], faces[other])]
    label = grouped(len(faces), np.array(pairs, int).reshape(-1, 2))
    groups: dict[int, list[Face]] = {}
    for number, face in zip(label.tolist(), faces, strict=True):
        groups.setdefault(number, []).append(face)
    return list(groups.values())


def is_inside(point: Floats, faces: Sequence[Face], places: Floats) -> bool:
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
    for (one, other), sides in sides_of(faces).items():
        if len(sides) % 2:
            ends = [", ".join(f"{value:.6g}" for value in places[end]) for end in (one, other)]
            fault = f"is of {len(sides)} faces: bodies there must be objects of their own"
            if len(sides) == 1:
                fault = "is of one face only: close the hole there"
                if _is_flat(faces, places):
                    fault = "is of one face only: only a block that cannot move may be flat"
            where = f"the edge between ({ends[0]}) and ({ends[1]})"
            raise ValueError(f"{name}: its faces must close a volume; {where} {fault}")
        # Where a body touches itself, neighbours about the edge bound the body or a gap.
        around = sides if len(sides) == 2 else _around((one, other), sides, faces, places)
        for (first, along), (second, back) in pairwise(around):
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
        hollow = sum(is_inside(point, each, places) for each in others) % 2 == 1
        triangles = places[fans([ordered[k] for k in part])]
        volume = np.linalg.det(triangles - point).sum()
        if (volume < 0.0) != hollow:
            for k in part:
                ordered[k] = ordered[k][::-1]
    return ordered


def _around(
    edge: Edge, sides: Sequence[tuple[int, bool]], faces: Sequence[Face], places: Floats
) -> list[tuple[int, bool]]:
    """The ``sides`` of an ``edge`` in the order of their faces about it."""
    along = places[edge[1]] - places[edge[0]]
    axes = np.array(tangents(along / np.linalg.norm(along)))

    def angle(side: tuple[int, bool]) -> float:
        number, forwards = side
        inwards = np.cross(normal_of(places[list(faces[number])]), along if forwards else -along)
        x, y = axes @ inwards
        return math.atan2(y, x)

    return sorted(sides, key=angle)


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

    groups = connected(faces, in_one_plane)
    require_few_faces(name, len(groups))
    if len(groups) == len(faces):
        return faces
    joined = [face for group in groups for face in _outline(group, places, size)]
    return _without_straight(joined, places, size)


def _outline(faces: list[Face], places: Floats, size: float) -> list[Face]:
    """The outline of faces; these themselves if it has a hole or is not plane."""
    if len(faces) == 1:
        return faces
    edges = {edge for face in faces for edge in edges_of(face)}
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
