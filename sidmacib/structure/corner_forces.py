"""Forces at the corners of an interface in place of its nodes, as other programs draw them."""

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.mechanics.polygons import Polygon


def at_corners(face: Polygon, places: Floats, force: Floats) -> Floats:
    """Forces at the corners of the outer boundary of ``face`` that do the same, (K, 3).

    ``places`` in m and ``force`` in N of its nodes, both (N, 3). Each force is shared among the
    corners of a triangle that its node lies in, by the node's areal coordinates, so that all
    resultants and moments stay, and compression remains compression.
    """
    corners = shapely.get_coordinates(face.outline.exterior)[:-1]
    flat = (places - np.array(face.middle)) @ face.axes[1:].T
    parts = shapely.get_parts(
        shapely.constrained_delaunay_triangles(shapely.Polygon(face.outline.exterior))
    )
    triangles = np.array([shapely.get_coordinates(part)[:3] for part in parts])
    numbers = np.array([[_nearest(corners, corner) for corner in each] for each in triangles])
    shares = np.stack([_areal(triangle, flat) for triangle in triangles])  # (T, N, 3)
    inside = shares.min(axis=2).argmax(axis=0)  # the triangle that a node is deepest in
    share = shares[inside, np.arange(len(flat))]
    share = np.where(np.abs(share) < CLOSE, 0.0, share)
    found = np.zeros((len(corners), 3))
    np.add.at(
        found, numbers[inside].ravel(), (share[:, :, None] * force[:, None, :]).reshape(-1, 3)
    )
    return found


def _nearest(corners: Floats, place: Floats) -> int:
    return int(np.square(corners - place).sum(axis=1).argmin())


def _areal(triangle: Floats, places: Floats) -> Floats:
    """Areal coordinates of ``places``, (N, 2), in a triangle, (3, 2); shape (N, 3)."""
    both = np.linalg.solve((triangle[1:] - triangle[0]).T, (places - triangle[0]).T)
    return np.column_stack([1.0 - both.sum(axis=0), *both])
