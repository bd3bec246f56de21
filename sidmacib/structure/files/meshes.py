"""Blocks from files of triangle meshes: OBJ, PLY and STL."""

from pathlib import Path

import numpy as np
import trimesh

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.structure.blocks import Block, require_near
from sidmacib.structure.files.repair import Face, bodies_in, repaired
from sidmacib.validation import refused

SUFFIXES = (".obj", ".ply", ".stl")
Surface = tuple[Floats, list[Face]]  # vertices, (V, 3), and faces: numbers of these


def blocks_from_mesh(path: Path, density: float, scale: float = 1.0) -> dict[str, Block]:
    """The bodies in a file, by the name of each object of an OBJ file, or by number from 1.

    ``density`` in kg/m3; ``scale``: m per unit of the file. See `repaired` and `bodies_in`.
    ValueError if the file has no such mesh, or a body is not closed.
    """
    surfaces = _surfaces(path)
    try:
        if path.suffix.lower() != ".obj" or len(surfaces) == 1:
            surfaces = _numbered(surfaces)
        return {
            name: repaired(name, scale * places, faces, density)
            for name, (places, faces) in sorted(surfaces.items())
        }
    except ValueError as error:
        raise ValueError(f"file: {path.name}: {error}") from None


def _surfaces(path: Path) -> dict[str, Surface]:
    """The surface of each object in a file, by its name."""
    if not path.is_file():
        raise refused("file", str(path), "a file that is there")
    if path.suffix.lower() not in SUFFIXES:
        raise refused("file", path.name, f"a file that ends in {', '.join(SUFFIXES)}")
    try:
        loaded = trimesh.load_scene(
            path, process=False, split_objects=True, group_material=False, skip_materials=True
        )
    except (OSError, ValueError, IndexError, KeyError, TypeError):
        raise ValueError(f"file: {path.name}: is no mesh that can be read") from None
    found: dict[str, Surface] = {}
    for name, mesh in loaded.geometry.items():
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            places, triangles = np.asarray(mesh.vertices, float), np.asarray(mesh.faces)
            _require_corners(f"file: {path.name}", triangles, len(places))
            require_near(f"file: {path.name}", places)
            found[name] = places, [(a, b, c) for a, b, c in triangles.tolist()]
    if not found:
        raise ValueError(f"file: {path.name}: has no triangles")
    return found


def _numbered(surfaces: dict[str, Surface]) -> dict[str, Surface]:
    """The bodies of all ``surfaces``, by numbers from 1."""
    found: list[Surface] = []
    for surface in surfaces.values():
        places, bodies = bodies_in(*surface)
        found += [(places, body) for body in bodies]
    return {str(number): body for number, body in enumerate(found, 1)}


def _require_corners(what: str, triangles: Integers, vertices: int) -> None:
    """ValueError, which begins with ``what``, for a corner that is none of the ``vertices``."""
    wrong = triangles[(triangles < 0) | (triangles >= vertices)]
    if len(wrong):
        raise ValueError(f"{what}: has a face with vertex {wrong[0]}; it has 0 to {vertices - 1}")
