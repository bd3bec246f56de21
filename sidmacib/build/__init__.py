"""Each block of a joint or a structure as one closed solid: its own locks added, others' cut out.

Solids of one kind differ only in where they are; each kind has axes to draw it along.

A lock belongs to one of two blocks and reaches into the other. Clearance makes locks smaller, never
the hollows that they lie in: so no solid leaves the shape that the models calculate with.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from sidmacib.build.clearance import NO_GAPS, Clearance, relieved
from sidmacib.joint import Joint, UpperBody
from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.structure.blocks import Block, box, grouped
from sidmacib.structure.files.structure_file import blocks_and_rows, description_in
from sidmacib.structure.interfaces import NEAR, interfaces, mean_size
from sidmacib.structure.locks import Locks, Row, cut_rows
from sidmacib.structure.overlaps import common_volume, meeting_boxes, solid_of
from sidmacib.structure.structure import Pair, rows_of
from sidmacib.validation import refused

GROWN = 1e-11  # over a block's size: so that parts which touch overlap; far above rounding
SMOOTHED = 1e-9  # over a block's size: what parts that overlap leave at their edges
WELDED = 2e-7  # over a block's size: vertices that are the same in 32-bit numbers
DIGITS = 10  # of coordinates, of the block's size
SHARED = 1e-9  # over a block's volume: what two solids may share
ALIKE = 1e-4  # over the volume: what blocks of one kind may differ by
RIGHT = 1e-3  # cosine: directions at right angles
TURNS = np.round(Rotation.create_group("O").as_matrix())  # those of a cube
Found = tuple[list[Block], dict[Pair, Row], float]  # with the tolerance of interfaces


@dataclass(frozen=True, eq=False)
class Solid:
    """A block as it is made: a closed surface of triangles.

    ``number``: from 1; ``places`` in m, (V, 3); ``triangles``: vertices of each, anticlockwise seen
    from outside, (T, 3); ``density`` in kg/m3; ``rounded``: whether a mill's radius changed it.
    """

    number: int
    name: str
    places: Floats
    triangles: Integers
    density: float
    rounded: bool = False

    @cached_property
    def manifold(self) -> manifold3d.Manifold:
        """The solid for operations with others, in m."""
        mesh = manifold3d.Mesh64(np.array(self.places), np.array(self.triangles, np.uint64))
        return manifold3d.Manifold(mesh)

    @property
    def volume(self) -> float:
        """In m3."""
        corners = self.places[self.triangles] - self.places.mean(axis=0)
        return float(np.linalg.det(corners).sum()) / 6.0

    @property
    def mass(self) -> float:
        """In kg."""
        return self.density * self.volume

    @property
    def centre(self) -> Floats:
        """Of mass, in m, (3,)."""
        middle = self.places.mean(axis=0)
        corners = self.places[self.triangles] - middle
        return np.asarray(middle + np.linalg.det(corners) @ corners.mean(axis=1) / self.volume / 8)


def solids(
    blocks: Sequence[Block],
    rows: Mapping[Pair, Row],
    gaps: Clearance = NO_GAPS,
    near: float = NEAR,
) -> tuple[Solid, ...]:
    """Every one of ``blocks`` with the locks of ``rows``, condensed or not, in their order.

    ``near``: as in `interfaces`; a lock fills the gap in its interface.
    ValueError for blocks with locks that are not convex, for locks that a clearance leaves nothing
    of, or that cut a block into several, and for solids that overlap.
    """
    near *= mean_size(blocks)
    left, parts = cut_rows(blocks, rows.values())
    locks: dict[str, list[Floats]] = {block.name: [] for block in blocks}
    growth = {block.name: GROWN * block.size for block in blocks}
    rounded: set[str] = set()
    for row, (in_below, in_above) in zip(rows.values(), parts, strict=True):
        below, above = (blocks[end].name for end in (row.interface.below, row.interface.above))
        second = above if row.locks.first == below else below
        owners = str(row.locks.first), second
        heights = [
            np.abs((part.solid.places - row.middle) @ row.interface.axes[0])
            for part in (*in_below, *in_above)
        ]
        gap = max((float(h[h <= near].max(initial=0.0)) for h in heights), default=0.0)
        reach = 2.0 * (gap + max(growth[below], growth[above]))
        sides = ((-1.0, below, in_below, in_above), (1.0, above, in_above, in_below))
        for side, name, own_parts, others in sides:
            for part in own_parts:
                owner = owners[part.number % 2]
                facing = [each for each in others if each.number == part.number]
                lock, changed = relieved(row, part, facing, gaps, side, own=owner == name)
                if changed:
                    rounded.add(owner)
                if lock is None:
                    words = f"lock {part.number + 1} of {below} and {above}: a clearance of "
                    raise ValueError(f"{words}{gaps.sides:g} m leaves nothing of it")
                corners = _grown(lock, growth[owner])
                if owner != name:  # it goes into its own block across the gap
                    normal = side * row.interface.axes[0]
                    height = (corners - row.middle) @ normal
                    corners -= np.outer(np.where(height <= near, height + reach, 0.0), normal)
                locks[owner].append(corners)
    made = []
    for number, block in enumerate(blocks, start=1):
        parts_of = [_grown(part, growth[block.name]) for part in left[block.name]]
        locked = any(block.name in pair for pair in rows)
        every = [*parts_of, *locks[block.name]] if locked else []
        solid = _united(number, block, every)
        made.append(replace(solid, rounded=block.name in rounded))
    require_apart(made, {block.name for block in blocks if block.fixed}, near)
    return tuple(made)


def _grown(part: Block, by: float) -> Floats:
    """The corners (m) of a convex ``part`` whose faces are ``by`` about as many m further out."""
    outwards = np.zeros_like(part.places)
    for face, normal in zip(part.faces, part.normals, strict=True):
        outwards[list(face)] += normal
    return np.asarray(part.places + by * outwards)


def _united(number: int, block: Block, parts: Sequence[Floats]) -> Solid:
    """One solid of convex ``parts`` that overlap, or else the ``block`` as it is.

    ValueError if they do not hold together.
    """
    middle, size = block.places.mean(axis=0), block.size
    hulls = [manifold3d.Manifold.hull_points((part - middle) / size) for part in parts]
    if hulls:
        whole = manifold3d.Manifold.batch_boolean(hulls, manifold3d.OpType.Add)
        whole = simplified(whole.as_original(), SMOOTHED)
    else:
        whole = solid_of(block, middle, size)
    if len(whole.decompose()) != 1:
        raise ValueError(f"{block.name}: its locks must not cut it into several pieces")
    places, triangles = _welded(*surface(whole))
    decimals = DIGITS - math.ceil(math.log10(size))
    places = np.round(places * size + middle, decimals) + 0.0
    return Solid(number, block.name, places, triangles, block.density)


def simplified(whole: manifold3d.Manifold, by: float) -> manifold3d.Manifold:
    """``whole`` without detail smaller than ``by``, in its units, or as it is.

    Where slivers meet, Manifold (3.5) may take away a corner: its volume tells.
    """
    simple = whole.simplify(by)
    same = abs(simple.volume() - whole.volume()) <= by * whole.surface_area()
    return simple if same else whole


def surface(of: manifold3d.Manifold) -> tuple[Floats, Integers]:
    """The places, (V, 3), and the triangles, (T, 3), that a manifold is bounded by."""
    mesh = of.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64)


def _welded(places: Floats, triangles: Integers) -> tuple[Floats, Integers]:
    """A surface without vertices nearer than `WELDED`, which files of 32-bit numbers confuse."""
    group = grouped(len(places), cKDTree(places).query_pairs(WELDED, output_type="ndarray"))
    merged = group[triangles]
    real = (merged != np.roll(merged, 1, axis=1)).all(axis=1)
    return places[np.unique(group, return_index=True)[1]], merged[real]


def require_apart(made: Sequence[Solid], fixed: set[str], near: float) -> None:
    """ValueError, with their names, for two solids that share more than `SHARED` and a layer.

    The layer is ``near`` (m) thick, on the smaller one: what `interfaces` takes as touching. Two
    that are ``fixed`` may, as in the model.
    """
    low = np.array([each.places.min(axis=0) for each in made])
    high = np.array([each.places.max(axis=0) for each in made])
    for one, other in meeting_boxes(low, high).tolist():
        first, second = made[one], made[other]
        if {first.name, second.name} <= fixed:
            continue
        most = SHARED * min(first.volume, second.volume)
        most += near * min(each.manifold.surface_area() for each in (first, second))
        if (shared := common_volume(first.manifold, second.manifold, most)) > most:
            words = f"{first.name} and {second.name} would share {shared:g} m3"
            raise ValueError(f"blocks: {words}")


@dataclass(frozen=True, eq=False)
class Kind:
    """Blocks of one shape; ``drawn``: the first along its own axes, its lowest coordinates 0."""

    name: str
    solids: list[Solid]
    drawn: Solid


def kinds(solids: Sequence[Solid], alike: float = 0.0) -> tuple[Kind, ...]:
    """The kinds of ``solids``, named A, B and so on, in the order of their first ones.

    A mirror image is a kind of its own. ``alike``: how far (m) corners of one kind may be apart.
    """
    found: list[Kind] = []
    for each in solids:
        upright = laid(each, own_axes(each))
        kind = next((kind for kind in found if _alike(kind.drawn, upright, alike)), None)
        if kind is None:
            found.append(Kind(letters(len(found)), [each], upright))
        else:
            kind.solids.append(each)
    return tuple(found)


def letters(number: int) -> str:
    """A for 0, Z for 25, AA for 26."""
    return (letters(number // 26 - 1) if number >= 26 else "") + chr(ord("A") + number % 26)


def laid(solid: Solid, axes: Floats) -> Solid:
    """``solid`` in coordinates along ``axes``, (3, 3), from its lowest ones."""
    places = solid.places @ axes.T
    return replace(solid, places=places - places.min(axis=0))


def own_axes(solid: Solid) -> Floats:
    """Three axes at right angles along which a block is drawn, right-handed, (3, 3).

    The direction that most area faces, and that of most area at right angles to it; of these axes
    the third is the most upright, the first the nearest to x.
    """
    corners = solid.places[solid.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    normals = across[area > 0.0] / area[area > 0.0, None]
    largest = np.abs(normals).argmax(axis=1)
    normals *= np.sign(np.take_along_axis(normals, largest[:, None], axis=1))
    _, of = np.unique(np.round(normals, 3), axis=0, return_inverse=True)
    ways = np.zeros((int(of.max()) + 1, 3))
    np.add.at(ways, of.ravel(), normals * area[area > 0.0, None])
    length = np.linalg.norm(ways, axis=1)
    ways /= length[:, None]
    # Of those that as much area faces the most upright one.
    order = np.lexsort((*np.round(np.abs(ways), 6).T, np.round(length / area.sum(), 4)))[::-1]
    ways = ways[order]
    first = ways[0]
    cosine = np.abs(ways @ first)
    others = [*ways[cosine < RIGHT], *ways[(cosine >= RIGHT) & (cosine < 0.9)], *np.eye(3)]
    second = next(way for way in others if abs(way @ first) < 0.9)
    second = second - (second @ first) * first
    second /= np.linalg.norm(second)
    axes = np.array([first, second, np.cross(first, second)])
    up = axes[int(np.abs(axes[:, 2]).argmax())]
    up = up * np.sign(up[2] or 1.0)
    level = [axis for axis in axes if abs(axis @ up) < 0.5]
    x = max(level, key=lambda axis: abs(axis[0]))
    x = x * (np.sign(x[0]) or 1.0)
    return np.array([x, np.cross(up, x), up])


def _alike(one: Solid, other: Solid, apart: float) -> bool:
    """Whether a turn takes ``other`` to ``one``, both from their lowest coordinates."""
    size = one.places.max(axis=0)
    near = max(ALIKE * size.max(), apart)
    most = ALIKE * one.volume + apart * one.manifold.surface_area()
    if abs(one.volume - other.volume) > most:
        return False
    for turn in TURNS:
        turned = laid(other, turn)
        if np.abs(turned.places.max(axis=0) - size).max() > near:
            continue
        # Within a layer as thick a lock may be hidden.
        if apart and max(_farthest(one, turned), _farthest(turned, one)) > near:
            continue
        if (one.manifold - turned.manifold).volume() <= most:
            return True
    return False


def _farthest(one: Solid, other: Solid) -> float:
    """The largest distance (m) of a corner of ``one`` from the nearest of ``other``."""
    return float(cKDTree(other.places).query(one.places)[0].max())


LOWER, UPPER = "lower", "upper"


def blocks_of_file(path: Path, more: Mapping[str, Any] | None = None) -> Found | None:
    """The blocks of a structure's file and where its locks are; None if it describes a joint.

    ``more``: as in `description_in`, which see for errors.
    """
    description = description_in(path, more)
    if isinstance(description, dict) and "blocks" not in description:
        return None
    return blocks_and_rows(description, path.parent)


def joint_blocks(joint: Joint) -> Found:
    """The lower and the upper block of ``joint``, and where its locks are.

    The lower body, whose thickness no model needs, is as high as the upper one. ValueError for
    locks of a density of their own, and for an upper block that is cut into columns.
    """
    if joint.upper_body is not UpperBody.MONOLITHIC:
        allowed = f"{UpperBody.MONOLITHIC}, as the block is built in one piece"
        raise refused("upper_body", str(joint.upper_body), allowed)
    for lock in joint.numbers:
        if (density := joint.lock_density(lock)) != joint.density:
            raise refused(f"different: lock {lock}: density", density, "that of its block")
    x, width, middle = joint.a / 2, joint.total_width, joint.h / 2
    blocks = [
        box(LOWER, (-x, 0.0, -joint.H), (x, width, middle), joint.density),
        box(UPPER, (-x, 0.0, middle), (x, width, joint.h + joint.H), joint.density),
    ]
    locks = Locks(
        joint.locks,
        joint.h,
        row=(0.0, 1.0, 0.0),
        first=str(joint.first),
        widths=tuple(map(joint.width, joint.numbers)),
    )
    rows = rows_of(blocks, {frozenset((LOWER, UPPER)): locks}, interfaces(blocks))
    return blocks, rows, NEAR
