"""Surfaces that are closed but bound no body: faces that cross, and bodies inside one another."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sidmacib.mechanics.assembly import Floats, Integers


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
