"""What limit analysis finds, as JSON of compas_dem (`Results`) or of compas_cra (interfaces)."""

import json
import uuid
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from scipy.linalg import expm

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import CLOSE, Assembly, Floats
from sidmacib.mechanics.limit import LimitState
from sidmacib.mechanics.polygons import Polygon
from sidmacib.problem import Problem
from sidmacib.structure.files.block_files import FileSection
from sidmacib.structure.files.compas import ASSEMBLIES, CONTACT, INTERFACE, MODEL, content_of
from sidmacib.structure.files.repair import AS_IT_IS
from sidmacib.structure.interfaces import triangles
from sidmacib.structure.structure import owners_of
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

SHOWN = 0.1  # largest displacement of the mechanism, over the mean size of the blocks
DIGITS = 9  # of transformations after the decimal point; the rest is rounding
NAMESPACE = uuid.UUID("8a2c5f0e-5f0b-4d0e-9f55-2d6a3f1c7e11")  # of identities made here


def write_compas_results(
    problem: Problem, model: Path, results: Path, found: LimitState | CapacityError | None
) -> None:
    """Write the forces and the mechanism at the limit load of a ``model`` read from JSON.

    As `compas_results`, or for an assembly of compas_cra as `with_interfaces`. The ``model`` may be
    a structure's file whose blocks are all from one file of COMPAS.
    ``found``: by `sidmacib.mechanics.limit.limit_load` with friction; raised if it is an error, and
    None if gravity turns, which is refused.
    ValueError unless all pieces are blocks of a model of COMPAS, or locks of these.
    """
    model, frame = _model_behind(model)
    content = content_of(model) if model.suffix == ".json" else {}
    if not isinstance(content, dict) or content.get("dtype") not in (MODEL, *ASSEMBLIES):
        raise refused("compas", model.name, f"for a {MODEL} or {ASSEMBLIES[1]} in JSON")
    if content["dtype"] == MODEL and not isinstance(content.get("guid"), str):
        raise ValueError(f"{model.name}: lacks the key guid, which results refer to")
    if found is None:
        raise ValueError("compas: the load must be an acceleration or a force, not a tilt")
    if isinstance(found, CapacityError):
        raise found
    source = {
        "program": "multilock",
        "analysis": "limit, associated friction",
        "load_N": found.load,
    }
    if content["dtype"] == MODEL:
        identity = content["guid"]
        assembly, mechanism = problem.assembly, found.mechanism
        data = compas_results(assembly, found.force, mechanism, identity, source, frame=frame)
    else:
        data = with_interfaces(content, problem.assembly, found.force, frame)
    try:
        results.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise ValueError(f"compas: {results}: {error.strerror}") from None


def _model_behind(path: Path) -> tuple[Path, Floats]:
    """The file of COMPAS from which all blocks of a structure's file are; else ``path`` itself.

    With what turns its coordinates into m with z upwards, (3, 3).
    """
    blocks = [] if path.suffix == ".json" else [*dict(read_yaml(path)["blocks"]).values()]
    if len(blocks) == 1 and isinstance(blocks[0], dict) and "file" in blocks[0]:
        section = FileSection.model_validate(blocks[0])
        if section.is_compas:
            return path.parent / section.file, section.frame
    return path, AS_IT_IS


def compas_results(
    assembly: Assembly,
    force: Floats,
    mechanism: Floats,
    model: str,
    metadata: Mapping[str, Any],
    problem: str | None = None,
    *,
    frame: Floats = AS_IT_IS,
) -> dict[str, Any]:
    """The JSON of compas_dem's `Results` for a model, and a ``problem``, of these identities.

    ``force``: (N, 3) in N, see `sidmacib.mechanics.limit.LimitState`; ``mechanism``: (P, 6), of
    which the largest displacement is drawn as a tenth of a block. Locks that are cut out count as
    parts of their blocks. Nodes have their ``transformation``, edges the points and forces of all
    contacts between two blocks, compression positive, on the second block; ``contacts`` has them
    contact by contact, at its corners, ``contact_data`` the one that carries most. All places are
    in the coordinates that ``frame``, (3, 3), turns into m with z upwards.
    """
    owner = owners_of(assembly)
    largest = float(np.linalg.norm(mechanism[:, :3], axis=1).max(initial=0.0))
    scale = SHOWN * assembly.length / largest if largest else 0.0
    moved = {
        str(_node(piece.name)): {
            "transformation": _transformation(piece.centre, scale * motion, frame)
        }
        for number, (piece, motion) in enumerate(zip(assembly.pieces, mechanism, strict=True))
        if owner[number] == number
    }
    edges: dict[str, list[dict[str, Any]]] = {}
    for (below, above), contact, _ in _contacts(assembly, owner, force, frame):
        edges.setdefault(f"{below},{above}", []).append(contact)
    data = {
        "model_id": model,
        "problem_id": problem or _identity(model, "problem"),
        "displacement_scale": 1.0,
        "node_data": moved,
        "edge_data": {key: _edge(contacts) for key, contacts in edges.items()},
        "metadata": {**metadata, "mechanism_scale": scale},
    }
    return _object("compas_dem.problem/Results", data, model)


