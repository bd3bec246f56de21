"""A structure: blocks, the interfaces found between them, and the law of each interface."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from sidmacib.mechanics.assembly import (
    Assembly,
    FaceMaterial,
    Failure,
    Kind,
    NodeLayout,
)
from sidmacib.mechanics.polygons import Polygon, polygon_nodes
from sidmacib.structure.blocks import Block
from sidmacib.structure.interfaces import NEAR, Interface, interfaces
from sidmacib.validation import refused

Pair = frozenset[str]  # names of two blocks


def structure(
    blocks: Sequence[Block],
    material: FaceMaterial,
    special: Mapping[Pair, FaceMaterial] | None = None,
    *,
    mesh: float = math.inf,
    nodes: NodeLayout = NodeLayout.VERTICES,
    failure: Failure = Failure.BRITTLE,
    near: float = NEAR,
) -> Assembly:
    """The assembly of ``blocks`` with an interface wherever two of them touch.

    ``material``: of all interfaces but those between pairs of blocks in ``special``. One with
    cohesion or tensile strength is bonded, any other dry. ``nodes`` on cells no longer than
    ``mesh`` (m); without one, a convex interface is one cell. ``near``: see `interfaces`.
    ValueError for two blocks of one name, a pair that does not touch, or no free block.
    """
    names = [block.name for block in blocks]
    if len(set(names)) < len(names):
        raise refused("blocks", next(n for n in names if names.count(n) > 1), "each name once")
    free = [block.size for block in blocks if not block.fixed]
    if not free:
        raise ValueError("blocks: at least one must be free to move")
    found, special = interfaces(blocks, near), dict(special or {})
    pairs = [frozenset((names[each.below], names[each.above])) for each in found]
    for pair in special:
        if pair not in pairs:
            raise refused("special", " and ".join(sorted(pair)), "two blocks that touch")
    faces = tuple(
        _face(each, names, special.get(pair, material), pairs[:number].count(pair))
        for number, (each, pair) in enumerate(zip(found, pairs, strict=True))
    )
    of_faces = polygon_nodes(faces, mesh, nodes)
    return Assembly(tuple(blocks), faces, of_faces, float(np.mean(free)), failure, mesh, nodes)


def _face(each: Interface, names: list[str], material: FaceMaterial, before: int) -> Polygon:
    """The face of an interface; ``before``: interfaces of the same two blocks before it."""
    bonded = material.cohesion > 0.0 or material.tensile_strength > 0.0
    kind = Kind.INNER if bonded else Kind.DRY
    name = f"{names[each.below]}-{names[each.above]}" + (f"-{before + 1}" if before else "")
    ends = each.below, each.above
    return Polygon(name, kind, material, *ends, each.axes, each.middle, each.outline)
