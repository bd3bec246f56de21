"""A barrel vault as a model of compas_dem: written as a file, and shown with its results.

A semicircular barrel on two fixed springers, in running bond. Courses run along y; in every second
one the blocks are shifted by half a block, with half blocks at the ends.

``python -m studies.designed_vault.vault write`` writes the file, a `BlockModel` as compas_dem
writes it, in plain JSON: no COMPAS is needed to write or to read it.

``python -m studies.designed_vault.vault show vault.json results.json`` opens a model and its
results in COMPAS's viewer, or draws a picture of them. It needs compas_dem and compas_viewer
(``requirements/peers.txt``). Without a screen: ``QT_QPA_PLATFORM=offscreen``.
"""

import argparse
import json
import math
import uuid
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Vector
from sidmacib.structure.blocks import Block, prism

FILE = Path(__file__).parent / "vault.json"
RADIUS, THICKNESS = 2.5, 0.5  # m: radius of the middle
LENGTH = 0.6  # m, of a block along y
DENSITY = 2000.0  # kg/m3
DIGITS = 6  # of coordinates in m
SPRINGER = 0.5  # m, height of the springers
DRAWN = 3000  # ms until the viewer has drawn everything
FORCES = 3.0  # scale of the forces
FROM = (-0.5, -1.1, 0.45)  # where the model is seen from, over its size


# --- the file ------------------------------------------------------------------------------------
def barrel(courses: int = 13, blocks: int = 8) -> list[Block]:
    """The two springers, then ``courses`` from +x to -x, each ``blocks`` long."""
    inner, outer = RADIUS - THICKNESS / 2, RADIUS + THICKNESS / 2

    def at(r: float, angle: float, y: float) -> Vector:
        return r * math.cos(angle), y, r * math.sin(angle)

    found = []
    for name, side in (("block0", 1.0), ("block1", -1.0)):
        near, far = sorted((side * inner, side * outer))
        base = [(near, 0.0, 0.0), (far, 0.0, 0.0), (far, 0.0, -SPRINGER), (near, 0.0, -SPRINGER)]
        found.append(prism(name, base, (0.0, blocks * LENGTH, 0.0), DENSITY, fixed=True))
    for course in range(courses):
        p, q = (math.pi * (course + k) / courses for k in (0, 1))
        joints = [0.0, *np.arange(0.5, blocks).tolist(), float(blocks)]
        for start, end in pairwise(joints if course % 2 else range(blocks + 1)):
            y, along = start * LENGTH, (end - start) * LENGTH
            base = [at(inner, p, y), at(outer, p, y), at(outer, q, y), at(inner, q, y)]
            found.append(prism(f"block{len(found)}", base, (0.0, along, 0.0), DENSITY))
    return found


def content(blocks: list[Block]) -> dict[str, Any]:
    """A file of ``blocks`` as compas_dem (0.6) would write it; identities follow from names."""
    stone = _identity("stone")
    elements = {_identity(block.name): _element(block, stone) for block in blocks}
    material = {"name": "Stone", "fck": None, "ft": None, "Ecm": None, "poisson": 0.2}
    children = [{"name": "ElementNode", "element": each} for each in elements]
    graph = {
        "attributes": {},
        "default_node_attributes": {"x": 0.0, "y": 0.0, "z": 0.0, "element": None},
        "default_edge_attributes": {"modifiers": None, "contacts": None},
        "node": {str(number): {"element": each} for number, each in enumerate(elements)},
        "edge": {str(number): {} for number in range(len(elements))},
        "max_node": len(elements) - 1,
    }
    material |= {"density": DENSITY}
    data = {
        "transformation": None,
        "elements": elements,
        "materials": {stone: _object("compas_dem.material/Stone", material, stone)},
        "tree": {"attributes": {}, "root": {"name": "root", "children": children}},
        "graph": graph,
    }
    return _object("compas_dem.models/BlockModel", data, _identity("vault"))


