"""Surfaces from files of Rhino (3dm), by the package rhino3dm, which is optional."""

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.structure.files.repair import Face, Surface

LENGTHS = {  # m
    "Millimeters": 1e-3,
    "Centimeters": 1e-2,
    "Decimeters": 0.1,
    "Meters": 1.0,
    "Inches": 0.0254,
    "Feet": 0.3048,
}


def surfaces_in_3dm(path: Path) -> tuple[dict[str, Surface], float]:
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
