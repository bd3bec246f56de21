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
    """Where blocks of a course begin and end, in lengths of a block."""
    joints = [0.0, *(k + 0.5 for k in range(blocks)), float(blocks)]
    if not shifted:
        joints = [float(k) for k in range(blocks + 1)]
    yield from pairwise(joints)


def content(blocks: list[Block]) -> dict[str, Any]:
    """What compas_dem would write of ``blocks``; identities follow from names."""
    elements, nodes, children = {}, {}, []
    for number, block in enumerate(blocks):
        identity = str(uuid.uuid5(uuid.NAMESPACE_OID, block.name))
        vertex = {
            str(k): dict(zip("xyz", (round(each, DIGITS) + 0.0 for each in v), strict=True))
            for k, v in enumerate(block.vertices)
        }
        mesh = {"vertex": vertex, "face": {str(k): list(f) for k, f in enumerate(block.faces)}}
        elements[identity] = {
            "dtype": "compas_dem.elements/Block",
            "data": {
                "geometry": {"dtype": "compas.datastructures/Mesh", "data": mesh},
                "is_support": block.fixed,
                "material": "stone",
                "transformation": None,
            },
        }
        nodes[str(number)] = {"element": identity}
        children.append({"element": identity})
    stone = {"dtype": "compas_dem.material/Stone", "data": {"density": DENSITY}}
    return {
        "dtype": "compas_dem.models/BlockModel",
        "data": {
            "elements": elements,
            "graph": {"node": nodes, "edge": {}},
            "materials": {"stone": stone},
            "transformation": None,
            "tree": {"root": {"children": children}},
        },
    }


def text(size: Barrel) -> str:
    """The file of a vault."""
    return json.dumps(content(barrel(size)), separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(Barrel()))
