"""Warnings about a structure: numbers that look as if in another unit, faces that nearly touch."""

import math
from collections import Counter
from collections.abc import Iterator

from sidmacib.joint.parameters import beyond, material_warnings
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Number
from sidmacib.structure.blocks import Block, solids_of
from sidmacib.structure.interfaces import LEAST, NEAR, close, mean_size, most_near, next_step
from sidmacib.structure.overlaps import tolerance_for

BLOCK = Number(unit="m", likely=(1e-3, 50.0))  # diagonal of a block
DENSITY = Number(unit="kg/m3", likely=(100.0, 3e4))  # below are kN/m3 and t/m3
MOST = 5  # lines: where one block is in another unit, all are
NEARLY = 0.01  # over the blocks' mean size: larger gaps are meant, as a rule
Pair = frozenset[int]


def structure_warnings(
    assembly: Assembly, near: float = NEAR, from_file: bool = False
) -> list[str]:
    """One line each for numbers of free blocks and of interfaces, and one for what nearly touches.

    The first few numbers. ``near``: the tolerance that interfaces were found with; ``from_file``:
    whether they were not found but are those of a file.
    """
    values: list[tuple[str, float, Number]] = []
    for piece in assembly.pieces:
        if isinstance(piece, Block) and not piece.fixed:
            values.append((f"{piece.name}: diagonal", piece.size, BLOCK))
            values.append((f"{piece.name}: density", piece.density, DENSITY))
    units = list(beyond(values))
    # Of each material of a face, named after the first that has it.
    for law, name in {face.material: face.name for face in reversed(assembly.faces)}.items():
        units += material_warnings(f"{name}: ", law)
    return [*units[:MOST], *_near_misses(assembly, near, from_file)]


def _near_misses(assembly: Assembly, near: float, from_file: bool) -> Iterator[str]:
    """How much touches, and how much nearly does, of pieces that are not of one block."""
    solids: list[Block] = []
    owner: list[int] = []
    for number, piece in enumerate(assembly.pieces):
        solids += solids_of(piece)
        owner += [number] * (len(solids) - len(owner))
    touch: Counter[Pair] = Counter()  # m2
    for face in assembly.faces:
        if isinstance(face, Polygon):
            touch[frozenset((face.below, face.above))] += face.outline.area
    size = mean_size(solids)
    apart: dict[Pair, list[tuple[float, float]]] = {}
    for gap, each in close(solids, min(most_near(solids), NEARLY) * size):
        pair = frozenset((owner[each.below], owner[each.above]))
        taken = pair in touch if from_file else abs(gap) <= near * size * (1.0 + 1e-9)
        if not taken and len(pair) == 2:
            apart.setdefault(pair, []).append((abs(gap), each.outline.area))
    nearly = {
        pair: max(gap for gap, _ in regions)
        for pair, regions in apart.items()
        if math.fsum(area for _, area in regions) > LEAST * size**2
    }
    if not nearly:
        return
    gap = next_step(sorted(nearly.values()))
    pairs = [pair for pair, of in nearly.items() if of <= gap]
    area = math.fsum(area for pair in pairs for _, area in apart[pair])
    one, other = (assembly.pieces[number].name for number in sorted(pairs[0]))
    remedy = "they have no interface in the file"
    if not from_file:
        remedy = f"to take them as touching, set tolerance: {tolerance_for(gap, size)}"
    yield (
        f"{len(touch)} pairs of blocks touch ({math.fsum(touch.values()):.3g} m2); faces of "
        f"{len(pairs)} more ({area:.3g} m2), such as {one} and {other}, do not, but are up to "
        f"{gap:.2g} m apart; {remedy}"
    )
