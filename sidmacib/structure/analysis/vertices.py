"""Effect of the positions of blocks' vertices on the limit load of a structure."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from sidmacib.mechanics.assembly import Assembly, Face, Floats, Nodes, Vector
from sidmacib.mechanics.contact_law import Flags
from sidmacib.mechanics.limit_sensitivity import Change, limit_derivatives
from sidmacib.mechanics.polygons import Polygon
from sidmacib.problem import Problem
from sidmacib.structure.blocks import Block, vectors
from sidmacib.structure.interfaces import NEAR, mean_size
from sidmacib.structure.loads import free_weight

STEP = 1e-7  # over the blocks' mean size: a vertex moves by less than faces may be off their planes
FOLLOWS = 100.0  # over that step: a corner of an interface moves by less


@dataclass(frozen=True)
class VertexEffect:
    """The effect of moving the vertices at some ``places`` (m) alike, in all ``blocks`` there.

    ``load``: derivatives of the limit load by x, y and z, in N/m; ``factor``: of the load over the
    weight of the free blocks, in 1/m. None where there is no derivative.
    """

    places: tuple[Vector, ...]
    blocks: tuple[str, ...]
    load: tuple[float | None, ...]
    factor: tuple[float | None, ...]


def vertex_effects(
    build: Callable[[Sequence[Block]], Problem],
    blocks: Sequence[Block],
    together: Sequence[Sequence[Vector]] | None = None,
    *,
    friction: bool = True,
) -> tuple[VertexEffect, ...]:
    """The effects of moving vertices of ``blocks`` a little.

    ``together``: places of vertices that move alike, such as both ends of an edge. None: every
    place by itself. A vertex that leaves the plane of a face bends it; the block's volume is then
    that of the triangles which its face is divided into.
    ``build``: the structure of blocks and its load, as by `sidmacib.structure.structure.structure`
    and `sidmacib.structure.loads.acceleration`. Contact nodes stay at the same part of their
    interface. ValueError for a place without a vertex, and where interfaces do not follow the
    vertex but become others. Errors of `limit_load` and ``build``.
    """
    size = mean_size(blocks)
    problem = build(blocks)
    weight = free_weight(problem.assembly)
    if together is None:
        together = [[place] for place in vectors(_places(blocks, NEAR * size))]
    groups = [np.array(group, float).reshape(-1, 3) for group in together]
    changes: dict[str, Change] = {}
    for number, group in enumerate(groups):
        for axis, shift in zip("xyz", STEP * size * np.eye(3), strict=True):
            before, after = (
                _moved(build, problem.assembly, blocks, group, each) for each in (-shift, shift)
            )
            changes[f"{number}{axis}"] = Change(before, after, 2.0 * STEP * size, size)
    derived = limit_derivatives(*problem, changes, friction=friction)
    effects = []
    for number, group in enumerate(groups):
        names = [f"{number}{axis}" for axis in "xyz"]
        by_load = tuple(derived.by[name] for name in names)
        by_weight = [
            (free_weight(each.after[0]) - free_weight(each.before[0])) / each.difference
            for each in (changes[name] for name in names)
        ]
        by_factor = tuple(
            None if load is None else (load - derived.load / weight * heavier) / weight
            for load, heavier in zip(by_load, by_weight, strict=True)
        )
        having = tuple(each.name for each in blocks if _at(each, group, NEAR * size).any())
        effects.append(VertexEffect(vectors(group), having, by_load, by_factor))
    return tuple(effects)


def _places(blocks: Sequence[Block], near: float) -> Floats:
    """All places of vertices, those of several blocks once."""
    found: list[Floats] = []
    for place in np.concatenate([block.places for block in blocks]):
        if not any(np.linalg.norm(place - other) <= near for other in found):
            found.append(place)
    return np.array(found)


def _at(block: Block, places: Floats, near: float) -> Flags:
    """Whether each vertex of ``block`` is at one of ``places`` (m), (K, 3); (V,)."""
    apart = np.linalg.norm(block.places[:, None] - places, axis=2)
    return np.asarray((apart <= near).any(axis=1))


def _moved(
    build: Callable[[Sequence[Block]], Problem],
    assembly: Assembly,
    blocks: Sequence[Block],
    places: Floats,
    shift: Floats,
) -> Problem:
    """The problem with the vertices at ``places`` moved, and the nodes of ``assembly``."""
    near, others = NEAR * mean_size(blocks), []
    for block in blocks:
        here = _at(block, places, near)
        vertices = vectors(block.places + here[:, None] * shift)
        others.append(replace(block, vertices=vertices) if here.any() else block)
    for place in places:
        if not any(_at(block, place[None], near).any() for block in blocks):
            raise ValueError(f"no block has a vertex at {place.tolist()} m")
    after = build(others)
    nodes = _following(assembly, after.assembly, FOLLOWS * float(np.linalg.norm(shift)))
    faces = tuple(map(_turned, assembly.faces, after.assembly.faces))
    same = replace(after.assembly, faces=faces, nodes=nodes, length=assembly.length)
    return Problem(same, after.loads)


def _turned(before: Face, after: Face) -> Face:
    """The face ``after`` with the tangents of ``before``, as near as its normal lets them be.

    Tangents follow the largest component of the normal: where two are the same, rounding decides.
    """
    if type(after) is not Polygon:
        return after  # along locks and across them
    normal = after.axes[0]
    first = before.axes[1] - (before.axes[1] @ normal) * normal
    first = first / np.linalg.norm(first)
    axes = np.array([normal, first, np.cross(normal, first)])
    turn = after.axes[1:] @ axes[1:].T
    return replace(
        after, axes=axes, outline=shapely.transform(after.outline, lambda flat: flat @ turn)
    )


def _following(before: Assembly, after: Assembly, most: float) -> Nodes:
    """The nodes of one assembly on the faces of another, corners of which moved at ``most`` so far.

    ValueError if they moved further, or the faces are others.
    """
    if [each.name for each in before.faces] != [each.name for each in after.faces]:
        raise ValueError("vertices: interfaces become others where one is moved")
    position, area = before.nodes.position.copy(), before.nodes.area.copy()
    for number, (old, new) in enumerate(zip(before.faces, after.faces, strict=True)):
        assert isinstance(old, Polygon) and isinstance(new, Polygon)
        here = before.nodes.face == number
        apart = np.linalg.norm(old.corners[:, None] - new.corners, axis=2)
        if len(old.corners) != len(new.corners) or apart.min(axis=1).max() > most:
            raise ValueError(f"{old.name}: its corners do not follow where a vertex is moved")
        corners = new.corners[apart.argmin(axis=1)]
        position[here] = [_follows(each, old.corners, corners) for each in position[here]]
        area[here] *= new.area / old.area
    return Nodes(before.nodes.face, position, area)


def _follows(point: Floats, old: Floats, new: Floats) -> Floats:
    """A ``point`` (m) at the same part of the triangle of a face's middle and one of its sides."""
    best = -np.inf
    for one in range(len(old)):
        ends = [one, (one + 1) % len(old)]
        middle, moved = old.mean(axis=0), new.mean(axis=0)
        parts = np.linalg.lstsq((old[ends] - middle).T, point - middle, rcond=None)[0]
        inside = min(*parts, 1.0 - parts.sum())
        if inside > best:
            best, found = inside, point - (middle + parts @ (old[ends] - middle))
            found = found + moved + parts @ (new[ends] - moved)
    return np.asarray(found)
