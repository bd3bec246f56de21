"""Blocks and interfaces as points, triangles and edges, for a page that draws them."""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from sidmacib.build import Solid, solids
from sidmacib.build.views import edge_vertices
from sidmacib.mechanics.assembly import Assembly, Floats, Piece
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import solids_of
from sidmacib.structure.files.structure_file import blocks_and_rows
from sidmacib.structure.interfaces import tangents, triangles
from sidmacib.structure.structure import owners_of

DIGITS = 6  # of coordinates


def shape_of(assembly: Assembly, made: Sequence[Solid] = ()) -> dict[str, Any]:
    """The blocks and interfaces of ``assembly`` as plain values, coordinates in m.

    ``made``: solids that are drawn in place of the blocks of their names.

    Each has its name, ``points``, ``triangles`` and ``edges``, closed lines, as numbers of points.
    A block has ``fixed``, and the number of the block that it is a lock of, or its own, ``with``;
    an interface its ``middle`` and the numbers of the blocks, ``between``.
    """
    owners = owners_of(assembly)
    by_name = {solid.name: solid for solid in made}
    return {
        "blocks": [
            {
                "name": piece.name,
                "fixed": piece.fixed,
                "with": owners[number],
                **(_made(by_name[piece.name]) if piece.name in by_name else _solid(piece)),
            }
            for number, piece in enumerate(assembly.pieces)
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
    }


def points_of(shape: dict[str, Any]) -> int:
    """Number of points of a shape."""
    return sum(len(each["points"]) for part in ("blocks", "interfaces") for each in shape[part])


def with_condensed_locks(description: Any, folder: Path) -> list[Solid]:
    """The blocks of a ``description`` with those of their locks that the model condenses.

    ``folder``: that paths of meshes start from. Without the blocks that locks are cut out of as
    well, and without any where the locks cannot be made.
    """
    blocks, rows, near = blocks_and_rows(description, folder)
    condensed = {pair: row for pair, row in rows.items() if row.locks.condensed}
    cut = {name for pair in rows.keys() - condensed.keys() for name in pair}
    names = {name for pair in condensed for name in pair} - cut
    if not names:
        return []
    try:
        made = solids(blocks, condensed, near=near)
    except ValueError:
        return []
    return [each for each in made if each.name in names]


def _made(solid: Solid) -> dict[str, Any]:
    return {
        "points": [_rounded(place) for place in solid.places],
        "triangles": solid.triangles.tolist(),
        "edges": edge_vertices(solid).tolist(),
    }


def _solid(piece: Piece) -> dict[str, Any]:
    """The faces of the solids of a piece."""
    points: list[list[float]] = []
    filled, edges = [], []
    for solid in solids_of(piece):
        for face, corners, normal in zip(solid.faces, solid.outlines, solid.normals, strict=True):
            own = [len(points) + vertex for vertex in face]
            flat = corners @ np.array(tangents(normal)).T
            filled += [[own[k] for k in each] for each in triangles(shapely.Polygon(flat), flat)]
            edges.append(own)
        points += map(_rounded, solid.places)
    return {"points": points, "triangles": filled, "edges": edges}


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


def _rounded(values: Floats) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
