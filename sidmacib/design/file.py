"""The key ``design`` of a structure's file, and the file of what was designed."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import yaml

from sidmacib.contact_points.options import OPTIONS
from sidmacib.design.layouts import Layout, LockKind, Weights, directions_of, layouts_of
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.joint.joint import DRY, INNER
from sidmacib.mechanics.assembly import CLOSE, Assembly, FaceMaterial, Kind, Loads
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Number, shown
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.keys import (
    MATERIAL,
    POSITIVE,
    listed,
    mapping,
    named,
    read_material,
    read_number,
    vector,
)
from sidmacib.structure.files.selection import ALL
from sidmacib.structure.files.structure_file import assembly_of, description_in, loads_of
from sidmacib.structure.loads import free_weight
from sidmacib.validation import refused

KEYS = (
    *("angles", "runs", "between", "weights", "factor", "first_failure", "no_dilation"),
    *("buildable", "raised", "gap", "time_limit", "option"),
)
DIGITS = 9  # of lengths (m) in the file that is written
MOST = 25  # locks that work in an interface, unless the file names fewer
_ANGLE = Number(at_least=-360, at_most=360, unit="degrees")
_WHOLE = Number(at_least=1, at_most=500, whole=True)
_NOT_NEGATIVE = Number(at_least=0)
_ROUNDS = Number(at_least=0, at_most=20, whole=True)
_GAP = Number(at_least=1e-6, at_most=1)


@dataclass(frozen=True)
class CaseText:
    """A load case as the file has it: plain values of a key ``load``, and how much is carried.

    ``newtons``, or ``over_weight`` of what can move.
    """

    name: str
    load: Any
    newtons: float | None
    over_weight: float | None

    @property
    def line(self) -> str:
        """The case in a line of YAML."""
        amount = "newtons" if self.over_weight is None else "over_weight"
        values = {**self.load, amount: getattr(self, amount)}
        flow = yaml.safe_dump({self.name: values}, default_flow_style=True, width=1000)
        return flow.strip().removeprefix("{").removesuffix("}")

    def of(self, assembly: Assembly) -> LoadCase:
        """The case on an ``assembly``, whose locks may be cut out; ValueError."""
        return LoadCase(self.name, self.loads(assembly), self.amount(assembly))

    def loads(self, assembly: Assembly) -> Loads:
        """ValueError that names the case."""
        try:
            return loads_of(assembly, self.load)
        except ValueError as error:
            raise ValueError(f"design.cases.{self.name}.{error}") from None

    def amount(self, assembly: Assembly) -> float:
        """What is to be carried, in N."""
        if self.over_weight is None:
            assert self.newtons is not None
            return self.newtons
        return self.over_weight * free_weight(assembly)


@dataclass(frozen=True, eq=False)
class Task:
    """What a file asks to be designed.

    ``description``: the structure without locks, as in a file; ``folder``: that its paths start
    from. ``factor``: that all cases are to be carried by; by the ``first_failure`` or the peak of
    the static model. ``no_dilation``: whether limit analysis without dilation, which takes up to 60
    rounds, is a check, too. ``buildable``: whether an order of placing is needed. ``raised``: how
    often more may be demanded after a check that fails.
    """

    description: Mapping[str, Any]
    folder: Path
    structure: DesignProblem
    cases: tuple[CaseText, ...]
    factor: float
    first_failure: bool
    no_dilation: bool
    buildable: bool
    raised: int
    gap: float
    time_limit: float


def read_task(path: Path) -> Task:
    """What the file ``path``, in YAML or of COMPAS, asks; errors of `read_structure`."""
    return task_of(description_in(path), path.parent)


def task_of(description: Any, folder: Path = Path()) -> Task:
    """The task in a ``description``, plain values as in a file; ValueError that names the key."""
    if not isinstance(description, dict) or "design" not in description:
        raise ValueError("the file: lacks the key design")
    plain = {key: value for key, value in description.items() if key != "design"}
    if "locks" in plain:
        raise ValueError("locks: must not be there, as the design finds them")
    given = mapping("design", description["design"], ("cases", "locks"), KEYS)
    cases = _cases(given["cases"])
    plain.setdefault("load", cases[0].load)
    assembly = assembly_of(plain, folder=folder)
    kind, most = _kind(given["locks"])
    sites = _sites(assembly, given, kind, most)
    option = given.get("option", "option3")
    if not isinstance(option, str) or option not in OPTIONS:
        raise refused("design.option", option, f"one of {', '.join(OPTIONS)}")
    structure = DesignProblem(
        assembly,
        sites,
        tuple(case.of(assembly) for case in cases),
        _weights(given.get("weights", {})),
        option=OPTIONS[option],
    )
    numbers = {
        name: read_number(f"design.{name}", given.get(name, default), allowed)
        for name, default, allowed in (
            ("factor", 1.0, POSITIVE),
            ("raised", 5, _ROUNDS),
            ("gap", 0.01, _GAP),
            ("time_limit", 60.0, POSITIVE),
        )
    }
    flags = {
        name: _flag(f"design.{name}", given.get(name, default))
        for name, default in (("first_failure", False), ("no_dilation", False), ("buildable", True))
    }
    return Task(
        plain,
        folder,
        structure,
        cases,
        numbers["factor"],
        flags["first_failure"],
        flags["no_dilation"],
        flags["buildable"],
        int(numbers["raised"]),
        numbers["gap"],
        numbers["time_limit"],
    )


def _cases(value: Any) -> tuple[CaseText, ...]:
    found = []
    for name, each in named("design.cases", value).items():
        key = f"design.cases.{name}"
        given = mapping(key, each, (), ("acceleration", "force", "newtons", "over_weight"))
        load = {k: given[k] for k in ("acceleration", "force") if k in given}
        if len(load) != 1:
            raise ValueError(f"{key}: must have either acceleration or force")
        amounts = {
            k: read_number(f"{key}.{k}", given[k], POSITIVE)
            for k in ("newtons", "over_weight")
            if k in given
        }
        if len(amounts) != 1:
            raise ValueError(f"{key}: must have either newtons or over_weight")
        found.append(CaseText(name, load, amounts.get("newtons"), amounts.get("over_weight")))
    return tuple(found)


def _kind(value: Any) -> tuple[LockKind, int]:
    key = "design.locks"
    given = mapping(key, value, ("width", "height"), ("most", "inner", "dry"))
    widths = given["width"] if isinstance(given["width"], list) else [given["width"]]
    materials = {
        name: read_material(
            f"{key}.{name}",
            given.get(name, {}),
            {field: getattr(default, field) for field in MATERIAL},
        )
        for name, default in (("inner", INNER), ("dry", DRY))
    }
    try:
        kind = LockKind(
            tuple(read_number(f"{key}.width", each, POSITIVE) for each in widths),
            read_number(f"{key}.height", given["height"], POSITIVE),
            materials["inner"],
            materials["dry"],
        )
    except ValueError as error:
        raise ValueError(str(error) if str(error).startswith(key) else f"{key}: {error}") from None
    return kind, int(read_number(f"{key}.most", given.get("most", MOST), _WHOLE))


def _weights(value: Any) -> Weights:
    given = mapping("design.weights", value, (), ("number", "area", "volume"))
    numbers = {k: read_number(f"design.weights.{k}", v, _NOT_NEGATIVE) for k, v in given.items()}
    try:
        return Weights(**({"number": 0.0, **numbers} if numbers else {}))
    except ValueError as error:
        raise ValueError(f"design.{error}") from None


def _sites(
    assembly: Assembly, given: Mapping[str, Any], kind: LockKind, most: int
) -> tuple[Site, ...]:
    """The interfaces that may get locks: those that are dry, whole and between convex blocks."""
    if "angles" in given and "runs" in given:
        raise ValueError("design: must have either angles or runs")
    for name in ("angles", "runs"):
        if name in given and not listed(f"design.{name}", given[name]):
            raise ValueError(f"design.{name}: must have at least one direction")
    angles = [
        read_number("design.angles", each, _ANGLE)
        for each in listed("design.angles", given.get("angles", [0.0, 90.0]))
    ]
    runs = [
        vector(f"design.runs[{k}]", each)
        for k, each in enumerate(listed("design.runs", given.get("runs", [])))
    ]
    for run in runs:
        if not any(run):
            raise refused("design.runs", list(run), "three numbers, not all 0")
    wanted = _pairs(given.get("between", ALL))
    names = [piece.name for piece in assembly.pieces]
    pairs = [frozenset((names[face.below], names[face.above])) for face in assembly.faces]
    for pair in wanted or ():
        if pair not in pairs:
            raise refused("design.between", " and ".join(sorted(pair)), "two blocks that touch")
    found = []
    for number, (face, pair) in enumerate(zip(assembly.faces, pairs, strict=True)):
        assert isinstance(face, Polygon)
        solids = [assembly.pieces[end] for end in (face.below, face.above)]
        convex = all(isinstance(each, Block) and each.reentrant is None for each in solids)
        whole = pairs.count(pair) == 1 and not len(face.outline.interiors)
        if convex and whole and face.kind is Kind.DRY and (wanted is None or pair in wanted):
            _require_room(face, solids, kind.height)
            ways = directions_of(face, angles=() if runs else angles, runs=runs)
            found.append(Site(number, layouts_of(face, kind, ways, most)))
    return tuple(found)


def _require_room(face: Polygon, solids: Sequence[Any], height: float) -> None:
    """ValueError if locks of this ``height`` (m) would cut through a block: half lies in each."""
    for solid in solids:
        depth = float(np.ptp(solid.vertices @ face.axes[0]))
        if height / 2 >= depth * (1.0 - CLOSE):
            allowed = f"less than {2.0 * depth:g} m, as {solid.name} is {depth:g} m deep there"
            raise refused("design.locks.height", height, allowed)


def _pairs(value: Any) -> set[frozenset[str]] | None:
    if value == ALL:
        return None
    found = set()
    for number, each in enumerate(listed("design.between", value)):
        pair = listed(f"design.between[{number}]", each)
        if len(pair) != 2:
            raise ValueError(f"design.between[{number}]: must be a list of two blocks")
        found.add(frozenset(map(str, pair)))
    return found


def _flag(key: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{key}: {shown(value)} is not allowed; it must be true or false")
    return value


def with_demand(task: Task, demand: Mapping[str, float]) -> Task:
    """The task with the load of each case, by its name, multiplied by its ``demand``."""
    cases = tuple(
        replace(case, load=case.load * demand[case.name]) for case in task.structure.cases
    )
    return replace(task, structure=replace(task.structure, cases=cases))


def designed(task: Task, choice: Sequence[Layout | None]) -> dict[str, Any]:
    """The description of the structure with the rows of ``choice``, one or None for each site."""
    assembly = task.structure.assembly
    locks = []
    for site, layout in zip(task.structure.sites, choice, strict=True):
        if layout is None:
            continue
        face = assembly.faces[site.face]
        below, above = (assembly.pieces[end].name for end in (face.below, face.above))
        locks.append(
            {
                "between": [below, above],
                "count": len(layout.widths),
                "height": layout.kind.height,
                "run": list(layout.run),
                "first": below,
                "widths": [round(width, DIGITS) for width in layout.widths],
                "inner": _numbers(layout.kind.inner),
                "dry": _numbers(layout.kind.dry),
            }
        )
    return {**task.description, "locks": locks}


def write_designed(task: Task, choice: Sequence[Layout | None], path: Path) -> None:
    """Write `designed` into YAML files, with paths to files of blocks from their folder.

    ``path`` has the first case as its load; each other case has a file beside it (`beside`).
    """
    description = designed(task, choice)

    def moved(value: Any) -> Any:
        if not isinstance(value, dict) or "file" not in value:
            return value
        there = os.path.relpath(task.folder / str(value["file"]), path.parent)
        return {**value, "file": Path(there).as_posix()}

    description["blocks"] = {name: moved(value) for name, value in description["blocks"].items()}
    cases = "".join(f"#   {case.line}\n" for case in task.cases)
    head = f"# With the locks that multilock design found for these cases:\n{cases}"
    for number, case in enumerate(task.cases):
        file = beside(path, case) if number else path
        content = {**description, "load": case.load}
        text = head + f"# The load is that of {shown(case.name)}.\n"
        text += yaml.safe_dump(content, sort_keys=False, width=120)
        try:
            file.write_text(text, encoding="utf-8")
        except OSError as error:
            raise ValueError(f"--output {file}: {error.strerror or error}") from None


def beside(path: Path, case: CaseText) -> Path:
    """The file beside ``path`` for a ``case`` that is not the first, named after it."""
    return path.with_name(f"{path.stem}-{quote(case.name, safe=' ')}{path.suffix}")


def _numbers(material: FaceMaterial) -> dict[str, float]:
    return {name: getattr(material, name) for name in MATERIAL}
