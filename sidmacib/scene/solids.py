"""Blocks and interfaces as points, triangles and edges, for a page that draws them."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import shapely

from sidmacib.mechanics.assembly import Assembly, Floats, Integers, Piece
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import normal_of, solids_of
from sidmacib.structure.interfaces import tangents

DIGITS = 6  # of coordinates
CLOSE = 1e-9  # over the size of an outline: points nearer than that are one


def shape_of(assembly: Assembly) -> dict[str, Any]:
    """The blocks and interfaces of ``assembly`` as plain values, coordinates in m.

    Each has its name, ``points``, ``triangles`` and ``edges``, closed lines, as numbers of points.
    A block has ``fixed``, an interface its ``middle`` and the numbers of the blocks, ``between``.
    ``chains``: see `chains`.
    """
    return {
        "blocks": [
            {"name": piece.name, "fixed": piece.fixed, **_solid(outlines(piece))}
            for piece in assembly.pieces
        ],
        "interfaces": [
            {
                "name": face.name,
                "between": [face.below, face.above],
                "middle": _rounded(np.array(face.middle)),
                **_region(face),
            }
            for face in assembly.faces
            if isinstance(face, Polygon)
        ],
        "chains": chains(assembly),
    }


def chains(assembly: Assembly) -> list[list[int]]:
    """Numbers of the interfaces along each row of free blocks, from support to support.

    As of an arch or a stack, which have a line of thrust. None if a block has more than two
    interfaces.
    """
    ends = [(face.below, face.above) for face in assembly.faces]
    free = {number for number, piece in enumerate(assembly.pieces) if not piece.fixed}
    of_block = {number: [k for k, pair in enumerate(ends) if number in pair] for number in free}
    if any(len(own) > 2 for own in of_block.values()):
        return []
    found, left = [], {k for k, pair in enumerate(ends) if not free.isdisjoint(pair)}
    for start in sorted(left):
        if start not in left or free.issuperset(ends[start]):
            continue  # begin at a support
        row, here = [start], start
        left.remove(start)
        while ahead := left.intersection(
            k for number in free.intersection(ends[here]) for k in of_block[number]
        ):
            here = ahead.pop()
            left.remove(here)
            row.append(here)
        found.append(row)
    return found


def outlines(piece: Piece) -> list[Floats]:
    """The faces of a piece, (K, 3) in m each."""
    return [outline for solid in solids_of(piece) for outline in solid.outlines]


def points_of(shape: dict[str, Any]) -> int:
    """Number of points of a shape."""
    return sum(len(each["points"]) for part in ("blocks", "interfaces") for each in shape[part])


def triangles(region: shapely.Polygon, corners: Floats) -> Iterator[list[int]]:
    """Triangles that fill a plane ``region``, as numbers of its ``corners``, (K, 2)."""
    near = CLOSE * float(np.ptp(corners, axis=0).max())
    for part in shapely.get_parts(shapely.constrained_delaunay_triangles(region)):
        places = shapely.get_coordinates(part)[:3]
        apart = np.abs(corners[None, :, :] - places[:, None, :]).max(axis=2)
        numbers = apart.argmin(axis=1).tolist()
        assert float(apart.min(axis=1).max()) <= near
        yield numbers


def _solid(faces: Sequence[Floats]) -> dict[str, Any]:
    """The faces of a block, each the corners (m) of an outline, (K, 3)."""
    corners = np.concatenate(faces)
    points, index = _merged(corners)
    filled, edges, first = [], [], 0
    for face in faces:
        own = index[first : first + len(face)].tolist()
        first += len(face)
        flat = face @ np.array(tangents(normal_of(face))).T
        filled += [[own[k] for k in each] for each in triangles(shapely.Polygon(flat), flat)]
        edges.append(own)
    return {"points": [_rounded(p) for p in points], "triangles": filled, "edges": edges}


def _region(face: Polygon) -> dict[str, Any]:
    """The outline of an interface, with holes if it has some."""
    rings = [
        shapely.get_coordinates(ring)[:-1]
        for ring in (face.outline.exterior, *face.outline.interiors)
    ]
    flat = np.concatenate(rings)
    ends = np.cumsum([0, *map(len, rings)]).tolist()
    return {
        "points": [_rounded(point) for point in face.at(flat)],
        "triangles": [*triangles(face.outline, flat)],
        "edges": [[*range(one, other)] for one, other in pairwise(ends)],
    }


def _merged(corners: Floats) -> tuple[Floats, Integers]:
    """Points without those that stand twice, (N, 3), and the number of each of ``corners``."""
    size = float(np.ptp(corners, axis=0).max())
    _, first, index = np.unique(
        np.round(corners / (CLOSE * size)), axis=0, return_index=True, return_inverse=True
    )
    return corners[first], index.ravel()


def _rounded(values: Floats) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