def _element(block: Block, material: str) -> dict[str, Any]:
    vertex = {
        str(k): dict(zip("xyz", (round(each, DIGITS) + 0.0 for each in v), strict=True))
        for k, v in enumerate(block.vertices)
    }
    face = {str(k): list(corners) for k, corners in enumerate(block.faces)}
    mesh = {
        "attributes": {},
        "default_vertex_attributes": {"x": 0.0, "y": 0.0, "z": 0.0},
        "default_edge_attributes": {},
        "default_face_attributes": {},
        "vertex": vertex,
        "face": face,
        "facedata": {each: {} for each in face},
        "edgedata": {},
        "max_vertex": len(vertex) - 1,
        "max_face": len(face) - 1,
    }
    data: dict[str, Any] = {
        "transformation": None,
        "features": [],
        "name": block.name,
        "material": material,
        "geometry": _object("compas.datastructures/Mesh", mesh, _identity(f"{block.name} mesh")),
        "is_support": block.fixed,
    }
    return _object("compas_dem.elements/Block", data, _identity(block.name))


def _object(kind: str, data: dict[str, Any], identity: str) -> dict[str, Any]:
    return {"dtype": kind, "data": data, "guid": identity}


def _identity(name: str) -> str:
    return str(uuid.uuid5(uuid.NAMESPACE_OID, name))


def text() -> str:
    """The file of the vault."""
    return json.dumps(content(barrel()), separators=(",", ":")) + "\n"


# --- the viewer ----------------------------------------------------------------------------------
def viewer_of(model: Path, results: Path) -> Any:
    """The viewer of compas_dem with the blocks, their mechanism and the forces between them."""
    compas = import_module("compas")
    _mend()
    viewer = import_module("compas_dem.viewer").DEMViewer(compas.json_load(model))
    viewer.setup()
    viewer.groups["model"].show = False  # else the blocks hide how they move
    viewer.add_solution(compas.json_load(results), scale=FORCES)
    corners = [
        block.modelgeometry.vertex_coordinates(vertex)
        for block in viewer.model.elements()
        for vertex in block.modelgeometry.vertices()
    ]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    camera, middle = viewer.renderer.camera, (low + high) / 2
    camera.target.set(*middle.tolist())
    camera.position.set(*(middle + np.linalg.norm(high - low) * np.array(FROM)).tolist())
    return viewer


def _mend() -> None:
    """Repair compas_dem 0.6.0, which lacks attributes that its own viewer reads.

    `Block.point` is a list where the viewer asks for a point, and polygons become shapes only with
    compas_occ, which PyPI does not have.
    """
    geometry, meshes = import_module("compas.geometry"), import_module("compas.datastructures")
    block = import_module("compas_dem.elements").Block
    block.point = property(lambda self: geometry.Point(*self.modelgeometry.centroid()))
    geometry.Polygon.to_brep = lambda self: meshes.Mesh.from_polygons([self])


def shown(model: Path, results: Path, picture: Path | None) -> None:
    """Open the viewer; with ``picture`` draw into that file and end."""
    viewer = viewer_of(model, results)
    if picture:
        timer = import_module("PySide6.QtCore").QTimer

        def draw() -> None:
            viewer.renderer.grabFramebuffer().save(str(picture))
            viewer.app.quit()

        timer.singleShot(DRAWN, draw)
    viewer.show()


def main() -> None:
    """Command line: write the vault, or show a model."""
    parser = argparse.ArgumentParser(description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    commands.add_parser("write", help=f"write {FILE.name}")
    show = commands.add_parser("show", help="show a model and its results")
    show.add_argument("model", type=Path)
    show.add_argument("results", type=Path)
    show.add_argument("--picture", type=Path, help="draw into this file and end")
    arguments = parser.parse_args()
    if arguments.command == "write":
        FILE.write_text(text())
    else:
        shown(arguments.model, arguments.results, arguments.picture)


if __name__ == "__main__":
    main()
