"""Blocks that a structure's file takes from other files: meshes, Rhino, COMPAS.

Meshes are OBJ, PLY, STL, OFF, and 3dm of Rhino by the package rhino3dm. Faces of OBJ files may have
any number of vertices, and be folded: a library that cuts them into triangles about their first
vertex cuts through the folds.
"""

import importlib
import logging
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
import trimesh
from pydantic import BeforeValidator, StrictBool, model_validator

from sidmacib.errors import lacks
from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import MEASURED_IN, Number, shown
from sidmacib.reading import Keys, Text
from sidmacib.structure.blocks import Block, compact, require_near
from sidmacib.structure.files.bodies import Body, blocks_of, bodies_in
from sidmacib.structure.files.compas import DENSITIES, compas_bodies, read_compas_interfaces
from sidmacib.structure.files.repair import AS_IT_IS, Face, Surface
from sidmacib.structure.interfaces import Interface, mean_size
from sidmacib.structure.warnings import BLOCK
from sidmacib.validation import refused

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # of no use beside our own line
UPWARDS_Y = (".glb", ".gltf")  # by their standard; in metres
NAMED = (".obj", ".3dm", *UPWARDS_Y)  # have objects with names
SUFFIXES = (".obj", ".ply", ".stl", ".off", ".3dm", *UPWARDS_Y)
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


def surfaces_in(
    path: Path, turn: Floats = AS_IT_IS, unit: float | None = None, layers: Sequence[str] = ()
) -> dict[str, Surface]:
    """The surface (m) of each body in a file, by the name of its object, or by number from 1.

    ``turn``, (3, 3), applied to coordinates; ``unit``: m per unit of the file, by default that of a
    3dm file, else 1; ``layers`` of a 3dm file, by default all. See `bodies_in`. ValueError if the
    file has no such mesh.
    """
    suffix, of_file = path.suffix.lower(), 1.0
    if suffix not in SUFFIXES:
        raise refused("file", path.name, f"a file that ends in {', '.join(SUFFIXES)}")
    try:
        if suffix == ".3dm":
            surfaces, name = _in_3dm(path, layers)
            if unit is None and name not in LENGTHS:
                raise ValueError(f"its unit is {name}; give unit (m, cm, mm, in, ft) or scale")
            of_file = LENGTHS.get(name, 1.0)
        else:
            surfaces = _surfaces(path)
        if suffix not in NAMED or len(surfaces) == 1:
            surfaces = _numbered(surfaces)
        frame = turn * (of_file if unit is None else unit)
        return {name: (of[0] @ frame.T, of[1]) for name, of in sorted(surfaces.items())}
    except ValueError as error:
        raise ValueError(f"file: {path.name}: {error}") from None


def _surfaces(path: Path) -> dict[str, Surface]:
    """The surface of each object in a file, by its name."""
    try:
        found = _in_obj(path) if path.suffix.lower() == ".obj" else _triangles(path)
    except (OSError, ValueError, IndexError, KeyError, NameError, TypeError):  # of trimesh, any
        raise ValueError("is no mesh that can be read") from None
    if not found:
        raise ValueError("has no triangles")
    for name, (places, faces) in found.items():
        corners, last = np.concatenate(faces), len(places) - 1
        if len(wrong := corners[(corners < 0) | (corners > last)]):
            raise ValueError(
                f"has a face with vertex {wrong[0]}; it has 0 to {last}; export the mesh again"
            )
        found[name] = own, _ = compact(places, faces)  # vertices of all objects may be together
        require_near("vertices", own)
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
    shared = np.array(places).reshape(-1, 3)
    return {name: (shared, of) for name, of in faces.items()}


def _triangles(path: Path) -> dict[str, Surface]:
    scene = trimesh.load_scene(path, process=False)
    found: dict[str, Surface] = {}
    for name in scene.graph.nodes_geometry:
        matrix, of = scene.graph[name]
        mesh = scene.geometry[of]
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            places = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
            found[name] = np.asarray(places, float), [(a, b, c) for a, b, c in mesh.faces.tolist()]
    return found


def _numbered(surfaces: dict[str, Surface]) -> dict[str, Surface]:
    """The bodies of all ``surfaces``, by numbers from 1."""
    found: list[Surface] = []
    for surface in surfaces.values():
        places, bodies = bodies_in(*surface)
        found += [compact(places, body) for body in bodies]
    return {str(number): body for number, body in enumerate(found, 1)}


