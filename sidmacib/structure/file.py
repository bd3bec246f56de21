"""A structure and its load from a YAML file; every fault in one line that names the key."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from sidmacib.contact_points.options import OPTIONS
from sidmacib.fields import kinds_of, number_of
from sidmacib.joint import DRY, INNER
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Loads, NodeLayout, Vector
from sidmacib.problem import Problem
from sidmacib.quantities import Number, choice, shown
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.compas import read_compas
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.loads import acceleration, force_at
from sidmacib.structure.locks import Condensed, Locks
from sidmacib.structure.meshes import blocks_from_mesh
from sidmacib.structure.structure import Pair, structure
from sidmacib.structure.tilt import Tilt, tilting
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

DENSITY = 2000.0  # kg/m3
MATERIAL = {  # of interfaces, where a file leaves a number out
    "normal_stiffness": 1e10,
    "shear_stiffness": 1e10,
    "friction": 0.7,
    "cohesion": 0.0,
    "tensile_strength": 0.0,
    "bond_friction": 0.0,
}
OPTIONAL = ("interfaces", "special", "locks", "mesh", "nodes", "tolerance")
BLOCK = "block"  # begins the names of blocks of a model of COMPAS
ALL = "all"  # pairs of blocks that touch
LOCKS = ("row", "run", "first", "widths", "inner", "dry", "condensed")
SHAPES = {  # the keys that give a block's shape
    frozenset({"vertices", "faces"}): "vertices and faces",
    frozenset({"low", "high"}): "low and high",
    frozenset({"outline", "along"}): "outline and along",
}
_FINITE, _POSITIVE = Number(), Number(above=0)
_TOLERANCE = Number(above=0, at_most=0.01)
_INDEX = Number(at_least=0, whole=True)
_DENSITY = Number(above=0, at_most=1e6, unit="kg/m3")


def read_structure(path: Path) -> Problem:
    """The structure and its load or tilt in a YAML file, or in a JSON file of COMPAS.

    `sidmacib.yaml_text.TextError`, or ValueError that names the key, if it is not one.
    """
    return structure_of(_description(path), folder=path.parent)


def _description(path: Path) -> Any:
    """What is in a file; of a model of COMPAS with what the YAML file beside it adds.

    By default such a model is pushed along x.
    """
    if path.suffix != ".json":
        return read_yaml(path)
    beside = path.with_suffix(".yaml")
    more = read_yaml(beside) if beside.is_file() else {}
    if isinstance(more, dict) and "blocks" in more:
        raise ValueError(f"{beside.name}: blocks: must not be there, as {path.name} has them")
    model = {"blocks": {BLOCK: {"file": path.name}}, "load": {"acceleration": [1, 0, 0]}}
    return model | more if isinstance(more, dict) else more


def structure_of(description: Any, what: str = "the file", folder: Path = Path()) -> Problem:
    """The structure and the load of a ``description``, plain values as in a file.

    ``folder``: that paths of meshes start from. ValueError that names the key, or ``what`` where
    there is none.
    """
    assembly = assembly_of(description, what, folder)
    return Problem(assembly, loads_of(assembly, description["load"]))


def assembly_of(description: Any, what: str = "the file", folder: Path = Path()) -> Assembly:
    """The structure of a ``description``; arguments and errors of `structure_of`."""
    given = _mapping(what, description, ("blocks", "load"), OPTIONAL)
    blocks = [
        block
        for name, value in _named("blocks", given["blocks"]).items()
        for block in _blocks(name, value, folder)
    ]
    material = _material("interfaces", given.get("interfaces", {}), MATERIAL)
    special = _special(_list("special", given.get("special", [])), material)
    locked = _locked(_list("locks", given.get("locks", [])), blocks)
    cells: dict[str, Any] = {}
    if "mesh" in given:
        cells["mesh"] = _number("mesh", given["mesh"], _POSITIVE)
    if "tolerance" in given:
        cells["near"] = _number("tolerance", given["tolerance"], _TOLERANCE)
    if "nodes" in given:
        try:
            cells["nodes"] = choice(NodeLayout, given["nodes"])
        except ValueError as error:
            raise ValueError(f"nodes: {error}") from None
    return structure(blocks, material, special, locked, **cells)


def loads_of(assembly: Assembly, value: Any) -> Loads:
    """The weight of ``assembly`` and the load that a file's key ``load`` gives; ValueError."""
    load = _mapping("load", value, (), ("acceleration", "force", "tilt"))
    if len(load) != 1:
        raise ValueError("load: must have one key, acceleration, force or tilt")
    if "tilt" in load:
        return tilting(assembly, _tilt(load["tilt"]))
    return _load(assembly, load)


def _tilt(value: Any) -> Tilt:
    axis = _vector("load.tilt.axis", _mapping("load.tilt", value, ("axis",))["axis"])
    try:
        return Tilt(axis)
    except ValueError as error:
        raise ValueError(f"load.tilt.{error}") from None


