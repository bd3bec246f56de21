"""Blocks from a file of the COMPAS framework, without COMPAS: the JSON of an assembly.

Read are assemblies of compas_assembly and compas_cra (`compas.json_dump` of COMPAS 2): a graph
whose nodes have a block, a mesh of vertices and faces. Interfaces that are in the file are not
read; they are found anew, see `sidmacib.structure.interfaces`.
"""

import json
from collections.abc import Collection, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import shown
from sidmacib.structure.blocks import FLAT, Block, normal_of

ASSEMBLIES = ("compas_assembly.datastructures/Assembly", "compas_cra.datastructures/CRA_Assembly")
BLOCK = "compas_assembly.datastructures/Block"


def read_compas(
    path: Path, density: float, fixed: Collection[int] | None = None
) -> tuple[Block, ...]:
    """The blocks of the assembly in the JSON file ``path``, called block0, … after their nodes.

    Lengths are taken as m; ``density`` in kg/m3, of all blocks. ``fixed``: nodes of the blocks that
    cannot move, in place of those that the file calls supports. Faces that are not plane are cut
    into triangles. ValueError, which names the node and the key, for what is not understood.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"{path.name}: is no JSON ({error})") from None
    graph = _data(path.name, content, ASSEMBLIES)
    graph = _data(f"{path.name}: graph", _key(path.name, graph, "graph"), ())
    nodes = _mapping(f"{path.name}: node", _key(path.name, graph, "node"))
    default = graph.get("default_node_attributes", {}).get("is_support", False)
    supports = {
        _number(node): bool(_mapping(f"node {node}", value).get("is_support", default))
        for node, value in nodes.items()
    }
    for node in fixed or ():
        if node not in supports:
            known = ", ".join(map(str, sorted(supports)))
            raise ValueError(f"fixed: {node} is not allowed; it must be a node of {known}")
    if fixed is not None:
        supports = {node: node in fixed for node in supports}
    if not any(supports.values()):
        raise ValueError(f"{path.name}: calls no node a support; name the fixed nodes")
    return tuple(
        _block(number, nodes[str(number)], density, supports[number]) for number in sorted(supports)
    )


def _block(number: int, node: Any, density: float, fixed: bool) -> Block:
    name = f"block{number}"
    mesh = _data(f"{name}: block", _key(name, _mapping(name, node), "block"), (BLOCK,))
    vertices = _mapping(f"{name}: vertex", _key(name, mesh, "vertex"))
    faces = _mapping(f"{name}: face", _key(name, mesh, "face"))
    order = {key: place for place, key in enumerate(vertices)}
    try:
        places = np.array([[float(v[k]) for k in "xyz"] for v in vertices.values()])
        outlines = [[order[str(vertex)] for vertex in face] for face in faces.values()]
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{name}: a vertex or face is not understood ({error!r})") from None
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    return Block(
        name,
        tuple((float(x), float(y), float(z)) for x, y, z in places),
        tuple(plane for outline in outlines for plane in _planes(outline, places, size)),
        density,
        fixed,
    )


def _planes(outline: list[int], places: Floats, size: float) -> list[tuple[int, ...]]:
    """The face itself if it is plane, otherwise triangles from its first vertex."""
    corners = places[outline]
    if len(outline) > 3:
        apart = np.abs((corners - corners.mean(axis=0)) @ normal_of(corners)).max()
        if apart > FLAT * size:
            first, *rest = outline
            return [(first, one, other) for one, other in pairwise(rest)]
    return [tuple(outline)]


def _number(node: str) -> int:
    if not node.isdecimal():
        raise ValueError(f"node: {shown(node)} is not allowed; it must be a whole number")
    return int(node)


def _data(name: str, value: Any, kinds: tuple[str, ...]) -> Mapping[str, Any]:
    """What an object of COMPAS holds; of one of ``kinds``, if any are named."""
    held = _mapping(name, value)
    if kinds and held.get("dtype") not in kinds:
        raise ValueError(
            f"{name}: dtype {shown(held.get('dtype'))} is not allowed; it must be "
            f"{' or '.join(kinds)}"
        )
    return _mapping(f"{name}: data", held.get("data", held))


def _key(name: str, value: Mapping[str, Any], key: str) -> Any:
    if key not in value:
        raise ValueError(f"{name}: lacks the key {key}")
    return value[key]


def _mapping(name: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"{name}: {shown(value)} is not allowed; it must be a mapping")
    return value