def _in_3dm(path: Path, layers: Sequence[str]) -> tuple[dict[str, Surface], str]:
    """The surface of each mesh, polysurface or extrusion by its name, and the unit of the file.

    Objects without a name are called by their layer and numbered from 1. Of polysurfaces and
    extrusions the meshes count that Rhino keeps to draw them. ValueError if it cannot be read.
    """
    try:
        rhino: Any = importlib.import_module("rhino3dm")
    except ImportError:
        raise lacks("rhino3dm", "rhino") from None
    model = rhino.File3dm.Read(str(path))
    if model is None:
        raise ValueError("is no file of Rhino that can be read")
    found: dict[str, Surface] = {}
    used = set()
    for number, each in enumerate(model.Objects, 1):
        layer = str(model.Layers[each.Attributes.LayerIndex].FullPath)
        used.add(layer)
        chosen = not layers or any(fnmatchcase(layer, pattern) for pattern in layers)
        # A part of a definition is only where instances place it.
        if not chosen or each.Attributes.IsInstanceDefinitionObject:
            continue
        name = each.Attributes.Name or f"{layer}-{number}"
        parts, solid = [each.Geometry], isinstance(each.Geometry, rhino.Brep | rhino.Extrusion)
        if isinstance(each.Geometry, rhino.Brep):
            parts = list(each.Geometry.Faces)
        meshes = [part.GetMesh(rhino.MeshType.Any) for part in parts] if solid else parts
        meshes = [mesh for mesh in meshes if isinstance(mesh, rhino.Mesh)]
        if isinstance(each.Geometry, rhino.SubD | rhino.InstanceReference):
            words = "is a SubD or an instance of a block; make a mesh of it in Rhino"
            raise ValueError(f"{name} on layer {layer}: {words}, or choose other layers")
        if solid and not meshes:
            words = "has no mesh; shade the view in Rhino and save again"
            raise ValueError(f"{name} on layer {layer}: {words}, or choose other layers")
        if meshes:
            found[name if name not in found else f"{name}-{number}"] = _joined(meshes)
    if not found:
        on = f" on layers {', '.join(layers)}; it has {', '.join(sorted(used))}" if layers else ""
        raise ValueError(f"has no meshes, polysurfaces or extrusions{on}")
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


def files_named(name: str, folder: Path) -> list[Path]:
    """The file of a ``name``, or with `*` all that fit; ``folder``: that a path starts from."""
    if "*" not in name:
        return [folder / name]
    root = Path(name).anchor
    return sorted((folder / root).glob(name.removeprefix(root)))


class FileSection(Keys):
    """Blocks from OBJ, GLB, glTF, PLY, STL or OFF, from Rhino's 3dm, or from JSON of COMPAS."""

    file: Text
    """its path, from the folder of this file; with `*` all that fit, a block or more from each"""
    unit: Unit | None = None
    """unit of its lengths: by default that of a 3dm file, else m"""
    scale: Annotated[float, Number(above=0)] | None = None
    """m per unit of the file, in place of `unit`"""
    up: Literal["x", "y", "z"] | None = None
    """its axis that points upwards: by default y in GLB and glTF, else z"""
    layers: tuple[Text, ...] = ()
    """names or patterns of the layers of a 3dm file that have the blocks: by default all"""
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

    @property
    def assumes_unit(self) -> bool:
        """Whether lengths are in m because nothing says another unit."""
        return self.length is None and not (self.has_unit or self.file.lower().endswith(".json"))

    def blocks(self, name: str, folder: Path) -> list[Block]:
        """The blocks, whose names begin with ``name``; ValueError."""
        try:
            paths = files_named(self.file, folder)
            if not paths:
                raise refused("file", self.file, "a pattern that fits a file")
            several = len(paths) > 1
            begin = [f"{name}-{path.stem}" if several else name for path in paths]
            bodies = [body for each in zip(begin, paths, strict=True) for body in self._in(*each)]
            found = blocks_of(bodies, self.density, self.fixed, name, self.fixed_below)
            if self.length is None and not self.has_unit:
                require_likely(mean_size(found), f"file: {self.file}: its blocks")
            return found
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
    def has_unit(self) -> bool:
        """Whether such a file says in which unit its lengths are."""
        return self.file.lower().endswith((".3dm", *UPWARDS_Y))

    @property
    def frame(self) -> Floats:
        """Turns the file's coordinates into m with z upwards, (3, 3)."""
        return self._turn * (self.length or 1.0)

    @property
    def _turn(self) -> Floats:
        usual = "y" if self.file.lower().endswith(UPWARDS_Y) else "z"
        return np.array(UPWARDS[self.up or usual], float)

    def _in(self, name: str, path: Path) -> list[Body]:
        if not path.is_file():
            raise refused("file", self.file, "a file that is there")
        if path.suffix == ".json":
            return compas_bodies(path, name, self.frame)
        surfaces = surfaces_in(path, self._turn, self.length, self.layers)
        alone = len(surfaces) == 1
        return [Body(name if alone else f"{name}-{k}", each) for k, each in surfaces.items()]