def with_bodies(description: Any, folder: Path) -> Any:
    """``description`` with vertices and faces in place of blocks from mesh files.

    ``folder``: that their paths start from. ValueError that names the key of one at fault.
    """
    if not isinstance(description, dict) or not isinstance(description.get("blocks"), dict):
        return description
    blocks: dict[str, Any] = {}
    for name, value in description["blocks"].items():
        if not isinstance(value, dict) or "file" not in value:
            blocks[name] = value
            continue
        for block in _blocks(str(name), value, folder):
            blocks[block.name] = {
                "vertices": [list(vertex) for vertex in block.vertices],
                "faces": [list(face) for face in block.faces],
                "density": block.density,
                "fixed": block.fixed,
            }
    return {**description, "blocks": blocks}


def _special(values: list[Any], material: FaceMaterial) -> dict[Pair, FaceMaterial]:
    """Materials of single pairs of blocks: ``material`` but for the numbers that they give."""
    defaults = {name: getattr(material, name) for name in MATERIAL}
    special = {}
    for number, value in enumerate(values):
        key = f"special[{number}]"
        given = _mapping(key, value, ("between",), MATERIAL)
        pair = _pair(key, given.pop("between"))
        if pair in special:
            raise ValueError(f"{key}.between: {' and '.join(sorted(pair))} appear twice")
        special[pair] = _material(key, given, defaults)
    return special


def _locked(values: list[Any], blocks: list[Block]) -> dict[Pair, Locks]:
    """Locks of pairs of blocks; of a pair that is named twice, the last."""
    locked: dict[Pair, Locks] = {}
    for number, value in enumerate(values):
        key = f"locks[{number}]"
        given = _mapping(key, value, ("between", "count", "height"), LOCKS)
        between = given.pop("between")
        if between == ALL:
            pairs = [
                frozenset((blocks[each.below].name, blocks[each.above].name))
                for each in interfaces(blocks)
            ]
        else:
            pairs = [_pair(key, between)]
        locked |= dict.fromkeys(pairs, _locks(key, given))
    return locked


def _locks(key: str, given: dict[str, Any]) -> Locks:
    numbers: dict[str, Any] = {
        "count": int(_number(f"{key}.count", given["count"], Number(at_least=1, whole=True))),
        "height": _number(f"{key}.height", given["height"], _POSITIVE),
    }
    for name in {"row", "run"} & given.keys():
        numbers[name] = _vector(f"{key}.{name}", given[name])
    if "first" in given:
        numbers["first"] = str(given["first"])
    if "widths" in given:
        widths = _list(f"{key}.widths", given["widths"])
        numbers["widths"] = tuple(_number(f"{key}.widths", each, _POSITIVE) for each in widths)
    for name, default in (("inner", INNER), ("dry", DRY)):
        defaults = {field: getattr(default, field) for field in MATERIAL}
        numbers[name] = _material(f"{key}.{name}", given.get(name, {}), defaults)
    if "condensed" in given:
        numbers["condensed"] = _condensed(f"{key}.condensed", given["condensed"])
    try:
        return Locks(**numbers)
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from None


def _condensed(key: str, value: Any) -> Condensed:
    given = _mapping(key, value, (), ("working", "option"))
    working = None
    if "working" in given:
        working = _number(f"{key}.working", given["working"], _POSITIVE)
    option = given.get("option", "option3")
    if option not in OPTIONS:
        raise refused(f"{key}.option", option, f"one of {', '.join(OPTIONS)}")
    return Condensed(working, OPTIONS[option])


def _pair(key: str, value: Any) -> Pair:
    pair = _list(f"{key}.between", value)
    if len(pair) != 2:
        raise ValueError(f"{key}.between: must be a list of two blocks")
    return frozenset(map(str, pair))


def _load(assembly: Assembly, load: dict[str, Any]) -> Loads:
    if "acceleration" in load:
        along = _vector("load.acceleration", load["acceleration"])
        if not any(along):
            raise refused("load.acceleration", list(along), "three numbers, not all 0")
        return acceleration(assembly, along)
    force = _mapping("load.force", load["force"], ("block", "at", "direction"))
    at, along = (_vector(f"load.force.{name}", force[name]) for name in ("at", "direction"))
    try:
        return force_at(assembly, str(force["block"]), at, along)
    except ValueError as error:
        raise ValueError(f"load.force.{error}") from None


