"""A structure and its load from a YAML file; every fault in one line that names the key."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from sidmacib.contact_points.options import OPTIONS
from sidmacib.joint.hold_down import HoldDown
from sidmacib.joint.joint import DRY, FIXED_PLATE, INNER
from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Loads, NodeLayout
from sidmacib.problem import Problem
from sidmacib.quantities import Number, choice, shown
from sidmacib.rule.law import RULES
from sidmacib.structure.analysis.tilt import Tilt, tilting
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.compas import DENSITIES, NAME, read_compas
from sidmacib.structure.files.keys import (
    MATERIAL,
    POSITIVE,
    listed,
    mapping,
    named,
    read_material,
    read_number,
    vector,
    vectors,
)
from sidmacib.structure.files.meshes import blocks_from_mesh
from sidmacib.structure.files.selection import Pair, Selection
from sidmacib.structure.interfaces import NEAR, interfaces
from sidmacib.structure.loads import acceleration, force_at
from sidmacib.structure.locks import ALL, Condensed, Locks
from sidmacib.structure.structure import structure
from sidmacib.validation import refused
from sidmacib.yaml_text import read_yaml

DENSITY = 2000.0  # kg/m3
OPTIONAL = ("interfaces", "special", "locks", "mesh", "nodes", "tolerance", "design")
LOCKS = ("row", "run", "first", "widths", "inner", "dry", "condensed")
SHAPES = {  # the keys that give a block's shape
    frozenset({"vertices", "faces"}): "vertices and faces",
    frozenset({"low", "high"}): "low and high",
    frozenset({"outline", "along"}): "outline and along",
}
_TOLERANCE = Number(above=0, at_most=0.01)
_INDEX = Number(at_least=0, whole=True)


def read_structure(path: Path) -> Problem:
    """The structure and its load or tilt in a YAML file, or in a JSON file of COMPAS.

    `sidmacib.yaml_text.TextError`, or ValueError that names the key, if it is not one.
    """
    return structure_of(description_in(path), folder=path.parent)


def description_in(path: Path) -> Any:
    """What is in a file; of a model of COMPAS with what the YAML file beside it adds.

    By default such a model is pushed along x.
    """
    if path.suffix != ".json":
        return read_yaml(path)
    beside = path.with_suffix(".yaml")
    more = read_yaml(beside) if beside.is_file() else {}
    if isinstance(more, dict) and "blocks" in more:
        raise ValueError(f"{beside.name}: blocks: must not be there, as {path.name} has them")
    model = {"blocks": {NAME: {"file": path.name}}, "load": {"acceleration": [1, 0, 0]}}
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
    given = mapping(what, description, ("blocks", "load"), OPTIONAL)
    blocks = [
        block
        for name, value in named("blocks", given["blocks"]).items()
        for block in _blocks(name, value, folder)
    ]
    material = read_material("interfaces", given.get("interfaces", {}), MATERIAL)
    cells: dict[str, Any] = {}
    if "mesh" in given:
        cells["mesh"] = read_number("mesh", given["mesh"], POSITIVE)
    if "tolerance" in given:
        cells["near"] = read_number("tolerance", given["tolerance"], _TOLERANCE)
    chosen = Selection(blocks, lambda: interfaces(blocks, cells.get("near", NEAR)))
    special = _special(listed("special", given.get("special", [])), material, chosen)
    locked = _locked(listed("locks", given.get("locks", [])), chosen)
    if chosen.found is not None:
        cells["regions"] = chosen.found  # not looked for again
    if "nodes" in given:
        try:
            cells["nodes"] = choice(NodeLayout, given["nodes"])
        except ValueError as error:
            raise ValueError(f"nodes: {error}") from None
    return structure(blocks, material, special, locked, **cells)


def loads_of(assembly: Assembly, value: Any) -> Loads:
    """The weight of ``assembly`` and the load that a file's key ``load`` gives; ValueError."""
    load = mapping("load", value, (), ("acceleration", "force", "tilt"))
    if len(load) != 1:
        raise ValueError("load: must have one key, acceleration, force or tilt")
    if "tilt" in load:
        return tilting(assembly, _tilt(load["tilt"]))
    return _load(assembly, load)


