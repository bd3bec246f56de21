"""A structure and its load from a YAML file; every fault in one line that names the key."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sidmacib.mechanics.assembly import Assembly, FaceMaterial, Loads
from sidmacib.problem import Problem
from sidmacib.structure.files.compas import NAME
from sidmacib.structure.files.sections import (
    FileSection,
    LoadSection,
    LocksSection,
    SpecialSection,
    StructureFile,
)
from sidmacib.structure.files.selection import Pair, Selection
from sidmacib.structure.interfaces import interfaces
from sidmacib.structure.locks import Locks
from sidmacib.structure.structure import structure
from sidmacib.yaml_text import read_yaml


def read_structure(path: Path) -> Problem:
    """The structure and its load or tilt in a YAML file, or in a JSON file of COMPAS.

    `sidmacib.yaml_text.TextError`, or ValueError that names the key, if it is not one.
    """
    return structure_of(description_in(path), path.parent)


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


def structure_of(description: Any, folder: Path = Path()) -> Problem:
    """The structure and the load of a ``description``, plain values as in a file.

    ``folder``: that paths of meshes start from. ValueError that names the key.
    """
    given = StructureFile.read(description)
    if given.load is None:
        raise ValueError("load: missing; this key is required")
    assembly = assembly_of(given, folder)
    return Problem(assembly, given.load.on(assembly))


def assembly_of(description: Any, folder: Path = Path()) -> Assembly:
    """The structure of a ``description``; arguments and errors of `structure_of`."""
    given = StructureFile.read(description)
    blocks = [b for name, each in given.blocks.items() for b in each.blocks(name, folder)]
    chosen = Selection(blocks, lambda: interfaces(blocks, given.tolerance))
    material = given.interfaces.material
    special = _special(given.special, material, chosen)
    locked = _locked(given.locks, chosen)
    return structure(
        blocks,
        material,
        special,
        locked,
        mesh=given.mesh or math.inf,
        nodes=given.nodes,
        near=given.tolerance,
        regions=chosen.found,
    )


def loads_of(assembly: Assembly, value: Any) -> Loads:
    """The weight of ``assembly`` and the load that a file's key ``load`` gives, for any model.

    ValueError, for a support that moves too.
    """
    given = LoadSection.read(value, "load")
    if given.support:
        raise ValueError("load.support: is for multilock assembly only; use another load here")
    return given.on(assembly)


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
        for block in FileSection.read(value, "blocks", name).blocks(str(name), folder):
            blocks[block.name] = {
                "vertices": [list(vertex) for vertex in block.vertices],
                "faces": [list(face) for face in block.faces],
                "density": block.density,
                "fixed": block.fixed,
                **({} if block.material is None else {"material": block.material}),
            }
    return {**description, "blocks": blocks}


def _special(
    sections: Sequence[SpecialSection], others: FaceMaterial, chosen: Selection
) -> dict[Pair, FaceMaterial]:
    """Materials of pairs of blocks: of a pair that fits several, the last.

    Two blocks may be named only once.
    """
    special: dict[Pair, FaceMaterial] = {}
    once: set[Pair] = set()
    for number, section in enumerate(sections, start=1):
        key = f"special.{number}.between"
        pairs = chosen.pairs(key, section.between)
        if isinstance(section.between, tuple):
            if pairs[0] in once:
                raise ValueError(f"{key}: {' and '.join(sorted(pairs[0]))} appear twice")
            once.add(pairs[0])
        special |= dict.fromkeys(pairs, section.material(others))
    return special


def _locked(sections: Sequence[LocksSection], chosen: Selection) -> dict[Pair, Locks]:
    """Locks of pairs of blocks; of a pair that fits several, the last."""
    locked: dict[Pair, Locks] = {}
    for number, section in enumerate(sections, start=1):
        pairs = chosen.pairs(f"locks.{number}.between", section.between)
        locked |= dict.fromkeys(pairs, section.locks())
    return locked
