"""Blocks from files of triangle meshes: OBJ, PLY and STL."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import trimesh

from sidmacib.mechanics.assembly import Floats, Integers
from sidmacib.structure.blocks import FLAT, Block, off_plane, require_few_faces, require_near
from sidmacib.structure.crossing import grouped
from sidmacib.validation import refused

SUFFIXES = (".obj", ".ply", ".stl")
# Largest angle between triangles of one plane: coordinates in STL files have seven digits.
SAME_PLANE = 1e-4


def blocks_from_mesh(path: Path, density: float, scale: float = 1.0) -> dict[str, Block]:
    """The bodies in a file, by the name of each object of an OBJ file, or by number from 1.

    ``density`` in kg/m3; ``scale``: m per unit of the file. Triangles in one plane become one face.
    In PLY and STL files, triangles that share an edge with no third one are of one body. ValueError
    if the file has no such mesh, or a body is not closed.
    """
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
    objects = {
        name: mesh for name, mesh in loaded.geometry.items() if isinstance(mesh, trimesh.Trimesh)
    }
    for mesh in objects.values():
        _require_corners(f"file: {path.name}", np.asarray(mesh.faces), len(mesh.vertices))
        require_near(f"file: {path.name}", np.asarray(mesh.vertices))
    if path.suffix.lower() != ".obj" or len(objects) == 1:
        bodies = [body for mesh in objects.values() for body in _bodies(mesh)]
        objects = {str(number): body for number, body in enumerate(bodies, 1)}
    if not objects:
        raise ValueError(f"file: {path.name}: has no triangles")
    found = {}
    for name, mesh in sorted(objects.items()):
        try:
            found[name] = _block(name, mesh, density, scale)
        except ValueError as error:
            hint = "; bodies that share corners need an OBJ file with an object for each"
            raise ValueError(
                f"file: {path.name}: {error}{hint * (not mesh.is_watertight)}"
            ) from None
    return found


def _require_corners(what: str, triangles: Integers, vertices: int) -> None:
    """ValueError, which begins with ``what``, for a corner that is none of the ``vertices``."""
    wrong = triangles[(triangles < 0) | (triangles >= vertices)]
    if len(wrong):
        raise ValueError(f"{what}: has a face with vertex {wrong[0]}; it has 0 to {vertices - 1}")


def _bodies(mesh: trimesh.Trimesh) -> Iterator[trimesh.Trimesh]:
    """Parts of ``mesh`` that hang together by edges of two triangles, in the order of the file.

    Corners at one place are joined, unless the parts are closed without that.
    """
    apart = _parts(mesh)
    if not all(part.is_watertight for part in apart):
        mesh = mesh.copy()
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        apart = _parts(mesh)
    yield from apart


def _parts(mesh: trimesh.Trimesh) -> list[trimesh.Trimesh]:
    labels = grouped(len(mesh.faces), mesh.face_adjacency)
    return [
        trimesh.Trimesh(mesh.vertices, mesh.faces[labels == label], process=False)
        for label in range(labels.max(initial=-1) + 1)
    ]


def _block(name: str, mesh: trimesh.Trimesh, density: float, scale: float) -> Block:
    mesh = mesh.copy()
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    mesh.update_faces(mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    with np.errstate(invalid="ignore", divide="ignore"):  # of a mesh without volume: an error below
        if mesh.volume < 0.0:
            mesh.invert()
    labels = grouped(len(mesh.faces), mesh.face_adjacency[mesh.face_adjacency_angles < SAME_PLANE])
    require_few_faces(name, int(labels.max(initial=-1)) + 1)
    faces = [
        face
        for label in range(labels.max(initial=-1) + 1)
        for face in _outline(mesh.vertices, mesh.faces[labels == label])
    ]
    vertices = tuple(
        (float(x), float(y), float(z)) for x, y, z in scale * np.asarray(mesh.vertices)
    )
    return Block(name, vertices, tuple(faces), density)


def _outline(places: Floats, triangles: Integers) -> list[tuple[int, ...]]:
    """The outline of ``triangles``, (K, 3); these themselves if it has a hole or is not plane."""
    edges = {(a, b) for t in triangles.tolist() for a, b in zip(t, (*t[1:], t[0]), strict=True)}
    border = [(a, b) for a, b in edges if (b, a) not in edges]
    onward, outline = dict(border), [min(a for a, _ in border or edges)]
    while len(outline) < len(border) and (after := onward[outline[-1]]) != outline[0]:
        outline.append(after)
    corners = places[outline]
    closed = len(outline) == len(border) and onward[outline[-1]] == outline[0]
    if closed and off_plane(corners) < FLAT * np.ptp(corners, axis=0).max():
        return [tuple(outline)]
    return [tuple(triangle) for triangle in triangles.tolist()]
