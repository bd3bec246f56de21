"""Blocks from files of meshes: OBJ, PLY, STL, OFF and Rhino's 3dm."""

from pathlib import Path

import numpy as np
import trimesh

from sidmacib.mechanics.assembly import Floats
from sidmacib.structure.blocks import Block, require_near
from sidmacib.structure.files.obj import surfaces_in_obj
from sidmacib.structure.files.repair import AS_IT_IS, Surface, bodies_in, repaired
from sidmacib.structure.files.rhino import surfaces_in_3dm
from sidmacib.validation import refused

SUFFIXES = (".obj", ".ply", ".stl", ".off", ".3dm")
NAMED = (".obj", ".3dm")  # have objects with names


def blocks_from_mesh(
    path: Path, density: float, turn: Floats = AS_IT_IS, unit: float | None = None
) -> dict[str, Block]:
    """The bodies in a file, by the name of each object of an OBJ or 3dm file, or by number from 1.

    ``density`` in kg/m3; ``turn``, (3, 3), applied to coordinates; ``unit``: m per unit of the
    file, by default that of a 3dm file, else 1. See `repaired` and `bodies_in`. ValueError if the
    file has no such mesh, or a body is not closed.
    """
    if not path.is_file():
        raise refused("file", str(path), "a file that is there")
    if path.suffix.lower() == ".3dm":
        surfaces, of_file = surfaces_in_3dm(path)
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
        found = surfaces_in_obj(path) if path.suffix.lower() == ".obj" else _triangles(path)
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
