"""Blocks from a file of the COMPAS framework, without COMPAS.

Read is the JSON that `compas.json_dump` writes: an assembly of compas_assembly or compas_cra, a
model or an analysis of compas_dem, a mesh, or a list of meshes; of COMPAS 2, 1 and older. A model
and an assembly are a graph whose nodes have a block, a mesh of vertices and faces, and whose edges
may have interfaces, which `sidmacib.structure.files.compas_interfaces` reads.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sidmacib.mechanics.assembly import Floats
from sidmacib.quantities import Number
from sidmacib.structure.blocks import Block, require_near
from sidmacib.structure.files.json_values import (
    data_of,
    flag,
    json_in,
    key_of,
    mapping,
    matrix_of,
    number_of_node,
)
from sidmacib.structure.files.repair import (
    AS_IT_IS,
    Surface,
    bodies_in,
    chosen,
    repaired,
    with_depth,
)

ASSEMBLIES = ("compas_assembly.datastructures/Assembly", "compas_cra.datastructures/CRA_Assembly")
BLOCK = "compas_assembly.datastructures/Block"
INTERFACE = "compas_assembly.datastructures/Interface"
MODEL, ANALYSIS = "compas_dem.models/BlockModel", "compas_dem.models/Analysis"
GROUP = "compas_model.elements/Group"
NAME = "block"  # begins the names of blocks, which end with the numbers of their nodes
ELEMENTS, MESH = (
    ("compas_dem.elements/Block", "compas_dem.elements/BlockElement"),
    "compas.datastructures/Mesh",
)
CONTACT = "compas_dem.interactions/FrictionContact"
KINDS = (*ASSEMBLIES, MODEL, ANALYSIS, MESH)
DENSITIES = Number(at_least=1e-3, at_most=1e6, unit="kg/m3")


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
    path: Path,
    density: float,
    fixed: Collection[object] | None = None,
    name: str = NAME,
    frame: Floats = AS_IT_IS,
) -> tuple[Block, ...]:
    """The blocks in the JSON file ``path``, called ``name``-0, … after their nodes.

    Those of a list of meshes are numbered from 0, as are the bodies in one mesh. ``frame``, (3, 3),
    turns the file's coordinates into m with z upwards. ``density`` in kg/m3, of all blocks whose
    material has none. ``fixed``: nodes of the blocks that cannot move, in place of those that the
    file calls supports. Meshes are repaired, and faces that are not plane cut into triangles;
    blocks that cannot move may be flat.
    ValueError, which names the node and the key, for what is not understood.
    """
    nodes = sorted(_nodes(path, name), key=lambda node: node.number)
    held = {str(node.number) for node in nodes if node.support}
    if fixed is not None:
        asked = [str(each).removeprefix(f"{name}-") for each in fixed]
        held = chosen(asked, [str(node.number) for node in nodes], "a node of")
    if not held and fixed is None:
        raise ValueError(f"{path.name}: calls no node a support; name the fixed nodes")
    return tuple(
        _block(node, node.density or density, name, frame, str(node.number) in held)
        for node in nodes
    )


def content_of(path: Path) -> Any:
    """What a JSON file of COMPAS holds, of an analysis its model; ValueError by its name."""
    content = json_in(path)
    if isinstance(content, dict) and content.get("dtype") == ANALYSIS:
        return key_of(path.name, data_of(path.name, content), "model")
    return content


def graph_in(file: str, content: Any) -> Mapping[str, Any]:
    """The nodes and edges of a model or an assembly, by ``node`` and ``edge``; ValueError."""
    held = data_of(file, content, KINDS)
    if "assembly" in held:  # COMPAS before 1: blocks stand beside the graph
        graph = data_of(f"{file}: assembly", held["assembly"])
        nodes = graph.get("node", graph.get("vertex"))
        blocks = mapping(f"{file}: blocks", key_of(file, held, "blocks"))
        both = {
            node: {**mapping(f"node {node}", value), "block": blocks.get(node)}
            for node, value in mapping(f"{file}: node", nodes).items()
        }
        return {**graph, "node": both}
    return held if "node" in held else data_of(f"{file}: graph", key_of(file, held, "graph"))


def _nodes(path: Path, name: str) -> list[_Node]:
    content, file = content_of(path), path.name
    if isinstance(content, list):
        each_alone = [
            part for each in content for part in (each if isinstance(each, list) else [each])
        ]
        meshes = [data_of(f"{name}-{k}", each, (MESH, BLOCK)) for k, each in enumerate(each_alone)]
        return [_Node(number, mesh, False) for number, mesh in enumerate(meshes)]
    held = data_of(file, content, KINDS)
    if "vertex" in held and "face" in held:
        return [_Node(number, mesh, False) for number, mesh in enumerate(_bodies(file, held))]
    if "blocks" in held and "assembly" not in held and "graph" not in held:
        blocks = mapping(f"{file}: blocks", held["blocks"])
        return [_of_assembly(node, {"block": mesh}, False, name) for node, mesh in blocks.items()]
    graph = graph_in(file, content)
    nodes = mapping(f"{file}: node", key_of(file, graph, "node"))
    if "elements" in held:
        return list(_elements(file, held, nodes, name))
    defaults = ("default_node_attributes", "node_attributes", "dna", "dva")
    usual = next((mapping(f"{file}: {k}", graph[k]) for k in defaults if k in graph), {})
    default = flag(f"{file}: is_support", usual.get("is_support", False))
    return [_of_assembly(node, value, default, name) for node, value in nodes.items()]


def _of_assembly(node: str, value: Any, default: bool, begin: str) -> _Node:
    number, held = number_of_node(node), mapping(f"node {node}", value)
    name = f"{begin}-{number}"
    mesh = data_of(f"{name}: block", key_of(name, held, "block"), (BLOCK,))
    return _Node(number, mesh, flag(f"{name}: is_support", held.get("is_support", default)))


def _elements(
    file: str, model: Mapping[str, Any], nodes: Mapping[str, Any], begin: str
) -> Iterator[_Node]:
    """The nodes of a model, whose blocks are elements by an identity of theirs."""
    elements = _by_identity(f"{file}: elements", key_of(file, model, "elements"))
    materials = _by_identity(f"{file}: materials", model.get("materials") or {})
    made_of = mapping(f"{file}: element_material", model.get("element_material") or {})
    tree = mapping(
        f"{file}: tree", key_of(file, mapping(file, key_of(file, model, "tree")), "root")
    )
    whole = matrix_of(f"{file}: transformation", model.get("transformation"))
    above = dict(_matrices(f"{file}: tree", tree, elements, whole))
    for node, value in nodes.items():
        name = f"{begin}-{number_of_node(node)}"
        identity = str(key_of(f"node {node}", mapping(f"node {node}", value), "element"))
        given = key_of(f"{file}: elements", elements, identity)
        if isinstance(given, dict) and given.get("dtype") == GROUP:
            continue
        element = data_of(name, given, ELEMENTS)
        geometry = "shape" if "shape" in element else "geometry"  # the first of older versions
        mesh = data_of(f"{name}: {geometry}", key_of(name, element, geometry))
        own = matrix_of(f"{name}: transformation", element.get("transformation"))
        density = material = None
        law_of = element.get("material") or made_of.get(identity)
        if law_of is not None:
            law = data_of(name, key_of(f"{file}: materials", materials, str(law_of)))
            material = str(law["name"]) if law.get("name") else None
            if law.get("density") is not None:
                density = _positive(f"{name}: density of its material", law["density"])
        support = flag(f"{name}: is_support", element.get("is_support", False))
        matrix = above.get(identity, whole) @ own
        yield _Node(number_of_node(node), mesh, support, density, matrix, material)


def _by_identity(name: str, value: Any) -> dict[str, Any]:
    """Objects by their `guid`, as they stand or from a list of older versions."""
    if isinstance(value, list):
        return {str(key_of(name, mapping(name, each), "guid")): each for each in value}
    return mapping(name, value)


def _matrices(
    name: str, node: Any, elements: Mapping[str, Any], above: Floats
) -> Iterator[tuple[str, Floats]]:
    """Where the groups of each element put it, (4, 4), by its identity."""
    held = mapping(name, node)
    identity = str(held.get("element"))
    yield identity, above
    children = held.get("children") or ()
    if not isinstance(children, list | tuple):
        raise ValueError(f"{name}: children must be a list")
    if children and identity in elements:
        group = data_of(name, elements[identity])
        above = above @ matrix_of(f"{name}: transformation", group.get("transformation"))
    for child in children:
        yield from _matrices(name, child, elements, above)


def _positive(name: str, value: Any) -> float:
    try:
        return DENSITIES.read(value)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _surface(name: str, mesh: Mapping[str, Any]) -> Surface:
    """The vertices of a mesh, (V, 3), and its faces."""
    vertices = mapping(f"{name}: vertex", key_of(name, mesh, "vertex"))
    faces = mapping(f"{name}: face", key_of(name, mesh, "face"))
    order = {key: place for place, key in enumerate(vertices)}
    try:
        places = np.array([[float(v.get(k, 0.0)) for k in "xyz"] for v in vertices.values()])
        outlines = [tuple(order[str(vertex)] for vertex in face) for face in faces.values()]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"{name}: a vertex or face is not understood ({error!r})") from None
    require_near(name, places)
    return places.reshape(-1, 3), outlines


def _bodies(file: str, mesh: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """The bodies in one mesh, as meshes."""
    places, found = bodies_in(*_surface(file, mesh))
    vertices = {
        str(number): dict(zip("xyz", place, strict=True))
        for number, place in enumerate(places.tolist())
    }
    for body in found:
        yield {"vertex": vertices, "face": {str(k): face for k, face in enumerate(body)}}


def _block(node: _Node, density: float, begin: str, frame: Floats, fixed: bool) -> Block:
    name = f"{begin}-{node.number}"
    places, faces = _surface(name, node.mesh)
    if node.matrix is not None:
        places = places @ node.matrix[:3, :3].T + node.matrix[:3, 3]
    places = places @ frame.T
    if fixed:
        places, faces = with_depth(places, faces)
    return replace(repaired(name, places, faces, density), fixed=fixed, material=node.material)
