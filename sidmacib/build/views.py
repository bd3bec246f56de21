"""Views of a solid: its edges, those that are hidden told apart, and sections."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import manifold3d
import numpy as np
import shapely
import trimesh

from sidmacib.build import Solid, simplified, surface
from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.structure.locks import Row
from sidmacib.structure.structure import Pair

FOLDED = 0.02  # rad: between two triangles, beyond which their edge is drawn
SMOOTH = 1e-5  # over the size: steps that come from rounded coordinates in a file
NARROW = 0.01  # of a block: no section is cut in a part as thin
BEHIND = 1e-6  # over the size: depth of what hides an edge over it


@dataclass(frozen=True, eq=False)
class View:
    """What is seen of a solid along an axis, in m.

    ``visible`` and ``hidden``: ends of lines, (N, 2, 2); ``cut``: outlines of the section, (K, 2)
    each.
    """

    visible: Floats
    hidden: Floats
    cut: tuple[Floats, ...] = ()


@dataclass(frozen=True, eq=False)
class Detail:
    """The profile of a row of locks in one block: what lies within twice their height.

    ``outlines`` of the section across the locks, (K, 2) in m along the row and out of the block;
    ``stops``: where it steps; ``heights``: of its lowest and highest faces; ``low``: of its end.
    """

    title: str
    outlines: tuple[Floats, ...]
    stops: tuple[float, ...]
    heights: tuple[float, ...]
    low: float


def detail(solid: Solid, pair: Pair, row: Row) -> Detail:
    """The profile of a ``row`` of locks between ``solid`` and the other of a ``pair``."""
    (other,) = pair - {solid.name}
    out = row.interface.axes[0] * np.sign((row.middle - solid.centre) @ row.interface.axes[0])
    axes = np.array([row.across, out, np.cross(row.across, out)])
    half = row.locks.height / 2
    turned = solid.manifold.transform(np.column_stack([axes, -axes @ row.middle]))
    wide = float(row.edges[-1] - row.edges[0])
    window = manifold3d.CrossSection.square((wide + 2 * half, 4 * half)).translate(
        (float(row.edges[0]) - half, -3 * half)
    )
    cut = (turned.slice(1e-6 * wide) ^ window).simplify(SMOOTH * wide)
    outlines = tuple(np.array(each) for each in cut.to_polygons())
    corners = np.concatenate(outlines)
    steps = corners[np.abs(np.abs(corners[:, 1]) - half) <= 0.25 * half]  # heads, roots, bottoms
    return Detail(
        f"joint to {other}: {row.locks.count} locks",
        outlines,
        tuple(distinct(steps[:, 0])),
        tuple(distinct(steps[:, 1])),
        float(corners[:, 1].min()),
    )


def distinct(values: Floats) -> list[float]:
    """Sorted values, those that only rounding tells apart once."""
    found = np.unique(values)
    near = 1e-4 * (found[-1] - found[0])
    return [float(found[0]), *found[1:][np.diff(found) > near].tolist()]


def smooth(solid: Solid) -> Solid:
    """``solid`` without steps far smaller than it."""
    size = float(np.ptp(solid.places, axis=0).max())
    places, triangles = surface(simplified(solid.manifold.as_original(), SMOOTH * size))
    return replace(solid, places=places, triangles=triangles)


def edge_vertices(solid: Solid) -> Integers:
    """The vertices of those edges, (E, 2)."""
    mesh = trimesh.Trimesh(solid.places, solid.triangles, process=False)
    return np.asarray(mesh.face_adjacency_edges[mesh.face_adjacency_angles > FOLDED])


def view(solid: Solid, axes: Floats) -> View:
    """``solid`` along ``axes``: to the right, up, and towards who looks at it, (3, 3)."""
    size = float(np.ptp(solid.places, axis=0).max())
    edges = solid.places[edge_vertices(solid)] @ axes.T
    triangles = (solid.places @ axes.T)[solid.triangles]
    seen: dict[bool, list[Floats]] = {False: [], True: []}
    for edge in edges:
        places = _crossings(edge, edges)
        if not len(places):
            continue
        ends = edge[0] + places[:, None] * (edge[1] - edge[0])
        middle = (ends[:-1] + ends[1:]) / 2
        behind = _covered(middle, triangles, BEHIND * size)
        for start, end, out_of_sight in zip(ends[:-1], ends[1:], behind, strict=True):
            seen[bool(out_of_sight)].append(np.array([start[:2], end[:2]]))
    visible, hidden = (np.array(lines).reshape(-1, 2, 2) for lines in seen.values())
    return View(visible, hidden)


def straight(lines: Floats) -> Floats:
    """``lines``, (N, 2, 2), with those joined that go on straight; the longest first, (M, 2, 2)."""
    near = SMOOTH * float(np.ptp(lines.reshape(-1, 2), axis=0).max())
    whole = shapely.line_merge(shapely.union_all(shapely.linestrings(lines)))
    found = [
        (start, end)
        for line in shapely.get_parts(shapely.simplify(whole, near))
        for start, end in pairwise(shapely.get_coordinates(line))
    ]
    return np.array(sorted(found, key=lambda ends: -math.dist(*ends)))


def section(solid: Solid, place: float) -> View:
    """The half of ``solid`` beyond a cut across x at ``place`` (m), seen along x: y to the left."""
    axes = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    places, triangles = surface(solid.manifold.trim_by_plane((1.0, 0.0, 0.0), place))
    beyond = replace(solid, places=places, triangles=triangles)
    turned = solid.manifold.transform(np.column_stack([axes, np.zeros(3)]))
    outlines = turned.slice(-place).to_polygons()
    return replace(view(beyond, axes), cut=tuple(map(np.asarray, outlines)))


def cut_place(solid: Solid) -> float:
    """Where along x (m) a section is cut: near the middle, away from all corners."""
    x = np.array(distinct(solid.places[:, 0]))
    low, high = x[:-1], x[1:]
    wide = np.flatnonzero(high - low >= NARROW * (x[-1] - x[0]))
    middle = (x[0] + x[-1]) / 2
    off = np.maximum(np.maximum(low[wide] - middle, middle - high[wide]), 0.0)
    near = int(wide[off.argmin()])
    clear = (high[near] - low[near]) / 4
    return float(np.clip(middle, low[near] + clear, high[near] - clear))


def _crossings(edge: Floats, edges: Floats) -> Floats:
    """Where other edges cross ``edge`` in the plane of a view, from 0 to 1, with both ends."""
    along = edge[1, :2] - edge[0, :2]
    if not np.linalg.norm(along) > 0.0:
        return np.zeros(0)
    others = edges[:, 1, :2] - edges[:, 0, :2]
    start = edges[:, 0, :2] - edge[0, :2]
    turn = along[0] * others[:, 1] - along[1] * others[:, 0]
    parallel = np.abs(turn) <= 1e-12 * np.abs(along).max() * np.abs(others).max(initial=1e-300)
    turn = np.where(parallel, np.inf, turn)
    here = (start[:, 0] * others[:, 1] - start[:, 1] * others[:, 0]) / turn
    there = (start[:, 0] * along[1] - start[:, 1] * along[0]) / turn
    meets = ~parallel & (here > 0.0) & (here < 1.0) & (there >= -1e-9) & (there <= 1.0 + 1e-9)
    # Of edges that lie on it, the ends.
    ends = (edges[:, :, :2] - edge[0, :2]) @ along / (along @ along)
    off = edges[:, :, :2] - edge[0, :2] - ends[:, :, None] * along
    on = (np.linalg.norm(off, axis=2) <= 1e-9) & (ends > 0.0) & (ends < 1.0)
    places = np.unique(np.round(np.concatenate([[0.0, 1.0], here[meets], ends[on]]), 9))
    return np.asarray(places)


def _covered(points: Floats, triangles: Floats, near: float) -> Floats:
    """Whether one of ``triangles``, (T, 3, 3), covers each of ``points``, (S, 3), by ``near``."""
    one, two, three = np.moveaxis(triangles, 1, 0)
    first, second = two - one, three - one
    area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    seen = np.abs(area) > near * near
    one, first, second, area = one[seen], first[seen], second[seen], area[seen]
    off = points[:, None] - one
    u = (off[..., 0] * second[:, 1] - off[..., 1] * second[:, 0]) / area
    v = (off[..., 1] * first[:, 0] - off[..., 0] * first[:, 1]) / area
    depth = one[:, 2] + u * first[:, 2] + v * second[:, 2]
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9)
    return np.asarray((inside & (depth > points[:, None, 2] + near)).any(axis=1))