def _tilt(value: Any) -> Tilt:
    axis = vector("load.tilt.axis", mapping("load.tilt", value, ("axis",))["axis"])
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
                **({} if block.material is None else {"material": block.material}),
            }
    return {**description, "blocks": blocks}


def _special(
    values: list[Any], material: FaceMaterial, chosen: Selection
) -> dict[Pair, FaceMaterial]:
    """Materials of pairs of blocks: ``material`` but for the numbers that they give.

    Of a pair that fits several, the last, but two blocks may be named only once.
    """
    defaults = {name: getattr(material, name) for name in MATERIAL}
    special: dict[Pair, FaceMaterial] = {}
    once: set[Pair] = set()
    for number, value in enumerate(values):
        key = f"special[{number}]"
        given = mapping(key, value, ("between",), MATERIAL)
        between = given.pop("between")
        pairs = chosen.pairs(f"{key}.between", between)
        if isinstance(between, list):
            if pairs[0] in once:
                raise ValueError(f"{key}.between: {' and '.join(sorted(pairs[0]))} appear twice")
            once.add(pairs[0])
        special |= dict.fromkeys(pairs, read_material(key, given, defaults))
    return special


def _locked(values: list[Any], chosen: Selection) -> dict[Pair, Locks]:
    """Locks of pairs of blocks; of a pair that fits several, the last."""
    locked: dict[Pair, Locks] = {}
    for number, value in enumerate(values):
        key = f"locks[{number}]"
        given = mapping(key, value, ("between", "count", "height"), LOCKS)
        pairs = chosen.pairs(f"{key}.between", given.pop("between"))
        locked |= dict.fromkeys(pairs, _locks(key, given))
    return locked


def _locks(key: str, given: dict[str, Any]) -> Locks:
    numbers: dict[str, Any] = {
        "count": int(read_number(f"{key}.count", given["count"], Number(at_least=1, whole=True))),
        "height": read_number(f"{key}.height", given["height"], POSITIVE),
    }
    for name in {"row", "run"} & given.keys():
        numbers[name] = vector(f"{key}.{name}", given[name])
    if "first" in given:
        numbers["first"] = str(given["first"])
    if "widths" in given:
        widths = listed(f"{key}.widths", given["widths"])
        numbers["widths"] = tuple(read_number(f"{key}.widths", each, POSITIVE) for each in widths)
    for name, default in (("inner", INNER), ("dry", DRY)):
        defaults = {field: getattr(default, field) for field in MATERIAL}
        numbers[name] = read_material(f"{key}.{name}", given.get(name, {}), defaults)
    if "condensed" in given:
        numbers["condensed"] = _condensed(f"{key}.condensed", given["condensed"])
    try:
        return Locks(**numbers)
    except ValueError as error:
        raise ValueError(f"{key}.{error}") from None


def _condensed(key: str, value: Any) -> Condensed:
    given = mapping(key, value, (), ("working", "option", "rule", "hold_down"))
    working, hold_down = None, FIXED_PLATE
    if given.get("working") == "all":
        working = ALL
    elif "working" in given:
        try:
            working = read_number(f"{key}.working", given["working"], POSITIVE)
        except ValueError:
            key, value = f"{key}.working", given["working"]
            raise refused(key, value, "a number greater than 0, or all") from None
    option = given.get("option", "option3")
    if not isinstance(option, str) or option not in OPTIONS:
        raise refused(f"{key}.option", option, f"one of {', '.join(OPTIONS)}")
    rule = given.get("rule")
    if "rule" in given and (not isinstance(rule, str) or rule not in RULES):
        raise refused(f"{key}.rule", rule, f"one of {', '.join(RULES)}")
    if "hold_down" in given:
        if working is not None:
            raise ValueError(f"{key}.hold_down: is for a rule; must not be given beside working")
        try:
            hold_down = HoldDown.read(given["hold_down"])
        except ValueError as error:
            raise ValueError(f"{key}.hold_down: {error}") from None
    try:
        return Condensed(working, OPTIONS[option], rule, hold_down)
    except ValueError as error:
        raise ValueError(f"{key}.{error}") from None


