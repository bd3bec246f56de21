"""Bodies in files: told apart, which of them cannot move, and the blocks that they bound."""

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.repair import (
    Edge,
    Face,
    Surface,
    connected,
    edges_of,
    is_inside,
    once_each,
    open_edges,
    repaired,
    sides_of,
    welded,
    with_depth,
)
from sidmacib.validation import refused

MOST_NAMES = 8  # in a message
SAME = 1e-7  # over the size of all bodies of a file: vertices no further apart are one


@dataclass(frozen=True, eq=False)
class Body:
    """A body of a file: its ``surface`` (m), and what the file says of it.

    ``density`` in kg/m3 and ``material``, its name: None if the file gives none. ``support``:
    whether it cannot move.
    """

    name: str
    surface: Surface
    density: float | None = None
    material: str | None = None
    support: bool = False


def blocks_of(
    bodies: Sequence[Body],
    density: float,
    fixed: bool | Sequence[object] | None = None,
    begin: str = "",
    below: float | None = None,
) -> list[Block]:
    """The blocks that ``bodies`` bound; those that cannot move may be flat.

    ``density`` in kg/m3, of bodies without one. Those cannot move that ``fixed`` names, with or
    without what all names ``begin`` with, and those that reach below the height ``below`` (m);
    without both the supports. Errors of `repaired`, and ValueError for a name that no body has.
    """
    names = [body.name.removeprefix(f"{begin}-") for body in bodies]
    held = {name for name, body in zip(names, bodies, strict=True) if body.support}
    if isinstance(fixed, bool):
        held = set(names) if fixed else set()
    elif fixed is not None or below is not None:
        held = _chosen(fixed or (), names, f"{begin}-")
    found = []
    for name, body in zip(names, bodies, strict=True):
        places, faces = body.surface
        still = name in held or (below is not None and bool(places[:, 2].min() < below))
        if still:
            places, faces = with_depth(places, faces)
        own = density if body.density is None else body.density
        found.append(repaired(body.name, places, faces, own, fixed=still, material=body.material))
    return found


def _chosen(asked: Sequence[object], names: Sequence[str], begin: str) -> set[str]:
    """Those of ``names`` that are ``asked`` for by name or by a pattern with `*`; ValueError."""
    held: set[str] = set()
    for each in map(str, asked):
        short = each.removeprefix(begin)
        fit = [n for n in names if n in (each, short) or fnmatchcase(n, each)]
        fit = fit or [n for n in names if fnmatchcase(n, short)]
        if not fit:
            some = ", ".join(names[:MOST_NAMES]) + ", ..." * (len(names) > MOST_NAMES)
            raise refused("fixed", each, f"true, false, or a list of {some}")
        held |= set(fit)
    return held


def bodies_in(places: Floats, faces: Sequence[Face]) -> tuple[Floats, list[list[Face]]]:
    """The vertices (m), (W, 3), and the faces of each body that ``faces`` bound, in their order.

    ``places`` of vertices (m), (V, 3). Faces that share vertices are of one body, if all bodies are
    closed so. Else vertices at one place are joined, and a body ends where all edges are in an even
    number of its faces, so that bodies which follow each other may touch; where that leads to no
    end, or the surface is open, faces that share an edge with no third one are of one body. A
    surface inside a body is a cavity of it; one that is there twice counts once.
    """
    surfaces = connected(faces)
    if not all(len(sides) == 2 for part in surfaces for sides in sides_of(part).values()):
        places, faces = welded(places, faces, SAME)
        border = set(open_edges(faces))
        flat = [part for part in connected(faces) if not border.isdisjoint(open_edges(part))]
        apart = {face for part in flat for face in part}
        rest = [face for face in faces if face not in apart]
        surfaces = _in_order(rest) or (connected(once_each(rest)) if rest else [])
        first = {face: number for number, face in reversed([*enumerate(faces)])}
        surfaces = sorted([*surfaces, *flat], key=lambda part: first[part[0]])
    once = {frozenset(map(frozenset, surface)): surface for surface in reversed(surfaces)}
    return places, _with_cavities(list(once.values())[::-1], places)


def _in_order(faces: Sequence[Face]) -> list[list[Face]]:
    """Closed surfaces that follow each other; none if that is not how ``faces`` are written."""
    found: list[list[Face]] = []
    surface: list[Face] = []
    once: set[Edge] = set()  # edges that an odd number of faces have
    for face in faces:
        surface.append(face)
        for one, other in edges_of(face):
            once ^= {(min(one, other), max(one, other))}
        if not once:
            if len(once_each(surface)) < 4:
                return []
            found.append(surface)
            surface = []
    return [] if surface else found


def _with_cavities(surfaces: list[list[Face]], places: Floats) -> list[list[Face]]:
    """Surfaces, those within an odd number of others as part of the smallest of these."""
    corners = [places[sorted({v for face in each for v in face})] for each in surfaces]
    low = np.array([each.min(axis=0) for each in corners])
    high = np.array([each.max(axis=0) for each in corners])
    bodies = {number: list(surface) for number, surface in enumerate(surfaces)}
    for number, around in enumerate(corners):
        boxes = (low < low[number]).all(axis=1) & (high > high[number]).all(axis=1)
        outside = [
            int(k)
            for k in np.flatnonzero(boxes)
            if all(is_inside(point, surfaces[k], places) for point in around)
        ]
        if len(outside) % 2:
            smallest = min(outside, key=lambda k: float(np.prod(high[k] - low[k])))
            bodies[smallest] += bodies.pop(number)
    return list(bodies.values())
