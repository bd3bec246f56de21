"""Blocks from files of meshes: OBJ, PLY, STL, OFF, and 3dm of Rhino by the package rhino3dm.

Faces of OBJ files may have any number of vertices, and be folded: a library that cuts them into
triangles about their first vertex cuts through the folds.
"""

import importlib
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import Block, require_near
from sidmacib.structure.files.repair import AS_IT_IS, Face, Surface, bodies_in, repaired
from sidmacib.validation import refused

SUFFIXES = (".obj", ".ply", ".stl", ".off", ".3dm")
NAMED = (".obj", ".3dm")  # have objects with names
LENGTHS = {  # m
    "Millimeters": 1e-3,
    "Centimeters": 1e-2,
    "Decimeters": 0.1,
    "Meters": 1.0,
    "Inches": 0.0254,
    "Feet": 0.3048,
}


def blocks_from_mesh(
    path: Path, density: float, turn: Floats = AS_IT_IS, unit: float | None = None
) -> dict[str, Block]:
    """The bodies in a file, by the name of each object of an OBJ or 3dm file, or by number from 1.

    ``density`` in kg/m3; ``turn``, (3, 3), applied to coordinates; ``unit``: m per unit of the
    file, by default that of a 3dm file, else 1. See `repaired` and `bodies_in`. ValueError if the
    file has no such mesh, or a body is not closed.
    """
    if path.suffix.lower() == ".3dm":
        surfaces, of_file = _in_3dm(path)
    else:
        surfaces, of_file = _surfaces(path), 1.0
    frame = turn * (of_file if unit is None else unit)
    try:
        if path.suffix.lower() not in NAMED or len(surfaces) == 1:
            surfaces = _numbered(surfaces)
        return {
            name: repaired(name, places @ frame.T, faces, density)
            for name, (places, faces) in sorted(surfaces.items())
        }
    except ValueError as error:
        raise ValueError(f"file: {path.name}: {error}") from None


def _surfaces(path: Path) -> dict[str, Surface]:
    """The surface of each object in a file, by its name."""
    if path.suffix.lower() not in SUFFIXES:
        raise refused("file", path.name, f"a file that ends in {', '.join(SUFFIXES)}")
    try:
        found = _in_obj(path) if path.suffix.lower() == ".obj" else _triangles(path)
    except (OSError, ValueError, IndexError, KeyError, TypeError):
        raise ValueError(f"file: {path.name}: is no mesh that can be read") from None
    if not found:
        raise ValueError(f"file: {path.name}: has no triangles")
    for places, faces in found.values():
        corners, last = np.concatenate(faces), len(places) - 1
        if len(wrong := corners[(corners < 0) | (corners > last)]):
            words = f"has a face with vertex {wrong[0]}; it has 0 to {last}"
            raise ValueError(f"file: {path.name}: {words}")
        require_near(f"file: {path.name}", places)
    return found


def _in_obj(path: Path) -> dict[str, Surface]:
    """The vertices, (V, 3), and the faces of each object, by its name; that of the file without.

    ValueError for numbers that cannot be read.
    """
    places: list[list[float]] = []
    faces: dict[str, list[Face]] = {}
    name = path.name
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    for line in text.splitlines():
        key, *words = line.split() or [""]
        if key == "v":
            x, y, z = map(float, words[:3])
            places.append([x, y, z])
        elif key == "o":
            name = " ".join(words)
        elif key == "f":
            ends = [int(corner.partition("/")[0]) for corner in words]
            face = tuple(end - 1 if end > 0 else end + len(places) for end in ends)
            faces.setdefault(name, []).append(face)
    return {name: (np.array(places).reshape(-1, 3), of) for name, of in faces.items()}


def _triangles(path: Path) -> dict[str, Surface]:
    """The surface of each mesh that trimesh reads."""
    return {
        name: (np.asarray(mesh.vertices, float), [(a, b, c) for a, b, c in mesh.faces.tolist()])
        for name, mesh in trimesh.load_scene(path, process=False).geometry.items()
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)
    }


def _numbered(surfaces: dict[str, Surface]) -> dict[str, Surface]:
    """The bodies of all ``surfaces``, by numbers from 1."""
    found: list[Surface] = []
    for surface in surfaces.values():
        places, bodies = bodies_in(*surface)
        found += [(places, body) for body in bodies]
    return {str(number): body for number, body in enumerate(found, 1)}


def _in_3dm(path: Path) -> tuple[dict[str, Surface], float]:
    """The surface of each mesh, polysurface or extrusion by its name, and m per unit of the file.

    Objects without a name are numbered from 1. Of polysurfaces and extrusions the meshes count that
    Rhino keeps to draw them. ValueError, which names the file, if it cannot be read.
    """
    try:
        rhino: Any = importlib.import_module("rhino3dm")
    except ImportError:
        words = "needs the package rhino3dm: pip install multilock[rhino]"
        raise ValueError(f"file: {path.name}: {words}") from None
    model = rhino.File3dm.Read(str(path))
    if model is None:
        raise ValueError(f"file: {path.name}: is no file of Rhino that can be read")
    found: dict[str, Surface] = {}
    for number, each in enumerate(model.Objects, 1):
        meshes = [mesh for mesh in _meshes(rhino, each.Geometry) if mesh is not None]
        if not meshes:
            if isinstance(each.Geometry, rhino.Brep | rhino.Extrusion):
                words = "has no mesh; shade the view in Rhino and save again"
                raise ValueError(f"file: {path.name}: {each.Attributes.Name or number}: {words}")
            continue
        name = each.Attributes.Name or str(number)
        found[name if name not in found else f"{name}-{number}"] = _joined(meshes)
    if not found:
        raise ValueError(f"file: {path.name}: has no meshes, polysurfaces or extrusions")
    unit = str(model.Settings.ModelUnitSystem).rpartition(".")[2]
    return found, LENGTHS.get(unit, 1.0)


def _meshes(rhino: Any, geometry: Any) -> list[Any]:
    if isinstance(geometry, rhino.Mesh):
        return [geometry]
    if isinstance(geometry, rhino.Extrusion):
        return [geometry.GetMesh(rhino.MeshType.Any)]
    if isinstance(geometry, rhino.Brep):
        return [face.GetMesh(rhino.MeshType.Any) for face in geometry.Faces]
    return []


def _joined(meshes: list[Any]) -> Surface:
    """Several meshes as one surface."""
    places: list[tuple[float, float, float]] = []
    faces: list[Face] = []
    for mesh in meshes:
        start = len(places)
        places += [(vertex.X, vertex.Y, vertex.Z) for vertex in mesh.Vertices]
        for number in range(mesh.Faces.Count):
            face = mesh.Faces[number]  # a triangle has its last vertex twice
            faces.append(tuple(start + vertex for vertex in dict.fromkeys(face)))
    return np.array(places, float).reshape(-1, 3), faces