def _load(assembly: Assembly, load: dict[str, Any]) -> Loads:
    if "acceleration" in load:
        along = vector("load.acceleration", load["acceleration"])
        if not any(along):
            raise refused("load.acceleration", list(along), "three numbers, not all 0")
        return acceleration(assembly, along)
    force = mapping("load.force", load["force"], ("block", "at", "direction"))
    at, along = (vector(f"load.force.{name}", force[name]) for name in ("at", "direction"))
    try:
        return force_at(assembly, str(force["block"]), at, along)
    except ValueError as error:
        raise ValueError(f"load.force.{error}") from None


def _blocks(name: str, value: Any, folder: Path) -> list[Block]:
    """The block that is called ``name``, or those of a mesh file, whose path is from ``folder``."""
    if not isinstance(value, dict) or "file" not in value:
        return [_block(name, value)]
    key = f"blocks.{name}"
    given = mapping(key, value, ("file",), ("density", "fixed", "scale"))
    density = read_number(f"{key}.density", given.get("density", DENSITY), DENSITIES)
    scale = read_number(f"{key}.scale", given.get("scale", 1), POSITIVE)
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
        fixed = [int(read_number("fixed", node, _INDEX)) for node in fixed]
    return [
        replace(
            block,
            vertices=tuple((scale * x, scale * y, scale * z) for x, y, z in block.vertices),
        )
        for block in read_compas(path, density, fixed, name)
    ]


def _block(name: str, value: Any) -> Block:
    key = f"blocks.{name}"
    shapes = sorted(each for shape in SHAPES for each in shape)
    given = mapping(key, value, (), (*shapes, "density", "fixed", "material"))
    shape = frozenset(given) & frozenset(shapes)
    if shape not in SHAPES:
        raise ValueError(f"{key}: must have either {', or '.join(SHAPES.values())}, or file")
    density = read_number(f"{key}.density", given.get("density", DENSITY), DENSITIES)
    fixed = given.get("fixed", False)
    if not isinstance(fixed, bool):
        raise ValueError(f"{key}.fixed: {shown(fixed)} is not allowed; it must be true or false")
    if not isinstance(given.get("material", ""), str):
        raise ValueError(
            f"{key}.material: {shown(given['material'])} is not allowed; it must be a text"
        )
    return replace(
        _of_shape(name, key, given, shape, density, fixed), material=given.get("material")
    )


def _of_shape(
    name: str,
    key: str,
    given: Mapping[str, Any],
    shape: frozenset[str],
    density: float,
    fixed: bool,
) -> Block:
    if "low" in shape:
        low, high = (vector(f"{key}.{end}", given[end]) for end in ("low", "high"))
        return box(name, low, high, density, fixed=fixed)
    if "along" in shape:
        along = vector(f"{key}.along", given["along"])
        if len(listed(f"{key}.outline", given["outline"])) < 3:
            raise ValueError(f"{key}.outline: must have 3 or more points")
        return prism(name, vectors(f"{key}.outline", given["outline"]), along, density, fixed=fixed)
    faces = tuple(
        tuple(
            int(read_number(f"{key}.faces[{number}]", each, _INDEX)) for each in listed(key, face)
        )
        for number, face in enumerate(listed(f"{key}.faces", given["faces"]))
    )
    return Block(name, vectors(f"{key}.vertices", given["vertices"]), faces, density, fixed)
