"""Blocks that a structure's file takes from other files: meshes, Rhino, COMPAS.

Meshes are OBJ, PLY, STL, OFF, and 3dm of Rhino by the package rhino3dm. Faces of OBJ files may have
any number of vertices, and be folded: a library that cuts them into triangles about their first
vertex cuts through the folds.
"""

import importlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
import trimesh
from pydantic import BeforeValidator, StrictBool, model_validator

from sidmacib.errors import lacks
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import MEASURED_IN, Number, shown
from sidmacib.reading import Keys, Text
from sidmacib.structure.blocks import Block, require_near
from sidmacib.structure.files.compas import DENSITIES, read_compas, read_compas_interfaces
from sidmacib.structure.files.repair import AS_IT_IS, Face, Surface, bodies_in, chosen, repaired
from sidmacib.structure.interfaces import Interface, mean_size
from sidmacib.structure.warnings import BLOCK
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
    "Yards": 0.9144,
}
Unit = Literal["m", "cm", "mm", "in", "ft"]
UPWARDS = {  # what turns a file's coordinates so that z is up
    "x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}


def blocks_from_mesh(
    path: Path, density: float, turn: Floats = AS_IT_IS, unit: float | None = None
) -> dict[str, Block]:
    """The bodies in a file, by the name of each object of an OBJ or 3dm file, or by number from 1.

    ``density`` in kg/m3; ``turn``, (3, 3), applied to coordinates; ``unit``: m per unit of the
    file, by default that of a 3dm file, else 1. See `repaired` and `bodies_in`. ValueError if the
    file has no such mesh, or a body is not closed.
    """
    suffix, of_file = path.suffix.lower(), 1.0
    if suffix not in SUFFIXES:
        raise refused("file", path.name, f"a file that ends in {', '.join(SUFFIXES)}")
    try:
        if suffix == ".3dm":
            surfaces, name = _in_3dm(path)
            if unit is None and name not in LENGTHS:
                raise ValueError(f"its unit is {name}; give unit (m, cm, mm, in, ft) or scale")
            of_file = LENGTHS.get(name, 1.0)
        else:
            surfaces = _surfaces(path)
        if suffix not in NAMED or len(surfaces) == 1:
            surfaces = _numbered(surfaces)
        frame = turn * (of_file if unit is None else unit)
        return {
            name: repaired(name, places @ frame.T, faces, density)
            for name, (places, faces) in sorted(surfaces.items())
        }
    except ValueError as error:
        raise ValueError(f"file: {path.name}: {error}") from None


def _surfaces(path: Path) -> dict[str, Surface]:
    """The surface of each object in a file, by its name."""
    try:
        found = _in_obj(path) if path.suffix.lower() == ".obj" else _triangles(path)
    except (OSError, ValueError, IndexError, KeyError, TypeError):
        raise ValueError("is no mesh that can be read") from None
    if not found:
        raise ValueError("has no triangles")
    for places, faces in found.values():
        corners, last = np.concatenate(faces), len(places) - 1
        if len(wrong := corners[(corners < 0) | (corners > last)]):
            raise ValueError(
                f"has a face with vertex {wrong[0]}; it has 0 to {last}; export the mesh again"
            )
        require_near("vertices", places)
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


def _in_3dm(path: Path) -> tuple[dict[str, Surface], str]:
    """The surface of each mesh, polysurface or extrusion by its name, and the unit of the file.

    Objects without a name are numbered from 1. Of polysurfaces and extrusions the meshes count that
    Rhino keeps to draw them. ValueError if it cannot be read.
    """
    try:
        rhino: Any = importlib.import_module("rhino3dm")
    except ImportError:
        raise lacks("rhino3dm", "rhino") from None
    model = rhino.File3dm.Read(str(path))
    if model is None:
        raise ValueError("is no file of Rhino that can be read")
    found: dict[str, Surface] = {}
    for number, each in enumerate(model.Objects, 1):
        if each.Attributes.IsInstanceDefinitionObject:  # a part that only instances place
            continue
        parts, solid = [each.Geometry], isinstance(each.Geometry, rhino.Brep | rhino.Extrusion)
        if isinstance(each.Geometry, rhino.Brep):
            parts = list(each.Geometry.Faces)
        meshes = [part.GetMesh(rhino.MeshType.Any) for part in parts] if solid else parts
        meshes = [mesh for mesh in meshes if isinstance(mesh, rhino.Mesh)]
        if isinstance(each.Geometry, rhino.SubD | rhino.InstanceReference):
            words = "is a SubD or an instance of a block; make a mesh of it in Rhino"
            raise ValueError(f"{each.Attributes.Name or number}: {words}")
        if solid and not meshes:
            words = "has no mesh; shade the view in Rhino and save again"
            raise ValueError(f"{each.Attributes.Name or number}: {words}")
        if meshes:
            name = each.Attributes.Name or str(number)
            found[name if name not in found else f"{name}-{number}"] = _joined(meshes)
    if not found:
        raise ValueError("has no meshes, polysurfaces or extrusions")
    return found, str(model.Settings.ModelUnitSystem).rpartition(".")[2]


def _joined(meshes: list[Any]) -> Surface:
    places: list[tuple[float, float, float]] = []
    faces: list[Face] = []
    for mesh in meshes:
        start = len(places)
        places += [(vertex.X, vertex.Y, vertex.Z) for vertex in mesh.Vertices]
        for number in range(mesh.Faces.Count):
            face = mesh.Faces[number]  # a triangle has its last vertex twice
            faces.append(tuple(start + vertex for vertex in dict.fromkeys(face)))
    return np.array(places, float).reshape(-1, 3), faces


def _held(value: Any) -> Any:
    if not isinstance(value, bool | list | tuple):
        raise ValueError(f"{shown(value)} is not allowed; it must be true, false, or a list")
    return value


def metres(unit: Unit) -> float:
    """M per ``unit``."""
    return MEASURED_IN["m"].units[unit]


def require_likely(size: float, what: str) -> None:
    """ValueError for ``what`` if its ``size`` (m) is so large that metres are hardly meant."""
    if size > BLOCK.likely[1]:
        others = ", ".join(each for each in get_args(Unit) if each != "mm")
        raise ValueError(f"{what} would be {size:.4g} m across; say unit: mm, or {others}")


class FileSection(Keys):
    """Blocks from OBJ, PLY, STL or OFF files, from Rhino's 3dm, or from the JSON of COMPAS."""

    file: Text
    """its path, from the folder of this file; with `*` all that fit, a block or more from each"""
    unit: Unit | None = None
    """unit of its lengths: by default that of a 3dm file, else m"""
    scale: Annotated[float, Number(above=0)] | None = None
    """m per unit of the file, in place of `unit`"""
    up: Literal["x", "y", "z"] = "z"
    """its axis that points upwards"""
    density: Annotated[float, DENSITIES] = 2000.0
    fixed: Annotated[StrictBool | tuple[Text, ...], BeforeValidator(_held)] | None = None
    """whether the blocks cannot move, or names or patterns of those that cannot; of COMPAS by
    default its supports"""

    fixed_below: Annotated[float, Number(unit="m")] | None = None
    """height z that blocks reach below which cannot move, beside those that `fixed` names"""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if self.unit is not None and self.scale is not None:
            raise ValueError("scale: must not be given beside unit")
        return self

    @property
    def length(self) -> float | None:
        """M per unit of the file, if it is given."""
        return self.scale if self.unit is None else metres(self.unit)

    @property
    def assumes_density(self) -> bool:
        """Whether blocks have the default density because nothing says another."""
        return "density" not in self.model_fields_set and not self.file.lower().endswith(".json")

    def blocks(self, name: str, folder: Path) -> list[Block]:
        """The blocks, whose names begin with ``name``; ValueError."""
        try:
            paths = sorted(folder.glob(self.file)) if "*" in self.file else [folder / self.file]
            if not paths:
                raise refused("file", self.file, "a pattern that fits a file")
            several = len(paths) > 1
            begin = [f"{name}-{path.stem}" if several else name for path in paths]
            found = [b for each in zip(begin, paths, strict=True) for b in self._in(*each)]
            if several or not self.file.endswith(".json"):  # of COMPAS nodes are fixed
                found = self._fixed(name, found)
            if self.length is None and not self.file.endswith(".3dm"):
                require_likely(mean_size(found), f"file: {self.file}: its blocks")
            if (height := self.fixed_below) is None:
                return found
            return [replace(b, fixed=b.fixed or b.places[:, 2].min() < height) for b in found]
        except ValueError as error:
            raise ValueError(f"blocks.{name}.{error}") from None

    def interfaces(self, folder: Path, blocks: Sequence[Block]) -> tuple[Interface, ...]:
        """Those that a file of COMPAS brings between its ``blocks``."""
        return read_compas_interfaces(folder / self.file, blocks, self.frame)

    @property
    def is_compas(self) -> bool:
        """Whether the file is one of COMPAS."""
        return self.file.endswith(".json") and "*" not in self.file

    @property
    def frame(self) -> Floats:
        """Turns the file's coordinates into m with z upwards, (3, 3)."""
        return np.array(UPWARDS[self.up], float) * (self.length or 1.0)

    def _in(self, name: str, path: Path) -> list[Block]:
        if not path.is_file():
            raise refused("file", self.file, "a file that is there")
        if path.suffix == ".json":
            if isinstance(self.fixed, bool):
                raise refused("fixed", self.fixed, "a list of nodes")
            fixed = () if self.fixed is None and self.fixed_below is not None else self.fixed
            return list(read_compas(path, self.density, fixed, name, self.frame))
        turn = np.array(UPWARDS[self.up], float)
        bodies = blocks_from_mesh(path, self.density, turn, self.length)
        alone = len(bodies) == 1
        return [replace(b, name=name if alone else f"{name}-{k}") for k, b in bodies.items()]

    def _fixed(self, name: str, blocks: list[Block]) -> list[Block]:
        if self.fixed is None:
            return blocks
        if isinstance(self.fixed, bool):
            return [replace(block, fixed=self.fixed) for block in blocks]
        names = [block.name.removeprefix(f"{name}-") for block in blocks]
        held = chosen(self.fixed, names, "true, false, or a list of")
        return [replace(b, fixed=own in held) for b, own in zip(blocks, names, strict=True)]
