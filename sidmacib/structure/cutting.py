"""Convex blocks cut by planes."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.structure.blocks import Block, compact, vectors

NEAR = 1e-7  # over a block's size: vertices no further from a plane lie in it


def cut(block: Block, point: Floats, normal: Floats) -> tuple[Block | None, Block | None]:
    """The parts of a convex ``block`` behind and in front of a plane; None where there is none.

    ``point`` (m) of the plane and its unit ``normal``, both (3,), which points to the front.
    """
    height = (block.places - point) @ normal
    height[np.abs(height) <= NEAR * block.size] = 0.0
    if not height.max() > 0.0:
        return block, None
    if not height.min() < 0.0:
        return None, block
    places = list(block.places)
    split: list[list[int]] = []
    crossings: dict[tuple[int, int], int] = {}  # vertices where edges cross the plane
    for face in block.faces:
        divided: list[int] = []
        for one, other in zip(face, face[1:] + face[:1], strict=True):
            divided.append(one)
            if height[one] * height[other] < 0.0:
                low, high = edge = min(one, other), max(one, other)
                if edge not in crossings:
                    crossings[edge] = len(places)
                    share = height[low] / (height[low] - height[high])
                    places.append((1 - share) * places[low] + share * places[high])
                divided.append(crossings[edge])
        split.append(divided)
    everywhere = np.append(height, np.zeros(len(crossings)))
    every = np.array(places)
    around = np.flatnonzero(everywhere == 0.0)
    arms = every[around] - every[around].mean(axis=0)
    first = arms[0] / np.linalg.norm(arms[0])
    angle = np.arctan2(arms @ np.cross(normal, first), arms @ first)
    cap: list[int] = around[np.argsort(angle)].tolist()  # anticlockwise about the normal
    return (
        _part(block, every, split, everywhere, -1.0, cap),
        _part(block, every, split, everywhere, 1.0, cap[::-1]),
    )


def _part(
    block: Block,
    places: Floats,
    faces: list[list[int]],
    height: Floats,
    side: float,
    cap: list[int],
) -> Block:
    """The part on one ``side`` (1 or -1) of the plane, closed by ``cap``."""
    kept = [[v for v in face if side * height[v] >= 0.0] for face in faces]
    kept = [face for face in kept if any(side * height[v] > 0.0 for v in face)] + [cap]
    used, numbered = compact(places, kept)
    return replace(block, vertices=vectors(used), faces=tuple(numbered))


Plane = tuple[Floats, Floats]  # a point (m) and the unit normal, (3,) each


def sides(block: Block, corners: Floats, normal: Floats) -> Iterator[Plane]:
    """The planes, with outward normals, that a convex outline cuts a convex ``block`` along.

    ``corners``: of the outline, (K, 3) in m, anticlockwise about the unit ``normal``. Along the
    edges of the block's own face in the outline's plane nothing is cut, so that a block which
    widens away from it keeps its sides.
    """
    in_plane = np.abs((block.places - corners[0]) @ normal) <= NEAR * block.size
    for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        outward = np.cross(other - one, normal)
        length = float(np.linalg.norm(outward))
        if length <= CLOSE * block.size:
            continue
        outward /= length
        here = block.places[in_plane]
        if not len(here) or float(((here - one) @ outward).max()) > NEAR * block.size:
            yield one, outward


def clipped(block: Block, planes: Iterable[Plane]) -> tuple[Block | None, list[Block]]:
    """The part of a convex ``block`` behind all ``planes``, if any, and the parts beside it."""
    inside: Block | None = block
    beside: list[Block] = []
    for point, outward in planes:
        if inside is None:
            break
        inside, outside = cut(inside, point, outward)
        beside += [outside] if outside else []
    return inside, beside
