"""Displacements of contact nodes by the deformation of an assembly's elastic pieces."""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Integers, NodeLayout
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.contact_nodes import cell_counts, cells_along
from sidmacib.mechanics.elastic.finite_elements import ElasticCuboid, Flexibility, Grid, Spread
from sidmacib.mechanics.loads import Loads

PLACE_DIGITS = 12  # of places, where shapes are compared


def flexibility(
    assembly: Assembly, loads: Loads, kept: Integers
) -> tuple[Floats, tuple[Floats, Floats], Floats]:
    """Displacements of the node components ``kept`` by the deformation of the pieces.

    Returns displacements against unit node forces, (K, K); displacements by permanent and by
    variable loads, (K,) each; and the displacement along the variable load by both, (2,).
    """
    faces, nodes = assembly.rectangles, assembly.nodes
    face = nodes.face[kept // 3]
    axes = (np.array([each.axis for each in faces])[face] + kept % 3) % 3
    below, above = np.array([(each.below, each.above) for each in faces])[face].T
    means = assembly.layout is NodeLayout.CENTRES
    quadratic = assembly.layout is not NodeLayout.VERTICES
    size = np.array([np.subtract(each.high, each.low) for each in faces])
    cells = (size / cell_counts(faces, assembly.mesh))[face]
    give, moved = np.zeros((len(kept), len(kept))), (np.zeros(len(kept)), np.zeros(len(kept)))
    work = np.zeros(2)
    for number, piece in enumerate(assembly.pieces):
        if piece.elastic is None or piece.fixed:
            continue
        seen = np.flatnonzero((below == number) | (above == number))
        sign = np.where(below[seen] == number, 1.0, -1.0)
        spreads, permanent = _spreads(loads, number)
        place = nodes.position[kept[seen] // 3] - piece.centre
        components = _Components(place, cells[seen] if means else None, axes[seen])
        shape = element_edges(assembly, number), piece.elastic.poisson, quadratic
        condensed = _condensed(*shape, components, spreads)
        young = piece.elastic.young
        give[np.ix_(seen, seen)] += condensed.contact * sign[:, None] * sign / young
        both = np.column_stack([permanent, ~permanent]).astype(float)
        for values, column in zip(moved, (condensed.by_load @ both).T, strict=True):
            values[seen] += sign * column / young
        work += (both.T @ condensed.load @ both)[1] / young
    return give, moved, work


def _spreads(loads: Loads, number: int) -> tuple[tuple[Spread, ...], Flags]:
    """The loads of a piece as fields on it, and which of them are permanent."""
    sides = [side for side in loads.sides if side.piece == number]
    spreads = [Spread(side.wrench, side.axis, side.high) for side in sides]
    flags = [side.permanent for side in sides]
    for permanent, whole in ((True, loads.permanent), (False, loads.variable)):
        rest = whole[number].astype(float)
        for side in sides:
            if side.permanent is permanent:
                rest = rest - side.wrench
        spreads.append(Spread(tuple(rest.tolist())))
        flags.append(permanent)
    return tuple(spreads), np.array(flags)


class _Components:
    """Components of contact nodes, hashable: equal for all pieces of the same shape."""

    def __init__(self, place: Floats, cell: Floats | None, axis: Integers) -> None:
        self.place, self.cell, self.axis = np.round(place, PLACE_DIGITS) + 0.0, cell, axis
        parts = (
            [self.place, axis] if cell is None else [self.place, axis, np.round(cell, PLACE_DIGITS)]
        )
        self.key = tuple(part.tobytes() for part in parts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Components) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)


@lru_cache(maxsize=32)
def _condensed(
    grid: Grid,
    poisson: float,
    quadratic: bool,
    components: _Components,
    loads: tuple[Spread, ...],
) -> Flexibility:
    """Flexibility of a piece, computed once for each shape, whatever its Young's modulus."""
    cuboid = _cuboid(grid, poisson, quadratic)
    rows = cuboid.values(components.place, components.cell)
    return cuboid.flexibility(cuboid.contact(rows, components.axis), loads)


@lru_cache(maxsize=2)  # pieces of one shape differ in their faces and loads
def _cuboid(grid: Grid, poisson: float, quadratic: bool) -> ElasticCuboid:
    return ElasticCuboid(grid, poisson, quadratic=quadratic)


def element_edges(assembly: Assembly, number: int) -> Grid:
    """Edges of the elements of a piece along x, y and z, from its centroid (m).

    Edges of its faces are element edges; between these, elements are no longer than the mesh.
    """
    piece = assembly.cuboids[number]
    faces = [face for face in assembly.rectangles if number in (face.below, face.above)]

    def edges(axis: int) -> tuple[float, ...]:
        ends = [end[axis] for face in faces for end in (face.low, face.high)]
        places = np.array([piece.low[axis], *ends, piece.high[axis]])
        places = np.unique(np.round(places - piece.centre[axis], PLACE_DIGITS))
        places = places[np.abs(places) <= piece.size[axis] / 2 + 10.0**-PLACE_DIGITS]
        counts = cells_along(np.diff(places), assembly.mesh)
        starts = [
            np.linspace(low, high, count + 1)[:-1]
            for (low, high), count in zip(pairwise(places), counts, strict=True)
        ]
        return (*np.concatenate(starts).tolist(), float(places[-1]))

    return edges(0), edges(1), edges(2)
