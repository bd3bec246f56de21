"""Pieces that move, and what their faces carry, for ParaView.

The load path of a joint's case is made by the static model, cheap enough to be walked again: each
equilibrium has two files, pieces and nodes, and two collections (`.pvd`) put them in the order of
their load. A case of a structure has two files, from its record: blocks and interfaces.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np

from sidmacib.engines.results import force_to_stress
from sidmacib.joint.loading import posed
from sidmacib.joint.pieces import upper_block
from sidmacib.mechanics.assembly import Assembly, Cuboid, Floats, Kind, Piece
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.structure.analysis.rows import InterfaceRow
from sidmacib.structure.blocks import solids_of
from workflow.case import JointCase, StructureCase
from workflow.results import read_records
from workflow.step import Arguments, FileLists, step

CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)
NUMBERS = (
    *("normal_N", "shear_N", "torsion_Nm", "bending_Nm", "utilisation", "bonded_share"),
    "area_m2",
)
Cell = tuple[str, Any]  # kind, and numbers of points, (1, K)


def write_path(case: JointCase, folder: Path) -> list[Path]:
    """Write the path of ``case`` into ``folder``; returns the two collections, pieces first.

    `sidmacib.errors.CapacityError` if the joint carries nothing.
    """
    subject = case.subject
    problem = posed(subject.joint, subject.loading, subject.mesh, subject.nodes)
    assembly, solution = problem.assembly, lowest_peak(*problem)
    above = set(upper_block(subject.joint))
    upper = [np.array([float(piece.name in above)]) for piece in assembly.pieces]
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.vtu"):
        old.unlink()
    files: dict[str, list[tuple[float, str]]] = {"pieces": [], "nodes": []}
    for number, point in enumerate(solution.path):
        moved = displacements(assembly, point, rigid=subject.joint.elastic is None)
        pieces = pieces_mesh(assembly, moved, "piece")
        pieces.cell_data["upper"] = upper
        for kind, mesh in (("pieces", pieces), ("nodes", nodes_mesh(assembly, point))):
            name = f"{kind}_{number:04}.vtu"
            mesh.write(folder / name)
            files[kind].append((float(point.load), name))
    return [_collection(folder / f"{kind}.pvd", paths) for kind, paths in files.items()]


def pieces_mesh(assembly: Assembly, moved: Floats, name: str) -> meshio.Mesh:
    """The pieces where they are, with their displacement and, as ``name``, their number.

    Cuboids are hexahedra, others the polygons of their faces. ``moved``: displacement (m) and
    rotation of each piece, (P, 6).
    """
    points: list[Floats] = []
    shifts: list[Floats] = []
    cells: list[Cell] = []
    numbers: list[Floats] = []
    for number, (piece, motion) in enumerate(zip(assembly.pieces, moved, strict=True)):
        for kind, corners in _shapes(piece):
            cells.append(_cell(kind, sum(map(len, points)), len(corners)))
            points.append(corners)
            shifts.append(motion[:3] + np.cross(motion[3:], corners - piece.centre))
            numbers.append(np.array([float(number)]))
    return meshio.Mesh(
        np.vstack(points),
        cells,
        point_data={"displacement_m": np.vstack(shifts)},
        cell_data={name: numbers},
    )


def _shapes(piece: Piece) -> Iterator[tuple[str, Floats]]:
    """The cells of a piece: kind, and corners in m, (K, 3)."""
    if isinstance(piece, Cuboid):
        low, high = np.array(piece.low), np.array(piece.high)
        yield "hexahedron", low + CORNERS * (high - low)
    for solid in solids_of(piece):
        for outline in solid.outlines:
            yield _polygon(len(outline)), outline


def nodes_mesh(assembly: Assembly, point: Equilibrium) -> meshio.Mesh:
    """The contact nodes as vertices, with what they carry."""
    nodes = assembly.nodes
    stress = force_to_stress(nodes, face_frames(assembly), point.force)
    inner = np.array([face.kind is Kind.INNER for face in assembly.faces])[nodes.face]
    return meshio.Mesh(
        nodes.position,
        [("vertex", np.arange(len(nodes.area)).reshape(-1, 1))],
        point_data={
            "normal_Pa": stress[:, 0],
            "shear_Pa": stress[:, 1:],
            "bonded": point.state.bonded.astype(float),
            "inner": inner.astype(float),
            "face": nodes.face.astype(float),
        },
    )


def displacements(assembly: Assembly, point: Equilibrium, rigid: bool = True) -> Floats:
    """Displacement (m) and rotation of each piece, shape (P, 6); none of fixed or elastic ones."""
    moved = np.zeros((len(assembly.pieces), 6))
    free = [number for number, piece in enumerate(assembly.pieces) if not piece.fixed]
    if rigid:
        moved[free] = point.unknowns.reshape(len(free), 6)
    return moved


def interfaces_mesh(assembly: Assembly, rows: Sequence[InterfaceRow]) -> meshio.Mesh:
    """The interfaces as polygons, with what they carry; nan where there are no ``rows``."""
    points: list[Floats] = []
    cells: list[Cell] = []
    for face in assembly.faces:
        assert isinstance(face, Polygon)
        cells.append(_cell(_polygon(len(face.corners)), sum(map(len, points)), len(face.corners)))
        points.append(face.corners)
    known: Sequence[InterfaceRow | None] = rows or [None] * len(cells)
    # A block of cells for each; None becomes nan.
    data = {
        name: [np.array([getattr(row, name, None)], dtype=float) for row in known]
        for name in NUMBERS
    }
    return meshio.Mesh(np.vstack(points), cells, cell_data=data)


def _polygon(corners: int) -> str:
    return {3: "triangle", 4: "quad"}.get(corners, "polygon")


def _cell(kind: str, first: int, corners: int) -> Cell:
    """A cell of so many ``corners``, whose points begin with the ``first``."""
    return kind, np.arange(first, first + corners).reshape(1, -1)


def _collection(path: Path, files: list[tuple[float, str]]) -> Path:
    """A ParaView collection, whose time is the load in N."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    whole = ElementTree.SubElement(root, "Collection")
    for load, name in files:
        ElementTree.SubElement(whole, "DataSet", timestep=f"{load:.9g}", part="0", file=name)
    ElementTree.indent(root)
    path.write_bytes(ElementTree.tostring(root, xml_declaration=True) + b"\n")
    return path


def run(arguments: Arguments, inputs: FileLists, outputs: Arguments) -> None:
    """Write two files for each case of a structure."""
    found = {record.id: record.part for record in read_records(inputs["records"])}
    paths = {path.name: path for path in outputs["files"]}
    for case in map(StructureCase.from_json, arguments["cases"]):
        assembly, part = case.subject.problem().assembly, found[case.id]
        still = (0.0,) * 6  # where the model gives no motion
        moves = [block.move or still for block in part.blocks] or [still] * len(assembly.pieces)
        for name, mesh in (
            ("blocks", pieces_mesh(assembly, np.array(moves), "block")),
            ("interfaces", interfaces_mesh(assembly, part.interfaces)),
        ):
            mesh.write(paths[f"{case.name}-{case.model}-{name}.vtu"])


if __name__ == "__main__":
    step(run)