def with_interfaces(
    content: dict[str, Any], assembly: Assembly, force: Floats, frame: Floats
) -> dict[str, Any]:
    """Give an assembly of compas_cra, as its JSON, these interfaces and forces at its edges.

    ``force``: (N, 3) in N; ``frame``: of its coordinates, as for `compas_results`. Interfaces that
    it has before are replaced; their points are corners of the interfaces, in order, as its viewer
    draws them.
    """
    graph = content["data"]["graph"]
    graph = graph.get("data", graph)
    edges: dict[str, dict[str, Any]] = {}
    for one, others in graph["edge"].items():
        edges[one] = {other: {**edge, "interfaces": []} for other, edge in others.items()}
    for ends, contact, area in _contacts(assembly, owners_of(assembly), force, frame):
        below, above = map(str, ends)
        if above in edges and below in edges[above] and above not in edges.get(below, {}):
            del edges[above][below]  # forces are those on the second block
        edge = edges.setdefault(below, {}).setdefault(above, {"interfaces": []})
        data = {
            "points": _lists(contact["polygon"]),
            "size": area,
            "frame": _frame(contact),
            "forces": _forces(contact),
            "mesh": None,
        }
        edge["interfaces"].append(_object(INTERFACE, data, str(contact["polygon"])))
    graph["edge"] = edges
    return content


def _forces(contact: Mapping[str, Any]) -> list[dict[str, float]]:
    """Forces at the corners: compression, tension, along the tangents; N."""
    return [
        {"c_np": max(n, 0.0), "c_nn": max(-n, 0.0) + 0.0, "c_u": u, "c_v": v}
        for n, u, v in _lists(contact["corner_forces"])
    ]


def _node(name: str) -> int:
    number = name.rpartition("-")[2]
    if not number.isdecimal():
        raise ValueError(f"{name}: must be a block of the model, or a lock of one")
    return int(number)


def _contacts(
    assembly: Assembly, owner: Sequence[int], force: Floats, frame: Floats
) -> Iterator[tuple[tuple[int, int], dict[str, Any], float]]:
    """Nodes of two blocks, a contact between them and its area; roots of locks have none.

    All contacts of two blocks have them in the same order.
    """
    unit = _unit(frame)
    across = np.array([[unit], [1.0], [1.0]])
    seen: set[tuple[int, int]] = set()
    for number, face in enumerate(assembly.faces):
        assert isinstance(face, Polygon)
        own = assembly.nodes.face == number
        below, above = owner[face.below], owner[face.above]
        if below == above:
            continue
        ends = _node(assembly.pieces[below].name), _node(assembly.pieces[above].name)
        turned = ends[::-1] in seen
        ends = ends[::-1] if turned else ends
        seen.add(ends)
        contact = _contact(face, assembly.nodes.position[own], force[own], turned)
        for key, per in (("polygon", unit), ("points", unit), ("frame", across), ("force", 1.0)):
            contact[key] = contact[key] @ frame / unit / per  # back into the file's axes
        yield ends, contact, face.area / unit**2


def _contact(face: Polygon, places: Floats, force: Floats, turned: bool) -> dict[str, Any]:
    """A contact: its frame, nodes, corners, and the forces at these on the block above.

    ``turned``: seen from the other side, so that the block above counts as the one below.
    """
    at = at_corners(face, places, force)
    contact = {
        "corner_forces": _turned(at)[::-1] if turned else at,
        "frame": np.array([face.middle, *(face.axes[:0:-1] if turned else face.axes[1:])]),
        "polygon": face.corners[::-1] if turned else face.corners,
        "points": places,
        "force": -force @ face.axes if turned else force @ face.axes,
    }
    normal, first, second = (_turned(force) if turned else force).T
    return {**contact, "normal": normal, "tangent1": first, "tangent2": second}


def _turned(force: Floats) -> Floats:
    """Forces (normal, two tangents) on the other side, where the tangents have changed places."""
    return force[:, [0, 2, 1]] * [1.0, -1.0, -1.0]


