"""Vertices and flat sides of the pieces that meet at a face, from the geometry."""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sidmacib.mechanics.assembly import Assembly, Cuboid, Face, Floats, Piece
from sidmacib.mechanics.polygons import hull_sides

PARALLEL = 1e-12  # one less the cosine of the angle between what is parallel
AT = 1e-3  # over the assembly's length: interfaces may lie as far from the blocks' faces


def vertices_above(assembly: Assembly) -> NDArray[np.bool_]:
    """Whether the piece above a node brings the vertex, of each node, (N,).

    A node at a corner of one of its two pieces only is a vertex of that one on the flat side of the
    other. At any other node, at corners of both, where two edges cross or inside a face, the flat
    side is that of a fixed piece, or of the one above where neither is fixed.
    """
    faces, nodes = assembly.faces, assembly.nodes
    below, above = np.array([(face.below, face.above) for face in faces]).T[:, nodes.face]
    at_corner = np.zeros((2, len(nodes.face)), bool)
    for index, piece in enumerate(assembly.pieces):
        corners = _corners(piece)
        for side, pieces in enumerate((below, above)):
            mine = pieces == index
            apart = np.linalg.norm(nodes.position[mine, None] - corners, axis=2)
            at_corner[side, mine] = apart.min(axis=1) <= AT * assembly.length
    fixed_below = np.array([piece.fixed for piece in assembly.pieces])[below]
    return np.where(at_corner[0] != at_corner[1], at_corner[1], fixed_below)


def sides(assembly: Assembly, face: Face) -> dict[str, list[list[float]]]:
    """Edges of the sides of both pieces in the plane of ``face``, as `GivenFace` has them.

    Of their convex hulls; those of the face itself where a piece has no side in its plane.
    """
    ends = {"edges_below": face.below, "edges_above": face.above}
    near = AT * assembly.length
    return {name: _edges(_corners(assembly.pieces[k]), face, near) for name, k in ends.items()}


def _edges(corners: Floats, face: Face, near: float) -> list[list[float]]:
    """Edges of the convex hull of those ``corners``, (K, 3), that are ``near`` (m) the plane."""
    found = corners[np.abs((corners - face.middle) @ face.axes[0]) <= near]
    if len(found) < 3 or np.linalg.matrix_rank(found[1:] - found[0], tol=near) < 2:
        found = face.corners
    outward, reach = hull_sides((found - face.middle) @ face.axes[1:].T)
    across = outward @ face.axes[1:]
    return np.column_stack([across, across @ face.middle + reach]).tolist()


def convex_solids(piece: Piece) -> list[list[list[list[float]]]]:
    """Convex parts of a piece, as `GivenSolid` has them; those that are not convex are left out."""
    if isinstance(piece, Cuboid):
        axes = np.eye(3).tolist()
        return [[_corners(piece).tolist(), axes, axes]]
    return [
        [solid.places.tolist(), _different(solid.normals), _different(_edges_of(solid))]
        for solid in _solids(piece)
        if solid.reentrant is None
    ]


def _edges_of(solid: Any) -> Floats:
    """Edges of a block from corner to corner, (K, 3), as unit vectors."""
    edges = np.concatenate([np.roll(each, -1, axis=0) - each for each in solid.outlines])
    return np.asarray(edges / np.linalg.norm(edges, axis=1)[:, None])


def _different(ways: Floats) -> list[list[float]]:
    """Those of unit vectors, (K, 3), that are not parallel to another."""
    found: list[Floats] = []
    for way in ways:
        if all(abs(way @ other) < 1.0 - PARALLEL for other in found):
            found.append(way)
    return np.array(found).tolist()


def _corners(piece: Piece) -> Floats:
    """Corners of a piece in m, (K, 3)."""
    if isinstance(piece, Cuboid):
        return np.array(list(product(*zip(piece.low, piece.high, strict=True))))
    return np.concatenate([solid.places for solid in _solids(piece)])


def _solids(piece: Piece) -> Sequence[Any]:
    """Blocks that a piece consists of: several of a compound."""
    solids: Sequence[Any] = getattr(piece, "solids", (piece,))
    return solids
