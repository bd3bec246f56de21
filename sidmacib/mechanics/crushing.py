"""What the pressed part of a face carries, where its blocks have a compressive strength.

Normal force N and moments M of a face are admissible if some stress between 0 and the strength f_c
has them. Stress blocks have: f_c on the part of the face beyond a line, nothing elsewhere. Their
convex hull is a polyhedron inside the exact, convex set of (N, M), so that what it admits is
carried. The lines are across the normals of the sides of the face and three directions between
each two. Where a face of depth h and width b is pressed at the eccentricity e, the exact limit is

    N  =  f_c b (h - 2 e),

of which the polyhedron has 98.5 to 100 %, up to e = 0.499 h; less where it is pressed askew. This
is the rectangular stress block of limit analysis of masonry arches, in both directions of the face
(Gilbert, Limit analysis applied to masonry arch bridges: state-of-the-art and recent developments,
ARCH'07, Madeira, 2007).
"""

import importlib
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Annotated

import numpy as np
import shapely

from sidmacib.mechanics.assembly import Assembly, Face, FaceMaterial, Floats, Integers, Kind
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Number
from sidmacib.validation import require_kinds

# Directions of stress blocks, from the normal of a side to that of the next; the factor from a
# depth to the next, and the number of depths.
WAYS = (
    (0.0, 2.0 ** (1 / 3), 27),
    (0.12, 2.0 ** (1 / 2), 10),
    (0.5, 2.0 ** (1 / 3), 14),
    (0.88, 2.0 ** (1 / 2), 10),
)
REACH = 3.0  # over the sides of a face: beyond all of it
FLAT = 1e-9  # of planes of the hull through the origin: their distance from it
CompressiveStrength = Annotated[float, Number(above=0, unit="Pa", likely=(1e5, 1e9))]


@dataclass(frozen=True)
class CrushedMaterial(FaceMaterial):
    """A face whose blocks are crushed where they are pressed by ``compressive_strength`` (Pa)."""

    compressive_strength: CompressiveStrength | None = None

    def __post_init__(self) -> None:
        require_kinds(self)


def strength_of(face: Face) -> float | None:
    """The compressive strength (Pa) of the blocks at a face; None if it is not limited."""
    if isinstance(face.material, CrushedMaterial) and face.kind in (Kind.DRY, Kind.INNER):
        return face.material.compressive_strength
    return None


@dataclass(frozen=True, eq=False)
class StressBlocks:
    """The polyhedron of a face: ``normals`` @ (n, m, m') <= ``limits``, (K, 3) and (K,).

    n is the normal force over strength and area, m and m' the sums of force times place along the
    tangents, over these and over the ``size`` (m) of the face.
    """

    normals: Floats
    limits: Floats
    size: float

    def use(self, resultant: Floats) -> float:
        """The part of what is carried of (n, m, m'), (3,); infinite outside the face."""
        demand, through = self.normals @ resultant, self.limits <= FLAT
        if (demand[through] > FLAT).any():
            return np.inf
        return max(0.0, float((demand[~through] / self.limits[~through]).max()))


@lru_cache(maxsize=4096)
def stress_blocks(outline: shapely.Polygon) -> StressBlocks:
    """The polyhedron of a face with this ``outline`` (m)."""
    hull = shapely.orient_polygons(outline.convex_hull)
    low_x, low_y, high_x, high_y = hull.bounds
    sides = np.array([high_x - low_x, high_y - low_y])
    # A long face as a square: lines across it run at angles that suit it.
    square = shapely.affinity.scale(outline, *(1.0 / sides), origin=(0.0, 0.0))
    corners = shapely.get_coordinates(hull.exterior)[:-1] / sides
    along = np.roll(corners, -1, axis=0) - corners
    angles = np.unwrap(np.arctan2(-along[:, 0], along[:, 1]))
    found = [np.zeros(3), np.array([1.0, 0.0, 0.0])]
    for angle, after in pairwise([*angles.tolist(), float(angles[0]) + 2.0 * np.pi]):
        for part, factor, count in WAYS:
            turn = angle + part * (after - angle)
            way = np.array([np.cos(turn), np.sin(turn)])
            reach = corners @ way
            high, low = float(reach.max()), float(reach.min())
            for depth in (high - low) * factor ** -np.arange(1.0, count + 1.0):
                block = square.intersection(_beyond(way, high - depth))
                place = np.array([block.centroid.x, block.centroid.y])
                found.append(block.area / square.area * np.array([1.0, *place]))
    # Imported here: it takes longer to import than most cases without crushing to prepare.
    planes = importlib.import_module("scipy.spatial").ConvexHull(np.array(found)).equations
    size = float(sides.max())
    normals = planes[:, :3] / np.array([1.0, *(sides / size)])
    return StressBlocks(normals, np.where(-planes[:, 3] > FLAT, -planes[:, 3], 0.0), size)


def _beyond(way: Floats, least: float) -> shapely.Polygon:
    """The points whose ``way``, of length 1, is at least ``least``, as far as `REACH`."""
    across = REACH * np.array([-way[1], way[0]])
    edge, far = least * way, (least + 2.0 * REACH) * way
    return shapely.Polygon([edge - across, far - across, far + across, edge + across])


def crushed_faces(assembly: Assembly) -> list[tuple[int, Polygon, float]]:
    """Number, face and compressive strength (Pa) of each face that has one."""
    return [
        (number, face, strength)
        for number, face in enumerate(assembly.faces)
        if isinstance(face, Polygon) and (strength := strength_of(face)) is not None
    ]


def resultant_rows(assembly: Assembly, number: int, size: float) -> tuple[Integers, Floats]:
    """Nodes of a face, and what unit normal forces there add to N and M over ``size``, (3, K)."""
    face = assembly.faces[number]
    nodes = np.flatnonzero(assembly.nodes.face == number)
    places = (assembly.nodes.position[nodes] - np.array(face.middle)) @ face.axes[1:].T
    return nodes, np.vstack([np.ones(len(nodes)), places.T / size])


def crushing_use(assembly: Assembly, force: Floats) -> dict[int, float]:
    """The part of its limit that each face with a compressive strength uses, by its number.

    ``force``: of the nodes in N, (N, 3); tension counts as no pressure.
    """
    found = {}
    for number, face, strength in crushed_faces(assembly):
        blocks = stress_blocks(face.outline)
        nodes, sums = resultant_rows(assembly, number, blocks.size)
        pressing = np.maximum(force[nodes, 0], 0.0) / (strength * face.area)
        found[number] = blocks.use(sums @ pressing)
    return found