def _edge(contacts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    keys = ("points", "force", "normal", "tangent1", "tangent2")
    every = {key: np.concatenate([each[key] for each in contacts]) for key in keys}
    resultant = every["force"].sum(axis=0)
    most = max(contacts, key=lambda each: float(np.linalg.norm(each["force"].sum(axis=0))))
    _, first, second = most["frame"]
    return {
        "contact_data": _friction_contact(most),
        "contact_polygon": _object(
            "compas.geometry/Polygon", {"points": _lists(most["polygon"])}, "polygon"
        ),
        "contact_frame": _frame(most),
        "contacts": [_friction_contact(each) for each in contacts],
        "contact_points": _lists(every["points"]),
        "force_normal": _lists(every["normal"]),
        "force_tangent1": _lists(every["tangent1"]),
        "force_tangent2": _lists(every["tangent2"]),
        "force_vector": _lists(every["force"]),
        "resultant_global": _lists(resultant),
        "resultant_local": _lists(np.array([first, second, np.cross(first, second)]) @ resultant),
        "force_magnitude": float(np.linalg.norm(resultant)),
        "face_contact": True,
        "edge_contact": False,
        "point_contact": False,
    }


def _friction_contact(contact: Mapping[str, Any]) -> dict[str, Any]:
    points = _lists(contact["polygon"])
    data = {
        "name": "FrictionContact",
        "points": [_object("compas.geometry/Point", point, str(point)) for point in points],
        "frame": _frame(contact),
        "size": None,
        "mesh": None,
        "holes": None,
        "forces": _forces(contact),
    }
    return _object(CONTACT, data, str(points))


def _frame(contact: Mapping[str, Any]) -> dict[str, Any]:
    point, x, y = contact["frame"]
    data = {"point": _lists(np.array(point)), "xaxis": _lists(x), "yaxis": _lists(y)}
    return _object("compas.geometry/Frame", data, str(data))


def _unit(frame: Floats) -> float:
    """M per unit of the coordinates that ``frame``, (3, 3), turns and scales."""
    return float(np.cbrt(np.linalg.det(frame)))


def _transformation(centre: Floats, motion: Floats, frame: Floats) -> dict[str, Any]:
    """The screw that begins with a ``motion`` (m, rad) of the centroid (m), in the file's axes."""
    unit = _unit(frame)
    centre, moves, turns = (row @ frame / unit for row in (centre, motion[:3], motion[3:]))
    twist = np.zeros((4, 4))
    twist[:3, :3] = np.cross(np.eye(3), turns)  # for the vector product
    twist[:3, 3] = (moves - np.cross(turns, centre)) / unit
    rows = _lists(np.round(expm(twist), DIGITS))
    return _object("compas.geometry/Transformation", {"matrix": rows}, str(rows))


def _object(kind: str, data: Any, of: str) -> dict[str, Any]:
    """An object of COMPAS, with an identity that follows from what it is ``of``."""
    return {"dtype": kind, "data": data, "guid": _identity(kind, of)}


def _identity(*of: str) -> str:
    return str(uuid.uuid5(NAMESPACE, " ".join(of)))


def _lists(values: Floats) -> Any:
    return (np.asarray(values) + 0.0).tolist()


def at_corners(face: Polygon, places: Floats, force: Floats) -> Floats:
    """Forces at the corners of the outer boundary of ``face`` that do the same, (K, 3).

    ``places`` in m and ``force`` in N of its nodes, both (N, 3). Each force is shared among the
    corners of a triangle that its node lies in, by the node's areal coordinates, so that all
    resultants and moments stay, and compression remains compression.
    """
    corners = shapely.get_coordinates(face.outline.exterior)[:-1]
    flat = (places - np.array(face.middle)) @ face.axes[1:].T
    numbers = np.array([*triangles(shapely.Polygon(corners), corners)])
    first = corners[numbers[:, :1]]
    sides = np.swapaxes(corners[numbers[:, 1:]] - first, 1, 2)
    both = np.linalg.solve(sides, np.swapaxes(flat - first, 1, 2))
    shares = np.stack([1.0 - both.sum(axis=1), both[:, 0], both[:, 1]], axis=2)  # (T, N, 3)
    inside = shares.min(axis=2).argmax(axis=0)  # the triangle that a node is deepest in
    share = shares[inside, np.arange(len(flat))]
    share = np.where(np.abs(share) < CLOSE, 0.0, share)
    found = np.zeros((len(corners), 3))
    np.add.at(
        found, numbers[inside].ravel(), (share[:, :, None] * force[:, None, :]).reshape(-1, 3)
    )
    return found
