"""Structures for ParaView: blocks with their motion, and interfaces with what they carry."""

from collections.abc import Iterator, Sequence
from typing import Any

import meshio
import numpy as np

from sidmacib.mechanics.assembly import Assembly, Floats, Piece
from sidmacib.mechanics.polygons import Polygon
from sidmacib.structure.blocks import Block, Compound
from sidmacib.structure.files.structure_file import structure_of
from workflow.run.step import Arguments, FileLists, step
from workflow.structures.case import StructureCase
from workflow.structures.record import StructureRecord, read_structure_records

NUMBERS = (
    *("normal_N", "shear_N", "torsion_Nm", "bending_Nm", "utilisation", "bonded_share"),
    "area_m2",
)


def blocks_mesh(assembly: Assembly, record: StructureRecord) -> meshio.Mesh:
    """The faces of all blocks as polygons, with displacements (m) and the number of the block."""
    points: list[Floats] = []
    moves: list[Floats] = []
    cells: list[tuple[str, Any]] = []
    numbers: list[Floats] = []
    count = 0
    rows = record.blocks or [None] * len(assembly.pieces)
    for number, (piece, row) in enumerate(zip(assembly.pieces, rows, strict=True)):
        move = np.array(row.move if row is not None and row.move else np.zeros(6))
        for outline in outlines(piece):
            points.append(outline)
            moves.append(move[:3] + np.cross(move[3:], outline - piece.centre))
            cells.append(_cell(count, len(outline)))
            numbers.append(np.array([float(number)]))
            count += len(outline)
    return meshio.Mesh(
        np.vstack(points),
        cells,
        point_data={"displacement_m": np.vstack(moves)},
        cell_data={"block": numbers},
    )


def outlines(piece: Piece) -> Iterator[Floats]:
    """The faces of a piece, (K, 3) in m each."""
    solids: Sequence[Block] = ()
    if isinstance(piece, Compound):
        solids = piece.solids
    elif isinstance(piece, Block):
        solids = (piece,)
    for solid in solids:
        yield from solid.outlines


def interfaces_mesh(assembly: Assembly, record: StructureRecord) -> meshio.Mesh:
    """The interfaces as polygons, with what they carry; nan where nothing is known."""
    points, cells = [], []
    count = 0
    for face in assembly.faces:
        assert isinstance(face, Polygon)
        cells.append(_cell(count, len(face.corners)))
        points.append(face.corners)
        count += len(face.corners)
    rows = record.interfaces or [None] * len(assembly.faces)
    data = {
        name: [np.array([_number(row, name)]) for row in rows]  # a block of cells for each
        for name in NUMBERS
    }
    return meshio.Mesh(np.vstack(points), cells, cell_data=data)


def _cell(first: int, corners: int) -> tuple[str, Any]:
    """A polygon of so many ``corners``, whose points begin with the ``first``."""
    kind = {3: "triangle", 4: "quad"}.get(corners, "polygon")
    return kind, np.arange(first, first + corners).reshape(1, -1)


def _number(row: Any, name: str) -> float:
    value = None if row is None else getattr(row, name)
    return float("nan") if value is None else float(value)


def run(arguments: Arguments, inputs: FileLists, outputs: Arguments) -> None:
    """Write two files for each case."""
    found = {record.id: record for record in read_structure_records(inputs["records"])}
    paths = {path.name: path for path in outputs["files"]}
    for case in map(StructureCase.from_json, arguments["cases"]):
        assembly, record = structure_of(case.description).assembly, found[case.id]
        for part, mesh in (("blocks", blocks_mesh), ("interfaces", interfaces_mesh)):
            mesh(assembly, record).write(paths[f"{case.name}-{case.model}-{part}.vtu"])


if __name__ == "__main__":
    step(run)
