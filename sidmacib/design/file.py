"""The key ``design`` of a structure's file, and the file of what was designed."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self
from urllib.parse import quote

import numpy as np
import yaml
from pydantic import BeforeValidator, StrictBool, model_validator

from sidmacib.contact_points import OPTIONS
from sidmacib.design import (
    Layout,
    LockKindSection,
    WeightsSection,
    directions_of,
    layouts_of,
)
from sidmacib.design.model import DesignProblem, LoadCase, Site
from sidmacib.mechanics.assembly import CLOSE, Assembly, Kind
from sidmacib.mechanics.polygons import Polygon
from sidmacib.quantities import Number, shown
from sidmacib.reading import Keys, Label, Some, Way
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.loads import CaseSection
from sidmacib.structure.files.sections import (
    NUMBERS,
    Option,
    Positive,
    StructureFile,
)
from sidmacib.structure.files.selection import two_blocks
from sidmacib.structure.files.structure_file import assembly_of, description_in, permanent_of
from sidmacib.validation import refused

DIGITS = 9  # of lengths (m) in the file that is written


def _pairs(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return tuple(map(two_blocks, value))
    return value


class DesignSection(Keys):
    """What `multilock design` is to find; docs/howto/design.md describes the keys."""

    cases: Annotated[dict[Label, CaseSection], Some]
    """the load cases by name"""
    locks: LockKindSection
    """the locks that a design is made of"""
    angles: Annotated[
        tuple[Annotated[float, Number(at_least=-360, at_most=360, unit="degrees")], ...], Some
    ] = (0.0, 90.0)
    """directions in which locks may run, from the level direction of an interface"""
    runs: Annotated[tuple[Way, ...], Some] | None = None
    """directions in which locks may run, in place of `angles`"""
    between: Annotated[Literal["all"] | tuple[tuple[str, str], ...], BeforeValidator(_pairs)] = (
        "all"
    )
    """pairs of blocks that may get locks"""
    weights: WeightsSection = WeightsSection()
    """what is to be small; by default the number of locks"""
    factor: Positive = 1.0
    """by which all cases are to be carried"""
    first_failure: StrictBool = False
    """whether the first failure of the static model is to carry them, and not the peak"""
    no_dilation: StrictBool = False
    """whether limit analysis without dilation is a check, too"""
    buildable: StrictBool = True
    """whether the blocks must have an order of placing"""
    raised: Annotated[int, Number(at_least=0, at_most=20, whole=True)] = 5
    """how often more may be demanded after a check that fails"""
    gap: Annotated[float, Number(at_least=1e-6, at_most=1)] = 0.01
    """largest distance of the cost from the least"""
    time_limit: Annotated[float, Number(above=0, unit="s")] = 60.0
    """longest time of a search, s"""
    option: Option = "option3"
    """where the forces of locks act"""

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.runs is not None and "angles" in self.model_fields_set:
            raise ValueError("must have either angles or runs")
        return self


class DesignFile(StructureFile):
    """A structure of blocks, its load, and perhaps the `design` that is to find its locks."""

    design: DesignSection | None = None
    """the task of `multilock design`; the other commands ignore it"""


@dataclass(frozen=True, eq=False)
class Task:
    """What a file asks to be designed.

    ``description``: the structure without locks, as in a file; ``folder``: that its paths start
    from. ``loads``: the key ``load`` of each case by its name. ``asked``: how the cases are to be
    carried.
    """

    description: Mapping[str, Any]
    folder: Path
    structure: DesignProblem
    loads: Mapping[str, Mapping[str, Any]]
    asked: DesignSection


def read_task(path: Path) -> Task:
    """What the file ``path``, in YAML or of COMPAS, asks; errors of `task_of`."""
    return task_of(description_in(path), path.parent)


def task_of(description: Any, folder: Path = Path()) -> Task:
    """The task in a ``description``, plain values as in a file; ValueError that names the key."""
    given = DesignFile.read(description)
    if given.design is None:
        raise ValueError("design: missing; this key is required")
    if "locks" in given.model_fields_set:
        raise ValueError("locks: must not be there, as the design finds them")
    design = given.design
    plain = {key: value for key, value in description.items() if key != "design"}
    texts = description["design"]["cases"].values()
    loads = {
        name: {key: text[key] for key in text if key in ("acceleration", "force")}
        for name, text in zip(design.cases, texts, strict=True)
    }
    plain.setdefault("load", next(iter(loads.values())))
    assembly = assembly_of(given, folder)
    structure = DesignProblem(
        assembly,
        _sites(assembly, design),
        load_cases(assembly, design, plain),
        design.weights,
        option=OPTIONS[design.option],
    )
    return Task(plain, folder, structure, loads, design)


def load_cases(
    assembly: Assembly, design: DesignSection, description: Mapping[str, Any]
) -> tuple[LoadCase, ...]:
    """The cases of a ``design`` on an ``assembly``, whose locks may be cut out.

    ``description``: of the structure, with its permanent loads. ValueError that names the case.
    """
    beside = permanent_of(assembly, description)
    return tuple(
        LoadCase(
            name,
            case.on(assembly, beside, f"design.cases.{name}"),
            case.amount(assembly) or 0.0,
        )
        for name, case in design.cases.items()
    )


def _sites(assembly: Assembly, design: DesignSection) -> tuple[Site, ...]:
    """The interfaces that may get locks: those that are dry, whole and between convex blocks."""
    kind = design.locks
    wanted = None if design.between == "all" else {frozenset(pair) for pair in design.between}
    names = [piece.name for piece in assembly.pieces]
    pairs = [frozenset((names[face.below], names[face.above])) for face in assembly.faces]
    for pair in wanted or ():
        if pair not in pairs:
            raise refused("design.between", " and ".join(sorted(pair)), "two blocks that touch")
    angles, runs = (design.angles, ()) if design.runs is None else ((), design.runs)
    found = []
    for number, (face, pair) in enumerate(zip(assembly.faces, pairs, strict=True)):
        assert isinstance(face, Polygon)
        solids = [assembly.pieces[end] for end in (face.below, face.above)]
        convex = all(isinstance(each, Block) and each.reentrant is None for each in solids)
        whole = pairs.count(pair) == 1 and not len(face.outline.interiors)
        if convex and whole and face.kind is Kind.DRY and (wanted is None or pair in wanted):
            _require_room(face, solids, kind.height)
            ways = directions_of(face, angles=angles, runs=runs)
            found.append(Site(number, layouts_of(face, kind, ways)))
    return tuple(found)


def _require_room(face: Polygon, solids: Sequence[Any], height: float) -> None:
    """ValueError if locks of this ``height`` (m) would cut through a block: half lies in each."""
    for solid in solids:
        depth = float(np.ptp(solid.vertices @ face.axes[0]))
        if height / 2 >= depth * (1.0 - CLOSE):
            allowed = f"less than {2.0 * depth:g} m, as {solid.name} is {depth:g} m deep there"
            raise refused("design.locks.height", height, allowed)


def designed(task: Task, choice: Sequence[Layout | None]) -> dict[str, Any]:
    """The description of the structure with the rows of ``choice``, one or None for each site."""
    assembly, numbers = task.structure.assembly, {*NUMBERS}
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
                "inner": layout.kind.inner.model_dump(include=numbers, exclude_none=True),
                "dry": layout.kind.dry.model_dump(include=numbers, exclude_none=True),
            }
        )
    return {**task.description, "locks": locks}


def case_files(task: Task, path: Path) -> list[Path]:
    """The files of `write_designed`, in the order of cases."""
    _, *others = task.loads
    named = [f"{path.stem}-{quote(name, safe=' ')}{path.suffix}" for name in others]
    return [path, *map(path.with_name, named)]


def write_designed(task: Task, choice: Sequence[Layout | None], path: Path) -> None:
    """Write `designed` into YAML files, with paths to files of blocks from their folder.

    ``path`` has the first case as its load; each other case has a file beside it, named after it.
    """
    description = designed(task, choice)

    def moved(value: Any) -> Any:
        if not isinstance(value, dict) or "file" not in value:
            return value
        there = os.path.relpath(task.folder / str(value["file"]), path.parent)
        return {**value, "file": Path(there).as_posix()}

    description["blocks"] = {name: moved(value) for name, value in description["blocks"].items()}
    cases = "".join(f"#   {_line(task, name)}\n" for name in task.loads)
    head = f"# With the locks that multilock design found for these cases:\n{cases}"
    for (name, load), file in zip(task.loads.items(), case_files(task, path), strict=True):
        text = f"{head}# The load is that of {shown(name)}.\n"
        text += yaml.safe_dump({**description, "load": load}, sort_keys=False, width=120)
        try:
            file.write_text(text, encoding="utf-8")
        except OSError as error:
            raise ValueError(f"--output {file}: {error.strerror or error}") from None


def _line(task: Task, case: str) -> str:
    """A case in a line of YAML."""
    amount = task.asked.cases[case].model_dump(
        include={"newtons", "over_weight"}, exclude_none=True
    )
    values = {case: {**task.loads[case], **amount}}
    flow = yaml.safe_dump(values, default_flow_style=True, width=1000)
    return flow.strip().removeprefix("{").removesuffix("}")
