"""A structure and its load from a YAML file; every fault in one line that names the key."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sidmacib.mechanics.assembly import Assembly, FaceMaterial
from sidmacib.problem import Problem
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.block_files import SUFFIXES, FileSection, files_named
from sidmacib.structure.files.compas import NAME
from sidmacib.structure.files.loads import (
    LoadCaseSection,
    LoadSection,
    PermanentSection,
    load_warnings,
    permanent_on,
)
from sidmacib.structure.files.sections import (
    FROM_FILE,
    LocksSection,
    StructureFile,
)
from sidmacib.structure.files.selection import chosen_pairs
from sidmacib.structure.files.time_loads import TimeSection
from sidmacib.structure.files.vehicle import MOVING
from sidmacib.structure.interfaces import NEAR, Interface, in_order, interfaces, touching
from sidmacib.structure.loads import Permanent, permanent_only
from sidmacib.structure.locks import Locks, Row
from sidmacib.structure.partial_factors import NO_FACTORS, PartialFactors
from sidmacib.structure.shaking import IN_TIME
from sidmacib.structure.structure import Pair, rows_of, structure
from sidmacib.structure.vehicle import Position
from sidmacib.structure.warnings import structure_warnings
from sidmacib.yaml_text import read_yaml

OF_BLOCKS = ".json", *SUFFIXES  # endings of files that have blocks


def description_in(
    path: Path,
    more: Mapping[str, Any] | None = None,
    left_out: Callable[[str], object] | None = None,
) -> Any:
    """What is in a file; of one of COMPAS, Rhino or meshes with what the YAML beside it adds.

    By default such blocks are pushed along x. ``more``: keys that are added to those of the file,
    and `blocks` with keys for the blocks of a file that is no YAML. ``left_out``: is told the name
    of a YAML beside the file that has blocks itself, and so adds nothing; else that is an error.
    `sidmacib.yaml_text.TextError` for what is no YAML.
    """
    more = dict(more or {})
    of_blocks = more.pop("blocks", {})
    alone = path.suffix.lower() in OF_BLOCKS
    beside = path.with_suffix(".yaml") if alone else path
    given = {} if alone and not beside.is_file() else read_yaml(beside)
    if not isinstance(given, dict):
        return given
    if alone:
        if "blocks" in given:
            if left_out is None:
                raise ValueError(
                    f"{beside.name}: blocks: must not be there, as {path.name} beside it has them; "
                    f"name {beside.name} in its place, or rename one of them"
                )
            left_out(beside.name)
            given = {}
        blocks = {NAME: {"file": path.name, **of_blocks}}
        given = {"blocks": blocks, "load": {"acceleration": [1, 0, 0]}} | given
    elif of_blocks:
        raise ValueError(f"{', '.join(of_blocks)}: must be in {path.name}, which has the blocks")
    for key, value in more.items():
        held = given.get(key)
        both = isinstance(held, dict) and isinstance(value, dict)
        given[key] = {**held, **value} if both and held else value
    return given


def files_behind(path: Path, description: Any) -> Iterator[Path]:
    """The files that a ``description`` in the file ``path`` comes from, and those it names."""
    yield path
    yield path.with_suffix(".yaml")
    yield from _named_in(description, path.parent)


def _named_in(value: Any, folder: Path) -> Iterator[Path]:
    named = value if isinstance(value, Mapping) else {}
    for key, each in named.items():
        if key in ("file", "record") and isinstance(each, str):
            yield from files_named(each, folder)
    for each in named.values() if named else value if isinstance(value, list) else ():
        yield from _named_in(each, folder)


def structure_of(description: Any, folder: Path = Path()) -> Problem:
    """The structure and the load of a ``description``, plain values as in a file.

    ``folder``: that paths of meshes start from. ValueError that names the key.
    """
    given = StructureFile.read(description)
    if given.load is None:
        words = "; load_cases are for multilock assembly and studies" if given.load_cases else ""
        raise ValueError(f"load: missing; this key is required{words}")
    if isinstance(given.load, LoadSection) and given.load.vehicle:
        raise ValueError(f"load.{MOVING}")
    (demand,) = demands_of(given, folder)
    return demand.problem


@dataclass(frozen=True)
class Demand:
    """A structure under a load, and how much of it (N) is to be carried, if the file says.

    ``case``: the name of the load case, if it is one of several. ``raises``: whether there is a
    load to be raised, and not only permanent ones. ``position``: of a vehicle that moves.
    ``factors``: that are in all of this.
    """

    problem: Problem
    newtons: float | None = None
    case: str | None = None
    raises: bool = True
    position: Position | None = None
    factors: PartialFactors = NO_FACTORS

    def factored(self, factors: PartialFactors) -> "Demand":
        """The demand of design values; ValueError where nothing is to be carried."""
        if not factors:
            return self
        if self.newtons is None:
            name = next(name for name, value in factors.named.items() if value != 1.0)
            raise ValueError(f"{name}: needs a load that is to be carried: newtons or over_weight")
        return replace(
            self,
            problem=factors.on(self.problem),
            newtons=factors.gamma_q * self.newtons,
            factors=factors,
        )


def demands_of(
    description: Any,
    folder: Path = Path(),
    *,
    in_time: bool = False,
    factors: PartialFactors = NO_FACTORS,
) -> tuple[Demand, ...]:
    """What a ``description`` demands: of its load, of each load case and position, or of none.

    Arguments and errors as of `structure_of`, but for a load that is missing. ``in_time``: whether
    loads may act in time, which else are an error. ``factors``: of design values; ValueError where
    nothing is to be carried.
    """
    given = StructureFile.read(description)
    found = _demanded(given, folder, factors.gamma_g, in_time=in_time)
    return tuple(each.factored(factors) for each in found)


def _demanded(
    given: StructureFile, folder: Path, gamma_g: float, *, in_time: bool
) -> Iterator[Demand]:
    """As `demands_of`, before ``gamma_g`` multiplies all permanent loads."""
    if given.load is not None and given.load_cases is not None:
        raise ValueError("load_cases: must not be given beside load")
    assembly = assembly_of(given, folder)
    always = permanent_on(assembly, given.permanent, given.tolerance, gamma_g=gamma_g)
    if isinstance(given.load, TimeSection):
        if not in_time:
            raise ValueError(IN_TIME)
        yield Demand(Problem(assembly, given.load.on(assembly, always, folder)))
    elif given.load is not None:
        yield from _demands(assembly, given.load, always, "load")
    elif given.load_cases is None:
        yield Demand(Problem(assembly, permanent_only(assembly, always)), raises=False)
    for name, case in (given.load_cases or {}).items():
        key = f"load_cases.{name}"
        own = permanent_on(assembly, case.permanent, given.tolerance, f"{key}.permanent", gamma_g)
        yield from _demands(assembly, case, always + own, key, name)


def _demands(
    assembly: Assembly,
    load: LoadSection | LoadCaseSection,
    beside: Permanent,
    key: str,
    case: str | None = None,
) -> Iterator[Demand]:
    """What a ``load`` demands, which is called ``case`` if it is one: of a vehicle one each."""
    if load.vehicle is None:
        problem = Problem(assembly, load.on(assembly, beside, key))
        yield Demand(problem, load.amount(assembly), case)
        return
    for position, loads, newtons in load.vehicle.on(assembly, beside, key):
        name = ", ".join([*([case] if case else []), str(position)])
        yield Demand(Problem(assembly, loads), newtons, name, position=position)


def notes_on(description: Any, assembly: Assembly) -> list[str]:
    """A line each for what looks wrong in a ``description``, and for what it leaves to defaults.

    ``assembly``: of the description.
    """
    given = StructureFile.read(description)
    notes = structure_warnings(assembly, given.tolerance, given.interfaces.from_file)
    notes += load_warnings(assembly, given.pushed)
    if given.assumed:
        notes.append(f"assumed: {', '.join(' '.join(each) for each in given.assumed.items())}")
    laws = (given.interfaces, *given.special)
    if given.locks and any(law.compressive_strength is not None for law in laws):
        notes.append("compressive_strength: does not limit interfaces with locks")
    return notes


def required_of(description: Mapping[str, Any], assembly: Assembly | None = None) -> float | None:
    """How much of its load (N) a ``description`` wants to be carried; None if it does not say.

    ``assembly``: of the description, if it is there. ValueError that names the key.
    """
    given = LoadSection.read(description.get("load"), "load")
    if given.over_weight is not None and assembly is None:
        assembly = assembly_of(description)
    return given.amount(assembly)


def blocks_and_rows(
    description: Any, folder: Path = Path()
) -> tuple[list[Block], dict[Pair, Row], float]:
    """The blocks of a ``description``, where their locks are, and the tolerance of interfaces.

    Arguments as of `structure_of`, but without a load. ValueError that names the key.
    """
    given = StructureFile.read(description)
    blocks, found = _in_contact(given, folder)
    return blocks, rows_of(blocks, _locked(given.locks, blocks, found), found), given.tolerance


def assembly_of(description: Any, folder: Path = Path()) -> Assembly:
    """The structure of a ``description``; arguments and errors of `structure_of`."""
    given = StructureFile.read(description)
    blocks, found = _in_contact(given, folder)
    special: dict[Pair, FaceMaterial] = {}  # of a pair that fits several, the last
    named: set[Pair] = set()  # once only
    for number, section in enumerate(given.special, start=1):
        key = f"special.{number}.between"
        pairs = chosen_pairs(key, section.between, blocks, found)
        if isinstance(section.between, tuple):
            if named.issuperset(pairs):
                raise ValueError(f"{key}: {' and '.join(sorted(pairs[0]))} appear twice")
            named.update(pairs)
        special |= dict.fromkeys(pairs, section.material(given.interfaces.material))
    return structure(
        blocks,
        given.interfaces.material,
        special,
        _locked(given.locks, blocks, found),
        mesh=given.mesh or math.inf,
        nodes=given.nodes,
        near=given.tolerance,
        regions=found,
    )


def _in_contact(given: StructureFile, folder: Path) -> tuple[list[Block], tuple[Interface, ...]]:
    """The blocks, and the interfaces between them: found, or those that files bring."""
    made = [each.blocks(name, folder) for name, each in given.blocks.items()]
    blocks = [block for each in made for block in each]
    if given.interfaces.from_file:
        return blocks, _of_files(given, folder, made)
    return blocks, interfaces(blocks, given.tolerance)


def _of_files(
    given: StructureFile, folder: Path, made: Sequence[Sequence[Block]]
) -> tuple[Interface, ...]:
    """Interfaces that files bring between their blocks, and those found between all others.

    ``made``: the blocks of each entry. ValueError if no file brings any.
    """
    found: list[Interface] = []
    entry = [number for number, each in enumerate(made) for _ in each]
    brings = set()
    for number, (section, blocks) in enumerate(zip(given.blocks.values(), made, strict=True)):
        if isinstance(section, FileSection) and section.is_compas:
            start = entry.index(number)
            brings.add(number)
            found += [
                replace(each, below=start + each.below, above=start + each.above)
                for each in section.interfaces(folder, blocks)
            ]
    if not found:
        raise ValueError("interfaces.from_file: no file brings interfaces; leave it out")
    if len(made) > 1:
        for each in touching([block for blocks in made for block in blocks], given.tolerance):
            if entry[each.below] != entry[each.above] or entry[each.below] not in brings:
                found.append(each)
    return in_order(found)


def permanent_of(assembly: Assembly, description: Mapping[str, Any]) -> Permanent:
    """The permanent loads of a ``description`` in plain values, but for weight; ValueError."""
    sections = [
        PermanentSection.read(each, "permanent") for each in description.get("permanent", ())
    ]
    return permanent_on(assembly, sections, float(description.get("tolerance", NEAR)))


def with_bodies(description: Any, folder: Path) -> Any:
    """``description`` with vertices and faces in place of blocks from mesh files.

    ``folder``: that their paths start from. ValueError that names the key of one at fault.
    """
    if not isinstance(description, dict) or not isinstance(description.get("blocks"), dict):
        return description
    laws = description.get("interfaces")
    if laws == FROM_FILE or (isinstance(laws, dict) and laws.get(FROM_FILE)):
        raise ValueError("interfaces.from_file: is for multilock assembly, not for studies")
    blocks: dict[str, Any] = {}
    for name, value in description["blocks"].items():
        if not isinstance(value, dict) or "file" not in value:
            blocks[name] = value
            continue
        section = FileSection.read(value, "blocks", name)
        assumed = section.assumes_density  # the description says so, and whether the unit is
        unit = {"mesh": section.file} if section.assumes_unit else {"unit": "m"}
        for block in section.blocks(str(name), folder):
            blocks[block.name] = {
                "vertices": [list(vertex) for vertex in block.vertices],
                "faces": [list(face) for face in block.faces],
                **({} if assumed else {"density": block.density}),
                **unit,
                "fixed": block.fixed,
                **({} if block.material is None else {"material": block.material}),
            }
    return {**description, "blocks": blocks}


def _locked(
    sections: Sequence[LocksSection], blocks: Sequence[Block], found: Sequence[Interface]
) -> dict[Pair, Locks]:
    """Locks of pairs of blocks; of a pair that fits several, the last."""
    locked: dict[Pair, Locks] = {}
    for number, section in enumerate(sections, start=1):
        pairs = chosen_pairs(f"locks.{number}.between", section.between, blocks, found)
        locked |= dict.fromkeys(pairs, section.locks())
    return locked
