"""Pieces that move, and what their faces carry, for ParaView.

The load path of a joint's case is made by the static model, cheap enough to be walked again: each
equilibrium has two files, pieces and nodes, and two collections (`.pvd`) put them in the order of
their load. A case of a structure has two files, from its record: blocks and interfaces.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np

from analysis.paths import displacements
from sidmacib.engines.results import force_to_stress
from sidmacib.joint.pieces import upper_block
from sidmacib.mechanics.assembly import Assembly, Cuboid, Floats, Kind, Piece
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.mechanics.polygons import Polygon
from sidmacib.mechanics.solution import Equilibrium
from sidmacib.mechanics.static.peaks import lowest_peak
from sidmacib.structure.analysis.forces import InterfaceRow
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
Shape = tuple[str, Floats]  # kind of a cell, and its corners in m, (K, 3)


def write_path(case: JointCase, folder: Path) -> list[Path]:
    """Write the path of ``case`` into ``folder``; returns the two collections, pieces first.

    `sidmacib.errors.CapacityError` if the joint carries nothing.
    """
    problem = case.subject.problem()
    assembly, solution = problem.assembly, lowest_peak(*problem)
    above = set(upper_block(case.subject.joint))
    upper = [np.array([float(piece.name in above)]) for piece in assembly.pieces]
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.vtu"):
        old.unlink()
    files: dict[str, list[tuple[float, str]]] = {"pieces": [], "nodes": []}
    for number, point in enumerate(solution.path):
        moved = displacements(assembly, point)
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
    shapes: list[Shape] = []
    shifts: list[Floats] = []
    numbers: list[Floats] = []
    for number, (piece, motion) in enumerate(zip(assembly.pieces, moved, strict=True)):
        for kind, corners in _shapes(piece):
            shapes.append((kind, corners))
            shifts.append(motion[:3] + np.cross(motion[3:], corners - piece.centre))
            numbers.append(np.array([float(number)]))
    return _mesh(shapes, {"displacement_m": np.vstack(shifts)}, {name: numbers})


def _shapes(piece: Piece) -> Iterator[Shape]:
    """The cells of a piece."""
    if isinstance(piece, Cuboid):
        low, high = np.array(piece.low), np.array(piece.high)
        yield "hexahedron", low + CORNERS * (high - low)
    for solid in solids_of(piece):
        for outline in solid.outlines:
            yield _polygon(outline)


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


def interfaces_mesh(assembly: Assembly, rows: Sequence[InterfaceRow]) -> meshio.Mesh:
    """The interfaces as polygons, with what they carry; nan where there are no ``rows``."""
    shapes = []
    for face in assembly.faces:
        assert isinstance(face, Polygon)
        shapes.append(_polygon(face.corners))
    known: Sequence[InterfaceRow | None] = rows or [None] * len(shapes)
    data = {  # None becomes nan
        name: [np.array([getattr(row, name, None)], dtype=float) for row in known]
        for name in NUMBERS
    }
    return _mesh(shapes, {}, data)


def _polygon(corners: Floats) -> Shape:
    return {3: "triangle", 4: "quad"}.get(len(corners), "polygon"), corners


def _mesh(
    shapes: Sequence[Shape],
    point_data: Mapping[str, Floats],
    cell_data: Mapping[str, Sequence[Floats]],
) -> meshio.Mesh:
    """A mesh of cells that share no points; the data of each cell are a block of their own."""
    points = np.vstack([corners for _, corners in shapes])
    ends = np.cumsum([len(corners) for _, corners in shapes])
    numbers = np.split(np.arange(len(points)), ends[:-1])
    cells = [(kind, own[np.newaxis]) for (kind, _), own in zip(shapes, numbers, strict=True)]
    return meshio.Mesh(points, cells, point_data, cell_data)


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
    found = {record.folder: record.part for record in read_records(inputs["records"])}
    paths = {path.name: path for path in outputs["files"]}
    for case in map(StructureCase.from_json, arguments["cases"]):
        assembly, part = case.subject.problem().assembly, found[case.folder]
        still = (0.0,) * 6  # where the model gives no motion
        moves = [block.move or still for block in part.blocks] or [still] * len(assembly.pieces)
        for name, mesh in (
            ("blocks", pieces_mesh(assembly, np.array(moves), "block")),
            ("interfaces", interfaces_mesh(assembly, part.interfaces)),
        ):
            mesh.write(paths[f"{case.name}-{case.model}-{name}.vtu"])


if __name__ == "__main__":
    step(run)
