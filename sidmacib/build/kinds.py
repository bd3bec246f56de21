"""Kinds of blocks: those that differ only in where they are, and the axes to draw them along."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from sidmacib.build.solids import Solid
from sidmacib.mechanics.assembly import Floats

ALIKE = 1e-4  # over the volume: what blocks of one kind may differ by
RIGHT = 1e-3  # cosine: directions at right angles
TURNS = np.round(Rotation.create_group("O").as_matrix())  # those of a cube


@dataclass(frozen=True, eq=False)
class Kind:
    """Blocks of one shape, the first of which is drawn; ``axes`` of the drawing, (3, 3)."""

    name: str
    solids: tuple[Solid, ...]
    axes: Floats

    @property
    def drawn(self) -> Solid:
        """The first one along the axes of the drawing, its lowest coordinates 0."""
        return laid(self.solids[0], self.axes)


def kinds(solids: Sequence[Solid]) -> tuple[Kind, ...]:
    """The kinds of ``solids``, named A, B and so on, in the order of their first ones.

    A mirror image is a kind of its own.
    """
    groups: list[tuple[Solid, list[Solid]]] = []
    for each in solids:
        upright = laid(each, own_axes(each))
        for first, group in groups:
            if _alike(first, upright):
                group.append(each)
                break
        else:
            groups.append((upright, [each]))
    return tuple(
        Kind(letters(number), tuple(group), own_axes(group[0]))
        for number, (_, group) in enumerate(groups)
    )


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


def _alike(one: Solid, other: Solid) -> bool:
    """Whether a turn takes ``other`` to ``one``, both from their lowest coordinates."""
    if abs(one.volume - other.volume) > ALIKE * one.volume:
        return False
    size = one.places.max(axis=0)
    for turn in TURNS:
        turned = laid(other, turn)
        if np.abs(turned.places.max(axis=0) - size).max() > ALIKE * size.max():
            continue
        if (one.manifold - turned.manifold).volume() <= ALIKE * one.volume:
            return True
    return False
