"""Blocks and interfaces from a file of the COMPAS framework, without COMPAS.

Read is the JSON that `compas.json_dump` of COMPAS 2 writes of an assembly of compas_assembly or
compas_cra, or of a model or an analysis of compas_dem: a graph whose nodes have a block, a mesh of
vertices and faces, and whose edges may have interfaces. Where blocks touch exactly,
`sidmacib.structure.interfaces` finds interfaces as well; those of the file are for blocks with gaps
between them.
"""

import json
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.quantities import Number, shown
from sidmacib.structure.blocks import FLAT, Block, normal_of, off_plane, require_near
from sidmacib.structure.interfaces import Interface, tangents
from sidmacib.validation import LARGE

ASSEMBLIES = ("compas_assembly.datastructures/Assembly", "compas_cra.datastructures/CRA_Assembly")
BLOCK = "compas_assembly.datastructures/Block"
INTERFACE = "compas_assembly.datastructures/Interface"
MODEL, ANALYSIS = "compas_dem.models/BlockModel", "compas_dem.models/Analysis"
GROUP = "compas_model.elements/Group"
NAME = "block"  # begins the names of blocks, which end with the numbers of their nodes
ELEMENT, MESH = "compas_dem.elements/Block", "compas.datastructures/Mesh"
CONTACT = "compas_dem.interactions/FrictionContact"
MOST_DIGITS = 9  # of the number of a node
DENSITIES = Number(at_least=1e-3, at_most=1e6, unit="kg/m3")
ALONG = 0.9  # least cosine between the normals of an interface and of a face beside it
AWAY = 1e-3  # weight of the distance along a face, against that from its plane


@dataclass(frozen=True)
class _Node:
    """A node of the graph: the mesh of its block, whether it is a support, its density (kg/m3).

    ``matrix``: where the block is, (4, 4); None for where its mesh is. ``density``: None if the
    file gives none; ``material``: its name.
    """

    number: int
    mesh: Mapping[str, Any]
    support: bool
    density: float | None = None
    matrix: Floats | None = None
    material: str | None = None


def read_compas(
    path: Path, density: float, fixed: Collection[int] | None = None, name: str = NAME
) -> tuple[Block, ...]:
    """The blocks in the JSON file ``path``, called ``name``-0, … after their nodes.

    Lengths are taken as m; ``density`` in kg/m3, of all blocks whose material has none. ``fixed``:
    nodes of the blocks that cannot move, in place of those that the file calls supports. Faces that
    are not plane are cut into triangles. ValueError, which names the node and the key, for what is
    not understood.
    """
    nodes = _nodes(path, name)
    known = {node.number for node in nodes}
    for number in fixed or ():
        if number not in known:
            allowed = ", ".join(map(str, sorted(known)))
            raise ValueError(f"fixed: {number} is not allowed; it must be a node of {allowed}")
    held = {node.number for node in nodes if node.support} if fixed is None else set(fixed)
    if not held:
        raise ValueError(f"{path.name}: calls no node a support; name the fixed nodes")
    return tuple(
        _block(node, density if node.density is None else node.density, node.number in held, name)
        for node in nodes
    )


def _nodes(path: Path, name: str) -> list[_Node]:
    """The nodes of the graph in a file, by their numbers."""
    content, graph = content_of(path)
    nodes = _mapping(f"{path.name}: node", _key(path.name, graph, "node"))
    if content["dtype"] == MODEL:
        found = _elements(path.name, content, nodes, name)
    else:
        default = graph.get("default_node_attributes", {}).get("is_support", False)
        found = [_of_assembly(node, value, default, name) for node, value in nodes.items()]
    return sorted(found, key=lambda node: node.number)


def _of_assembly(node: str, value: Any, default: bool, begin: str) -> _Node:
    number, held = _number(node), _mapping(f"node {node}", value)
    name = f"{begin}-{number}"
    mesh = _data(f"{name}: block", _key(name, held, "block"), (BLOCK,))
    return _Node(number, mesh, _flag(f"{name}: is_support", held.get("is_support", default)))


def _elements(
    file: str, content: Mapping[str, Any], nodes: Mapping[str, Any], begin: str
) -> list[_Node]:
    """The nodes of a model, whose blocks are elements by an identity of theirs."""
    model = _data(file, content, (MODEL,))
    elements = _mapping(f"{file}: elements", _key(file, model, "elements"))
    materials = _mapping(f"{file}: materials", model.get("materials") or {})
    root = _mapping(f"{file}: tree", _key(file, _mapping(file, _key(file, model, "tree")), "root"))
    children = root.get("children") or ()
    if not isinstance(children, list | tuple) or any(map(_is_group, children)):
        raise ValueError(f"{file}: tree: must have no groups; take the blocks out of theirs")
    whole = _matrix(f"{file}: transformation", model.get("transformation"))
    found = []
    for node, value in nodes.items():
        number = _number(node)
        name = f"{begin}-{number}"
        identity = str(_key(f"node {node}", _mapping(f"node {node}", value), "element"))
        given = _key(f"{file}: elements", elements, identity)
        if isinstance(given, dict) and given.get("dtype") == GROUP:
            continue  # an empty one, by the tree
        element = _data(name, given, (ELEMENT,))
        mesh = _data(f"{name}: geometry", _key(name, element, "geometry"), (MESH,))
        own = _matrix(f"{name}: transformation", element.get("transformation"))
        density = material = None
        if element.get("material") is not None:
            law = _data(name, _key(f"{file}: materials", materials, str(element["material"])), ())
            material = str(law["name"]) if law.get("name") else None
            if law.get("density") is not None:
                density = _positive(f"{name}: density of its material", law["density"])
        support = _flag(f"{name}: is_support", element.get("is_support", False))
        found.append(_Node(number, mesh, support, density, whole @ own, material))
    return found


