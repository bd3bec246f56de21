"""A barrel vault in running bond, as a file of COMPAS: `python -m studies.designed_vault.geometry`.

A semicircular barrel on two fixed springers. Courses run along y; in every second one the blocks
are shifted by half a block, with half blocks at the ends. The file is a `BlockModel` as compas_dem
writes it, in plain JSON: no COMPAS is needed to write or to read it.
"""

import json
import math
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from sidmacib.mechanics.assembly import Vector
from sidmacib.structure.blocks import Block, prism

FILE = Path(__file__).parent / "vault.json"
DENSITY = 2000.0  # kg/m3
DIGITS = 6  # of coordinates in m
SPRINGER = 0.5  # m, height of the springers


@dataclass(frozen=True)
class Barrel:
    """``courses`` over the semicircle, each ``blocks`` long; ``radius`` (m) of the middle.

    ``thickness`` and ``block``, the length of a block along y, in m.
    """

    courses: int = 13
    blocks: int = 8
    radius: float = 2.5
    thickness: float = 0.5
    block: float = 0.6


def barrel(size: Barrel) -> list[Block]:
    """The two springers, then the blocks course by course, from +x to -x."""
    inner, outer = size.radius - size.thickness / 2, size.radius + size.thickness / 2
    length = size.blocks * size.block

    def at(r: float, angle: float, y: float) -> Vector:
        return r * math.cos(angle), y, r * math.sin(angle)

    found = []
    for name, side in (("block0", 1.0), ("block1", -1.0)):
        near, far = sorted((side * inner, side * outer))
        base = [(near, 0.0, 0.0), (far, 0.0, 0.0), (far, 0.0, -SPRINGER), (near, 0.0, -SPRINGER)]
        found.append(prism(name, base, (0.0, length, 0.0), DENSITY, fixed=True))
    for course in range(size.courses):
        p, q = (math.pi * (course + k) / size.courses for k in (0, 1))
        for start, end in _ends(size.blocks, course % 2 == 1):
            y, along = start * size.block, (end - start) * size.block
            base = [at(inner, p, y), at(outer, p, y), at(outer, q, y), at(inner, q, y)]
            found.append(prism(f"block{len(found)}", base, (0.0, along, 0.0), DENSITY))
    return found


def _ends(blocks: int, shifted: bool) -> Iterator[tuple[float, float]]:
    """Beginnings and ends of the blocks of a course, in lengths of a block."""
    joints = [0.0, *(k + 0.5 for k in range(blocks)), float(blocks)]
    if not shifted:
        joints = [float(k) for k in range(blocks + 1)]
    yield from pairwise(joints)


def content(blocks: list[Block]) -> dict[str, Any]:
    """A file of ``blocks`` as compas_dem (0.6) would write it; identities follow from names."""
    stone = _identity("stone")
    elements = {_identity(block.name): _element(block, stone) for block in blocks}
    material = {"name": "Stone", "fck": None, "ft": None, "Ecm": None, "poisson": 0.2}
    graph = {
        "attributes": {},
        "default_node_attributes": {"x": 0.0, "y": 0.0, "z": 0.0, "element": None},
        "default_edge_attributes": {"modifiers": None, "contacts": None},
        "node": {str(number): {"element": each} for number, each in enumerate(elements)},
        "edge": {str(number): {} for number in range(len(elements))},
        "max_node": len(elements) - 1,
    }
    children = [{"name": "ElementNode", "element": each} for each in elements]
    data: dict[str, Any] = {
        "transformation": None,
        "elements": elements,
        "materials": {
            stone: _object("compas_dem.material/Stone", {**material, "density": DENSITY}, stone)
        },
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


def text(size: Barrel) -> str:
    """The file of a vault."""
    return json.dumps(content(barrel(size)), separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(Barrel()))
