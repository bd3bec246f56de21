"""Warnings about a structure whose numbers look as if they were in another unit."""

from collections.abc import Iterator

from sidmacib.mechanics.assembly import Assembly
from sidmacib.structure.blocks import Block
from sidmacib.unit_warnings import STIFFNESS, STRENGTH, Value, beyond, rough

BLOCK = (1e-3, 50.0)  # m, diagonal of a block
DENSITY = (100.0, 3e4)  # kg/m3: below are kN/m3 and t/m3
MOST = 5  # lines: where one block is in another unit, all are


def structure_warnings(assembly: Assembly) -> list[str]:
    """One line each for numbers of free blocks and of interfaces; the first few of them."""
    values: list[Value] = []
    for piece in assembly.pieces:
        if isinstance(piece, Block) and not piece.fixed:
            values.append((f"{piece.name}: diagonal", piece.size, BLOCK, "m"))
            values.append((f"{piece.name}: density", piece.density, DENSITY, "kg/m3"))
    return [*beyond(values), *_of_faces(assembly)][:MOST]


def _of_faces(assembly: Assembly) -> Iterator[str]:
    """Of each material of a face, named after the first that has it."""
    named = {face.material: face.name for face in reversed(assembly.faces)}
    for law, name in named.items():
        yield from beyond(
            [
                (f"{name}: cohesion", law.cohesion, STRENGTH, "Pa"),
                (f"{name}: tensile strength", law.tensile_strength, STRENGTH, "Pa"),
                (f"{name}: normal stiffness", law.normal_stiffness, STIFFNESS, "Pa/m"),
                (f"{name}: shear stiffness", law.shear_stiffness, STIFFNESS, "Pa/m"),
            ]
        )
        yield from rough(
            {f"{name}: friction": law.friction, f"{name}: bond_friction": law.bond_friction}
        )
