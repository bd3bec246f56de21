"""Blocks, and interfaces between them, from a file of the COMPAS framework, without COMPAS.

Read is the JSON that `compas.json_dump` writes: an assembly of compas_assembly or compas_cra, a
model or an analysis of compas_dem, a mesh, or a list of meshes; of COMPAS 2, 1 and older. A model
and an assembly are a graph whose nodes have a block, a mesh of vertices and faces, and whose edges
may have interfaces.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from sidmacib.mechanics.assembly import CLOSE, Floats
from sidmacib.quantities import Number, shown
from sidmacib.structure.blocks import Block, area_vector, require_near
from sidmacib.structure.files.bodies import Body, blocks_of, bodies_in
from sidmacib.structure.files.repair import AS_IT_IS, Surface
from sidmacib.structure.interfaces import Interface, in_order, tangents

ASSEMBLIES = ("compas_assembly.datastructures/Assembly", "compas_cra.datastructures/CRA_Assembly")
BLOCK = "compas_assembly.datastructures/Block"
INTERFACE = "compas_assembly.datastructures/Interface"
MODEL, ANALYSIS = "compas_dem.models/BlockModel", "compas_dem.models/Analysis"
GROUP = "compas_model.elements/Group"
NAME = "block"  # begins the names of blocks, which end with the numbers of their nodes
ELEMENTS = ("compas_dem.elements/Block", "compas_dem.elements/BlockElement")
MESH = "compas.datastructures/Mesh"
CONTACT = "compas_dem.interactions/FrictionContact"
KINDS = (*ASSEMBLIES, MODEL, ANALYSIS, MESH)
DENSITIES = Number(at_least=1e-3, at_most=1e6, unit="kg/m3")
ALONG = 0.9  # least cosine between the normals of an interface and of a face beside it
AWAY = 1e-3  # weight of the distance along a face, against that from its plane


@dataclass(frozen=True, eq=False)
class _Node:
    """A node of the graph: the surface of its block, whether it is a support, its density (kg/m3).

    ``density``: None if the file gives none; ``material``: its name.
    """

    number: int
    surface: Surface
    support: bool
    density: float | None = None
    material: str | None = None


def read_compas(
    path: Path,
    density: float,
    fixed: Sequence[object] | None = None,
    name: str = NAME,
    frame: Floats = AS_IT_IS,
) -> tuple[Block, ...]:
    """The blocks in the JSON file ``path``, called ``name``-0, … after their nodes.

    Those of a list of meshes are numbered from 0, as are the bodies in one mesh. ``frame``, (3, 3),
    turns the file's coordinates into m with z upwards. ``density`` in kg/m3, of all blocks whose
    material has none. ``fixed``: nodes of the blocks that cannot move, in place of those that the
    file calls supports. Meshes are repaired, and faces that are not plane cut into triangles;
    blocks that cannot move may be flat.
    ValueError, which names the file or the block, for what is not understood.
    """
    return tuple(blocks_of(compas_bodies(path, name, frame), density, fixed, name))


def compas_bodies(path: Path, name: str, frame: Floats) -> list[Body]:
    """The bodies in the JSON file ``path``; arguments and errors of `read_compas`."""
    with _understood(path):
        nodes = sorted(_nodes(content_of(path), name), key=lambda node: node.number)
    return [
        Body(
            f"{name}-{node.number}",
            (node.surface[0] @ frame.T, node.surface[1]),
            node.density,
            node.material,
            node.support,
        )
        for node in nodes
    ]


def read_compas_interfaces(
    path: Path, blocks: Sequence[Block], frame: Floats = AS_IT_IS
) -> tuple[Interface, ...]:
    """The interfaces in the JSON file ``path`` between its ``blocks``, of `read_compas`.

    ``frame`` as there. Their normals are those of the blocks' nearest faces. Errors of
    `read_compas`, and ValueError, which names the edge, for an interface that has no area or is at
    no face.
    """
    nodes = {block.name.rpartition("-")[2]: place for place, block in enumerate(blocks)}
    with _understood(path):
        edges = [
            (one, other, _numbers([of["data"] if isinstance(of, dict) else of for of in corners]))
            for one, others in graph_in(content_of(path))["edge"].items()
            for other, edge in others.items()
            for corners in _contacts(edge)
        ]
    found = []
    for one, other, points in edges:
        name = f"edge between {shown(one)} and {shown(other)}"
        if one not in nodes or other not in nodes:
            raise ValueError(f"{name}: must be between two blocks of the file")
        corners = points.reshape(-1, 3)
        require_near(name, corners)
        below, above = sorted((nodes[one], nodes[other]))
        if not (blocks[below].fixed and blocks[above].fixed):
            found.append(_interface(name, below, above, corners @ frame.T, blocks[below]))
    return in_order(found)


def _interface(name: str, below: int, above: int, corners: Floats, block: Block) -> Interface:
    """The region within ``corners`` (m), (K, 3), beside a face of the ``block`` below."""
    about = corners.mean(axis=0)
    around = area_vector(corners - about)
    if not np.linalg.norm(around) > CLOSE * block.size**2:
        raise ValueError(f"{name}: an interface must have an area")
    normal = around / np.linalg.norm(around)
    beside = block.normals @ normal
    arms = about - np.array([outline.mean(axis=0) for outline in block.outlines])
    # In the plane of the face first, then near its middle.
    apart = np.abs((arms * block.normals).sum(axis=1)) + AWAY * np.linalg.norm(arms, axis=1)
    apart[np.abs(beside) <= ALONG] = np.inf
    normal *= np.sign(beside[apart.argmin()])
    axes = np.array([normal, *tangents(normal)])
    outline = shapely.Polygon((corners - about) @ axes[1:].T)
    if not (np.isfinite(apart).any() and outline.is_valid):
        raise ValueError(f"{name}: an interface must be beside a face of its block, and not cross")
    plain = shapely.normalize(outline).reverse()
    return Interface.of((below, above), axes, about, outline, plain)


@contextmanager
def _understood(path: Path) -> Iterator[None]:
    """ValueError that names the file, for values that are not where COMPAS writes them."""
    try:
        yield
    except KeyError as error:
        raise ValueError(f"{path.name}: lacks the key {shown(error.args[0])}") from None
    except (AttributeError, IndexError, TypeError) as error:
        raise ValueError(f"{path.name}: is not understood ({error})") from None


def content_of(path: Path) -> Any:
    """What a JSON file of COMPAS holds, of an analysis its model; ValueError by its name."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"{path.name}: is no JSON ({error})") from None
    with _understood(path):
        analysis = isinstance(content, dict) and content.get("dtype") == ANALYSIS
        return data_of(content)["model"] if analysis else content