def _matrix(name: str, value: Any) -> Floats:
    """A transformation, (4, 4), which mirrors nothing."""
    if value is None:
        return np.eye(4)
    given = _key(name, _data(name, value, ()), "matrix")
    try:
        matrix = np.array(given, float)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: must be a matrix of 4 x 4 numbers") from None
    if matrix.shape != (4, 4) or not (np.abs(matrix) <= LARGE).all():
        raise ValueError(f"{name}: must be a matrix of 4 x 4 numbers of at most {LARGE:g}")
    if not (matrix[3] == (0.0, 0.0, 0.0, 1.0)).all() or np.linalg.det(matrix) <= 0.0:
        raise ValueError(f"{name}: must end with 0, 0, 0, 1 and not mirror the blocks")
    return matrix


def _is_group(child: Any) -> bool:
    return not isinstance(child, dict) or ("children" in child and bool(child["children"]))


def _positive(name: str, value: Any) -> float:
    try:
        return DENSITIES.read(value)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _flag(name: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{name}: {shown(value)} is not allowed; it must be true or false")
    return value


def read_compas_interfaces(path: Path, blocks: Sequence[Block]) -> tuple[Interface, ...]:
    """The interfaces in the JSON file ``path`` between its ``blocks``, of `read_compas`.

    Their normals are those of the blocks' nearest faces. Errors of `read_compas`, and ValueError,
    which names the edge, for an interface that has no area or is at no face.
    """
    edges = _mapping(f"{path.name}: edge", _key(path.name, content_of(path)[1], "edge"))
    nodes = {block.name.rpartition("-")[2]: place for place, block in enumerate(blocks)}
    found = []
    for one, others in edges.items():
        for other, edge in _mapping(f"edge {one}", others).items():
            name = f"edge {one}-{other}"
            held = _mapping(name, edge)
            contacts = held.get("interfaces") or held.get("contacts") or []
            if not isinstance(contacts, list):
                raise ValueError(f"{name}: {shown(contacts)} is not allowed; it must be a list")
            for given in contacts:
                points = _key(name, _data(name, given, (INTERFACE, CONTACT)), "points")
                try:
                    ends = nodes[one], nodes[other]
                    places = [each["data"] if isinstance(each, dict) else each for each in points]
                    corners = np.array(places, float).reshape(-1, 3)
                    require_near("points", corners)
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


def content_of(path: Path) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """What a JSON file of COMPAS holds, and its graph; ValueError, which names the file."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"{path.name}: is no JSON ({error})") from None
    if isinstance(content, dict) and content.get("dtype") == ANALYSIS:
        content = _key(path.name, _data(path.name, content, ()), "model")
    held = _data(path.name, content, (*ASSEMBLIES, MODEL))
    return content, _data(f"{path.name}: graph", _key(path.name, held, "graph"), ())


def _block(node: _Node, density: float, fixed: bool, begin: str) -> Block:
    name, mesh = f"{begin}-{node.number}", node.mesh
    vertices = _mapping(f"{name}: vertex", _key(name, mesh, "vertex"))
    faces = _mapping(f"{name}: face", _key(name, mesh, "face"))
    order = {key: place for place, key in enumerate(vertices)}
    try:
        places = np.array([[float(v.get(k, 0.0)) for k in "xyz"] for v in vertices.values()])
        outlines = [[order[str(vertex)] for vertex in face] for face in faces.values()]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"{name}: a vertex or face is not understood ({error!r})") from None
    require_near(name, places)
    if node.matrix is not None:
        places = places @ node.matrix[:3, :3].T + node.matrix[:3, 3]
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    return Block(
        name,
        tuple((float(x), float(y), float(z)) for x, y, z in places),
        tuple(plane for outline in outlines for plane in _planes(outline, places, size)),
        density,
        fixed,
        material=node.material,
    )


def _planes(outline: list[int], places: Floats, size: float) -> list[tuple[int, ...]]:
    """The face itself if it is plane, otherwise triangles from its first vertex."""
    corners = places[outline]
    if len(outline) > 3 and off_plane(corners) > FLAT * size:
        first, *rest = outline
        return [(first, one, other) for one, other in pairwise(rest)]
    return [tuple(outline)]


def _number(node: str) -> int:
    if not node.isdecimal() or len(node) > MOST_DIGITS:
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
