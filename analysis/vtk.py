"""A case's load path for ParaView: pieces that move, and stresses at the nodes of all faces.

Each equilibrium has two files, pieces and nodes, and two collections (`.pvd`) put them in the order
of their load. Made by the static model, whose path is cheap enough to be walked again.
"""

from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np

from sidmacib.joint.load_path import load_path
from sidmacib.joint.pieces import upper_block
from sidmacib.mechanics.assembly import Assembly, Floats, Kind
from sidmacib.mechanics.equilibrium import face_frames
from sidmacib.mechanics.solution import Equilibrium
from workflow.joints.case import Case
from workflow.results.files import force_to_stress

CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)


def write_path(case: Case, folder: Path) -> list[Path]:
    """Write the path of ``case`` into ``folder``; returns the two collections, pieces first.

    `sidmacib.errors.CapacityError` if the joint carries nothing.
    """
    assembly, solution = load_path(case.joint, case.loading, case.mesh, case.nodes)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.vtu"):
        old.unlink()
    files: dict[str, list[tuple[float, str]]] = {"pieces": [], "nodes": []}
    for number, point in enumerate(solution.path):
        for kind, mesh in (
            ("pieces", pieces_mesh(case, assembly, point)),
            ("nodes", nodes_mesh(assembly, point)),
        ):
            name = f"{kind}_{number:04}.vtu"
            mesh.write(folder / name)
            files[kind].append((float(point.load), name))
    return [_collection(folder / f"{kind}.pvd", paths) for kind, paths in files.items()]


def pieces_mesh(case: Case, assembly: Assembly, point: Equilibrium) -> meshio.Mesh:
    """The pieces as hexahedra where they are, with their displacement and block (1: upper)."""
    moved = displacements(assembly, point, rigid=case.joint.elastic is None)
    corners, shifts = [], []
    for piece, motion in zip(assembly.cuboids, moved, strict=True):
        low, high = np.array(piece.low), np.array(piece.high)
        place = low + CORNERS * (high - low)
        corners.append(place)
        shifts.append(motion[:3] + np.cross(motion[3:], place - (low + high) / 2.0))
    above = set(upper_block(case.joint))
    count = len(assembly.cuboids)
    return meshio.Mesh(
        np.vstack(corners),
        [("hexahedron", np.arange(8 * count).reshape(count, 8))],
        point_data={"displacement_m": np.vstack(shifts)},
        cell_data={
            "upper": [np.array([float(piece.name in above) for piece in assembly.cuboids])],
            "piece": [np.arange(count, dtype=float)],
        },
    )


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
    moved = np.zeros((len(assembly.cuboids), 6))
    free = [number for number, piece in enumerate(assembly.cuboids) if not piece.fixed]
    if rigid:
        moved[free] = point.unknowns.reshape(len(free), 6)
    return moved


def _collection(path: Path, files: list[tuple[float, str]]) -> Path:
    """A ParaView collection, whose time is the load in N."""
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    whole = ElementTree.SubElement(root, "Collection")
    for load, name in files:
        ElementTree.SubElement(whole, "DataSet", timestep=f"{load:.9g}", part="0", file=name)
    ElementTree.indent(root)
    path.write_bytes(ElementTree.tostring(root, xml_declaration=True) + b"\n")
    return path