def data_of(value: Mapping[str, Any], *kinds: str) -> Any:
    """What an object of COMPAS holds; TypeError if it names a kind that is none of ``kinds``.

    Version 2 calls the kind `dtype` and what it holds `data`; version 1 `value`, and older ones
    have no kind.
    """
    kind = value.get("dtype", value.get("datatype"))
    if kinds and kind is not None and kind not in kinds:
        raise TypeError(f"dtype {shown(kind)} is not allowed; it must be {' or '.join(kinds)}")
    return value.get("data", value.get("value", value))


def graph_in(content: Any) -> Mapping[str, Any]:
    """The nodes and edges of a model or an assembly, by ``node`` and ``edge``."""
    held = data_of(content, *KINDS)
    if "assembly" in held:  # COMPAS before 1: blocks stand beside the graph
        graph = data_of(held["assembly"])
        nodes = graph.get("node", graph.get("vertex"))
        both = {node: {**of, "block": held["blocks"][node]} for node, of in nodes.items()}
        return {**graph, "node": both}
    return held if "node" in held else data_of(held["graph"])


def _contacts(edge: Mapping[str, Any]) -> Iterator[list[Any]]:
    if edge.get("interface_points"):  # COMPAS before 1
        yield edge["interface_points"]
    contacts = edge.get("interfaces") or edge.get("contacts") or []
    if not contacts and edge.get("interface"):  # COMPAS 1
        contacts = [edge["interface"]]
    for contact in contacts:
        yield data_of(contact, INTERFACE, CONTACT)["points"]


