"""Interfaces that a file of COMPAS brings, for blocks with gaps between them."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.quantities import shown
from sidmacib.structure.blocks import Block, area_vector, normal_of, require_near
from sidmacib.structure.files.compas import edges_in
from sidmacib.structure.files.repair import AS_IT_IS
from sidmacib.structure.interfaces import Interface, tangents

ALONG = 0.9  # least cosine between the normals of an interface and of a face beside it
AWAY = 1e-3  # weight of the distance along a face, against that from its plane


def read_compas_interfaces(
    path: Path, blocks: Sequence[Block], frame: Floats = AS_IT_IS
) -> tuple[Interface, ...]:
    """The interfaces in the JSON file ``path`` between its ``blocks``, of `read_compas`.

    ``frame`` as there. Their normals are those of the blocks' nearest faces. Errors of
    `read_compas`, and ValueError, which names the edge, for an interface that has no area or is at
    no face.
    """
    nodes = {block.name.rpartition("-")[2]: place for place, block in enumerate(blocks)}
    found = []
    for one, other, points in edges_in(path):
        name = f"edge between {shown(one)} and {shown(other)}"
        if one not in nodes or other not in nodes:
            raise ValueError(f"{name}: must be between two blocks of the file")
        corners = points.reshape(-1, 3)
        require_near(name, corners)
        below, above = sorted((nodes[one], nodes[other]))
        if not (blocks[below].fixed and blocks[above].fixed):
            found.append(_interface(name, below, above, corners @ frame.T, blocks[below]))
    return tuple(sorted(found, key=lambda each: (each.below, each.above, each.middle)))


def _interface(name: str, below: int, above: int, corners: Floats, block: Block) -> Interface:
    """The region within ``corners`` (m), (K, 3), beside a face of the ``block`` below."""
    about = corners.mean(axis=0)
    around = area_vector(corners - about)
    if not np.linalg.norm(around) > CLOSE * block.size**2:
        raise ValueError(f"{name}: an interface must have an area")
    normal = around / np.linalg.norm(around)
    nearest, side = math.inf, 0.0
    for outline in block.outlines:
        outward = normal_of(outline)
        beside = float(outward @ normal)
        if abs(beside) > ALONG:
            arm = about - outline.mean(axis=0)
            # In the plane of the face first, then near its middle.
            apart = abs(float(arm @ outward)) + AWAY * float(np.linalg.norm(arm))
            if apart < nearest:
                nearest, side = apart, math.copysign(1.0, beside)
    axes = np.array([side * normal, *tangents(side * normal)])
    outline = shapely.Polygon((corners - about) @ axes[1:].T)
    if not (side and outline.is_valid):
        raise ValueError(f"{name}: an interface must be beside a face of its block, and not cross")
    flat = shapely.get_coordinates(outline.centroid)[0]
    x, y, z = about + flat @ axes[1:]
    centred = shapely.normalize(shapely.affinity.translate(outline, *(-flat))).reverse()
    return Interface(below, above, axes, (float(x), float(y), float(z)), centred)
