"""Blocks and interfaces from a file of the COMPAS framework, without COMPAS: an assembly's JSON.

Read are assemblies of compas_assembly and compas_cra (`compas.json_dump` of COMPAS 2): a graph
whose nodes have a block, a mesh of vertices and faces, and whose edges may have interfaces. Where
blocks touch exactly, `sidmacib.structure.interfaces` finds interfaces as well; those of the file
are for blocks with gaps between them.
"""

import json
import math
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.quantities import shown
from sidmacib.structure.blocks import FLAT, Block, normal_of, off_plane
from sidmacib.structure.interfaces import Interface, tangents

ASSEMBLIES = ("compas_assembly.datastructures/Assembly", "compas_cra.datastructures/CRA_Assembly")
BLOCK = "compas_assembly.datastructures/Block"
INTERFACE = "compas_assembly.datastructures/Interface"
ALONG = 0.9  # least cosine between the normals of an interface and of a face beside it
AWAY = 1e-3  # weight of the distance along a face, against that from its plane


def read_compas(
    path: Path, density: float, fixed: Collection[int] | None = None
) -> tuple[Block, ...]:
    """The blocks of the assembly in the JSON file ``path``, called block0, … after their nodes.

    Lengths are taken as m; ``density`` in kg/m3, of all blocks. ``fixed``: nodes of the blocks that
    cannot move, in place of those that the file calls supports. Faces that are not plane are cut
    into triangles. ValueError, which names the node and the key, for what is not understood.
    """
    graph = _graph(path)
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


def read_compas_interfaces(path: Path, blocks: Sequence[Block]) -> tuple[Interface, ...]:
    """The interfaces in the JSON file ``path`` between its ``blocks``, of `read_compas`.

    Their normals are those of the blocks' nearest faces. Errors of `read_compas`, and ValueError,
    which names the edge, for an interface that has no area or is at no face.
    """
    edges = _mapping(f"{path.name}: edge", _key(path.name, _graph(path), "edge"))
    names = {block.name: place for place, block in enumerate(blocks)}
    found = []
    for one, others in edges.items():
        for other, edge in _mapping(f"edge {one}", others).items():
            name = f"edge {one}-{other}"
            for given in _mapping(name, edge).get("interfaces") or ():
                points = _key(name, _data(name, given, (INTERFACE,)), "points")
                try:
                    ends = names[f"block{one}"], names[f"block{other}"]
                    corners = np.array(points, float).reshape(-1, 3)
                except (KeyError, TypeError, ValueError) as error:
                    raise ValueError(f"{name}: is not understood ({error!r})") from None
                below, above = min(ends), max(ends)
                if not (blocks[below].fixed and blocks[above].fixed):
                    found.append(_interface(name, below, above, corners, blocks[below]))
    return tuple(sorted(found, key=lambda each: (each.below, each.above, each.middle)))


def _interface(name: str, below: int, above: int, corners: Floats, block: Block) -> Interface:
    """The region within ``corners`` (m), (K, 3), beside a face of the ``block`` below."""
    about = corners.mean(axis=0)
    around = np.cross(corners - about, np.roll(corners - about, -1, axis=0)).sum(axis=0)
    if not np.linalg.norm(around) > CLOSE * block.size**2:
        raise ValueError(f"{name}: an interface must have an area")
    normal = around / np.linalg.norm(around)
    nearest, side = math.inf, 0.0
    for outline in block.outlines:
        outward = normal_of(outline)
        beside = float(outward @ normal)
        if abs(beside) > ALONG:
            arm = about - outline.mean(axis=0)
            # In the plane of the face first, then near its middle.
            apart = abs(float(arm @ outward)) + AWAY * float(np.linalg.norm(arm))
            if apart < nearest:
                nearest, side = apart, math.copysign(1.0, beside)
    axes = np.array([side * normal, *tangents(side * normal)])
    outline = shapely.Polygon((corners - about) @ axes[1:].T)
    if not (side and outline.is_valid):
        raise ValueError(f"{name}: an interface must be beside a face of its block, and not cross")
    flat = shapely.get_coordinates(outline.centroid)[0]
    x, y, z = about + flat @ axes[1:]
    centred = shapely.normalize(shapely.affinity.translate(outline, *(-flat))).reverse()
    return Interface(below, above, axes, (float(x), float(y), float(z)), centred)


def _graph(path: Path) -> Mapping[str, Any]:
    """The graph of the assembly in a file."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ValueError(f"{path.name}: is no JSON ({error})") from None
    held = _data(path.name, content, ASSEMBLIES)
    return _data(f"{path.name}: graph", _key(path.name, held, "graph"), ())


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
    if len(outline) > 3 and off_plane(corners) > FLAT * size:
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