def _nodes(content: Any, name: str) -> list[_Node]:
    """The nodes in what a file holds; ``name``: begins those of their blocks."""
    if isinstance(content, list):
        alone = [mesh for each in content for mesh in (each if isinstance(each, list) else [each])]
        meshes = [data_of(mesh, MESH, BLOCK) for mesh in alone]
        return [_node(str(number), mesh, name, False) for number, mesh in enumerate(meshes)]
    held = data_of(content, *KINDS)
    if "vertex" in held and "face" in held:
        places, bodies = bodies_in(*_surface(name, held))
        return [_Node(number, (places, body), False) for number, body in enumerate(bodies)]
    if "blocks" in held and "assembly" not in held and "graph" not in held:
        return [
            _node(node, data_of(mesh, BLOCK), name, False) for node, mesh in held["blocks"].items()
        ]
    graph = graph_in(content)
    if "elements" in held:
        return list(_elements(held, graph["node"], name))
    defaults = ("default_node_attributes", "node_attributes", "dna", "dva")
    usual: Mapping[str, Any] = next((graph[key] for key in defaults if key in graph), {})
    return [
        _node(node, data_of(of["block"], BLOCK), name, {**usual, **of}.get("is_support", False))
        for node, of in graph["node"].items()
    ]


def _node(node: str, mesh: Mapping[str, Any], begin: str, support: bool, *more: Any) -> _Node:
    if not node.isdecimal():
        raise TypeError(f"node {shown(node)} must be a number")
    return _Node(int(node), _surface(f"{begin}-{node}", mesh), support, *more)


def _elements(model: Mapping[str, Any], nodes: Mapping[str, Any], begin: str) -> Iterator[_Node]:
    """The nodes of a model, whose blocks are elements by an identity of theirs."""
    elements, materials = (_by_identity(model.get(key)) for key in ("elements", "materials"))
    made_of = model.get("element_material") or {}
    whole = _matrix(model.get("transformation"))
    above = dict(_matrices(model["tree"]["root"], elements, whole))
    for node, value in nodes.items():
        identity = str(value["element"])
        if elements[identity].get("dtype") == GROUP:
            continue
        element = data_of(elements[identity], *ELEMENTS)
        mesh = data_of(element["shape" if "shape" in element else "geometry"])  # of older versions
        material = element.get("material") or made_of.get(identity)
        law = {} if material is None else data_of(materials[str(material)])
        matrix = above.get(identity, whole) @ _matrix(element.get("transformation"))
        support = element.get("is_support", False)
        found = _node(node, mesh, begin, support, law.get("density"), law.get("name"))
        places, faces = found.surface
        moved = places @ matrix[:3, :3].T + matrix[:3, 3]
        yield replace(found, surface=(moved, faces))


def _by_identity(values: Any) -> dict[str, Any]:
    """Objects by their `guid`, as they stand or from a list of older versions."""
    if isinstance(values, list):
        return {str(each["guid"]): each for each in values}
    return values or {}


def _matrices(
    node: Mapping[str, Any], elements: Mapping[str, Any], above: Floats
) -> Iterator[tuple[str, Floats]]:
    """Where the groups of each element put it, (4, 4), by its identity."""
    identity, children = str(node.get("element")), node.get("children") or ()
    yield identity, above
    if children and identity in elements:
        above = above @ _matrix(data_of(elements[identity]).get("transformation"))
    for child in children:
        yield from _matrices(child, elements, above)


def _matrix(transformation: Any) -> Floats:
    """A transformation, (4, 4), which mirrors nothing."""
    if transformation is None:
        return np.eye(4)
    matrix = _numbers(data_of(transformation)["matrix"])
    if matrix.shape != (4, 4) or not np.linalg.det(matrix) > 0.0:
        raise TypeError("a transformation must be of 4 x 4 numbers, and not mirror the blocks")
    return matrix


def _numbers(values: Any) -> Floats:
    try:
        return np.array(values, float)
    except ValueError:
        raise TypeError(f"{shown(values)} must have numbers") from None


def _surface(name: str, mesh: Mapping[str, Any]) -> Surface:
    vertices, faces = mesh["vertex"], mesh["face"]
    order = {key: place for place, key in enumerate(vertices)}
    try:
        places = np.array([[float(v.get(k, 0.0)) for k in "xyz"] for v in vertices.values()])
        outlines = [tuple(order[str(vertex)] for vertex in face) for face in faces.values()]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"{name}: a vertex or face is not understood ({error!r})") from None
    require_near(name, places)
    return places.reshape(-1, 3), outlines
