"""Warnings about a structure: numbers that look as if in another unit, faces that nearly touch."""

from collections import Counter
from collections.abc import Iterator

from sidmacib.joint.unit_warnings import beyond, material_warnings
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Number
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.interfaces import mean_size, touching

BLOCK = Number(unit="m", likely=(1e-3, 50.0))  # diagonal of a block
DENSITY = Number(unit="kg/m3", likely=(100.0, 3e4))  # below are kN/m3 and t/m3
MOST = 5  # lines: where one block is in another unit, all are
NEARLY = 1e-3  # over the mean size of the blocks: faces no further apart nearly touch


def structure_warnings(assembly: Assembly) -> list[str]:
    """One line each for numbers of free blocks and of interfaces, and for pairs that nearly touch.

    The first few of each kind.
    """
    values: list[tuple[str, float, Number]] = []
    large = []
    for piece in assembly.pieces:
        if isinstance(piece, Block) and not piece.fixed:
            if piece.size > BLOCK.likely[1]:
                large.append(
                    f"{piece.name}: block diagonal {piece.size:.4g} m; if its mesh file is in "
                    'millimetres, add "scale: 0.001"'
                )
            else:
                values.append((f"{piece.name}: block diagonal", piece.size, BLOCK))
            values.append((f"{piece.name}: density", piece.density, DENSITY))
    units = [*large, *beyond(values), *_of_faces(assembly)]
    return [*units[:MOST], *list(_near_misses(assembly))[:MOST]]


def _near_misses(assembly: Assembly) -> Iterator[str]:
    """Pairs of pieces with more area close to each other than their interfaces have."""
    solids: list[Block] = []
    owner: list[int] = []
    for number, piece in enumerate(assembly.pieces):
        parts = piece.solids if isinstance(piece, Compound) else (piece,)
        solids += [part for part in parts if isinstance(part, Block)]
        owner += [number] * (len(solids) - len(owner))
    apart: Counter[tuple[int, int]] = Counter()  # m2
    for each in touching(solids, NEARLY):
        apart[_pair(owner[each.below], owner[each.above])] += each.outline.area
    for face in assembly.faces:
        if isinstance(face, Polygon):
            apart[_pair(face.below, face.above)] -= face.outline.area
    size = mean_size(solids)
    for pair, area in apart.items():
        if pair[0] != pair[1] and area > NEARLY * size**2:
            one, other = (assembly.pieces[number].name for number in pair)
            yield (
                f"{one} and {other}: {area:.2g} m2 of their faces do not touch, but are less than "
                f"{NEARLY * size:.2g} m apart"
            )


def _pair(one: int, other: int) -> tuple[int, int]:
    return min(one, other), max(one, other)


def _of_faces(assembly: Assembly) -> Iterator[str]:
    """Warnings of each material of a face, named after the first that has it."""
    named = {face.material: face.name for face in reversed(assembly.faces)}
    for law, name in named.items():
        yield from material_warnings(f"{name}: ", law)