def _blocks(name: str, value: Any, folder: Path) -> list[Block]:
    """The block that is called ``name``, or those of a mesh file, whose path is from ``folder``."""
    if not isinstance(value, dict) or "file" not in value:
        return [_block(name, value)]
    key = f"blocks.{name}"
    given = _mapping(key, value, ("file",), ("density", "fixed", "scale"))
    density = _number(f"{key}.density", given.get("density", DENSITY), _DENSITY)
    scale = _number(f"{key}.scale", given.get("scale", 1), _POSITIVE)
    path = folder / str(given["file"])
    try:
        if path.suffix == ".json":
            return _from_compas(name, path, density, scale, given)
        bodies = blocks_from_mesh(path, density, scale)
    except ValueError as error:
        raise ValueError(f"{key}.{error}") from None
    fixed = given.get("fixed", False)
    if not isinstance(fixed, bool) and not (
        isinstance(fixed, list) and bodies.keys() >= set(map(str, fixed))
    ):
        allowed = f"true, false, or a list of {', '.join(bodies)}"
        raise ValueError(f"{key}.fixed: {shown(fixed)} is not allowed; it must be {allowed}")
    held = set(bodies) if fixed is True else set(map(str, fixed or []))
    return [
        replace(body, name=name if len(bodies) == 1 else f"{name}-{each}", fixed=each in held)
        for each, body in bodies.items()
    ]


def _from_compas(
    name: str, path: Path, density: float, scale: float, given: Mapping[str, Any]
) -> list[Block]:
    """The blocks of a model or an assembly of COMPAS, whose nodes stand behind ``name``."""
    if not path.is_file():
        raise refused("file", str(given["file"]), "a file that is there")
    fixed = given.get("fixed")
    if fixed is not None:
        if not isinstance(fixed, list):
            raise ValueError(f"fixed: {shown(fixed)} is not allowed; it must be a list of nodes")
        fixed = [int(_number("fixed", node, _INDEX)) for node in fixed]
    return [
        replace(
            block,
            name=block.name.replace("block", f"{name}-", 1),
            vertices=tuple((scale * x, scale * y, scale * z) for x, y, z in block.vertices),
        )
        for block in read_compas(path, density, fixed)
    ]


def _block(name: str, value: Any) -> Block:
    key = f"blocks.{name}"
    shapes = sorted(each for shape in SHAPES for each in shape)
    given = _mapping(key, value, (), (*shapes, "density", "fixed"))
    shape = frozenset(given) & frozenset(shapes)
    if shape not in SHAPES:
        raise ValueError(f"{key}: must have either {', or '.join(SHAPES.values())}, or file")
    density = _number(f"{key}.density", given.get("density", DENSITY), _DENSITY)
    fixed = given.get("fixed", False)
    if not isinstance(fixed, bool):
        raise ValueError(f"{key}.fixed: {shown(fixed)} is not allowed; it must be true or false")
    if "low" in shape:
        low, high = (_vector(f"{key}.{end}", given[end]) for end in ("low", "high"))
        return box(name, low, high, density, fixed=fixed)
    if "along" in shape:
        along = _vector(f"{key}.along", given["along"])
        if len(_list(f"{key}.outline", given["outline"])) < 3:
            raise ValueError(f"{key}.outline: must have 3 or more points")
        return prism(
            name, _vectors(f"{key}.outline", given["outline"]), along, density, fixed=fixed
        )
    faces = tuple(
        tuple(int(_number(f"{key}.faces[{number}]", each, _INDEX)) for each in _list(key, face))
        for number, face in enumerate(_list(f"{key}.faces", given["faces"]))
    )
    return Block(name, _vectors(f"{key}.vertices", given["vertices"]), faces, density, fixed)


def _material(key: str, value: Any, defaults: Mapping[str, float]) -> FaceMaterial:
    given = _mapping(key, value, (), defaults)
    kinds = kinds_of(FaceMaterial)
    numbers = {
        name: _number(f"{key}.{name}", number, number_of(kinds[name]) or _FINITE)
        for name, number in given.items()
    }
    return FaceMaterial(**{**defaults, **numbers})


def _vectors(key: str, value: Any) -> tuple[Vector, ...]:
    return tuple(_vector(f"{key}[{k}]", each) for k, each in enumerate(_list(key, value)))


def _vector(key: str, value: Any) -> Vector:
    numbers = _list(key, value)
    if len(numbers) != 3:
        raise ValueError(f"{key}: must be a list of three numbers")
    x, y, z = (_number(key, number, _FINITE) for number in numbers)
    return x, y, z


def _number(key: str, value: Any, number: Number) -> float:
    try:
        return number.read(value)
    except ValueError as error:
        raise ValueError(f"{key}: {error}") from None


def _list(key: str, value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a list")
    return value


def _named(key: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a mapping by name")
    for name in value:
        if not str(name).strip() or not str(name).isprintable():
            raise ValueError(f"{key}: {shown(name)} is not allowed; names must be printable")
    return {str(name): each for name, each in value.items()}


def _mapping(
    key: str, value: Any, needed: Iterable[str], allowed: Iterable[str] = ()
) -> dict[str, Any]:
    """``value`` if it is a mapping with all ``needed`` keys and, beside these, ``allowed`` ones."""
    if not isinstance(value, dict):
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be a mapping")
    needed, every = list(needed), [*needed, *allowed]
    for name in value:
        if name not in every:
            raise ValueError(f"{key}: unknown key {shown(name)}; valid keys: {', '.join(every)}")
    for name in needed:
        if name not in value:
            raise ValueError(f"{key}: lacks the key {name}")
    return dict(value)
