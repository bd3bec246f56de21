"""Convex blocks cut by planes."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sidmacib.mechanics.assembly import CLOSE, Floats, Integers
from sidmacib.structure.blocks import Block

NEAR = 1e-7  # over a block's size: vertices no further from a plane lie in it


def require_convex(block: Block) -> None:
    """ValueError unless all vertices of ``block`` lie behind each of its faces."""
    if (number := block.reentrant) is not None:
        raise ValueError(f"{block.name}, face {number}: must be convex where locks are cut")


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
    places, faces = list(block.places), [list(face) for face in block.faces]
    crossings = {}
    for face in faces:
        for one, other in zip(face, face[1:] + face[:1], strict=True):
            edge = min(one, other), max(one, other)
            if height[one] * height[other] < 0.0 and edge not in crossings:
                crossings[edge] = len(places)
                low, high = height[edge[0]], height[edge[1]]
                share = low / (low - high)
                places.append((1 - share) * places[edge[0]] + share * places[edge[1]])
    split = [_with_crossings(face, crossings) for face in faces]
    everywhere = np.append(height, np.zeros(len(crossings)))
    cap = _around(np.flatnonzero(everywhere == 0.0), np.array(places), normal)
    return (
        _part(block, places, split, everywhere, -1.0, cap),
        _part(block, places, split, everywhere, 1.0, cap[::-1]),
    )


def _with_crossings(face: list[int], crossings: dict[tuple[int, int], int]) -> list[int]:
    """The vertices of ``face`` with those where its edges cross the plane."""
    found = []
    for one, other in zip(face, face[1:] + face[:1], strict=True):
        found.append(one)
        crossing = crossings.get((min(one, other), max(one, other)))
        if crossing is not None:
            found.append(crossing)
    return found


def _around(numbers: Integers, places: Floats, normal: Floats) -> list[int]:
    """Vertices in one plane, anticlockwise about ``normal``."""
    arms = places[numbers] - places[numbers].mean(axis=0)
    first = arms[0] / np.linalg.norm(arms[0])
    angle = np.arctan2(arms @ np.cross(normal, first), arms @ first)
    return [int(number) for number in numbers[np.argsort(angle)]]


def _part(
    block: Block,
    places: list[Floats],
    faces: list[list[int]],
    height: Floats,
    side: float,
    cap: list[int],
) -> Block:
    """The part on one ``side`` (1 or -1) of the plane, closed by ``cap``."""
    kept = [[v for v in face if side * height[v] >= 0.0] for face in faces]
    kept = [face for face in kept if any(side * height[v] > 0.0 for v in face)] + [cap]
    used = sorted({vertex for face in kept for vertex in face})
    number = {vertex: new for new, vertex in enumerate(used)}
    return replace(
        block,
        vertices=tuple((float(x), float(y), float(z)) for x, y, z in (places[v] for v in used)),
        faces=tuple(tuple(number[vertex] for vertex in face) for face in kept),
    )


Plane = tuple[Floats, Floats]  # a point (m) and the unit normal, (3,) each


def sides(block: Block, corners: Floats, normal: Floats) -> Iterator[Plane]:
    """The planes, with outward normals, in which `clipped` cuts."""
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


def clipped(block: Block, corners: Floats, normal: Floats) -> tuple[Block | None, list[Block]]:
    """The part of a convex ``block`` above and below a convex outline, and the parts beside it.

    ``corners``: of the outline, (K, 3) in m, anticlockwise about the unit ``normal``. Along the
    edges of the block's own face in the outline's plane nothing is cut, so that a block which
    widens away from it keeps its sides.
    """
    inside: Block | None = block
    beside: list[Block] = []
    for point, outward in sides(block, corners, normal):
        if inside is None:
            break
        inside, outside = cut(inside, point, outward)
        beside += [outside] if outside else []
    return inside, beside
