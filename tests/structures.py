"""What tests of structures share."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from small import COARSE

from sidmacib import Assembly, FaceMaterial
from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.models import MODELS
from sidmacib.problem import Problem
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.files.block_files import surfaces_in
from sidmacib.structure.files.repair import repaired
from sidmacib.structure.files.structure_file import description_in, structure_of
from sidmacib.structure.structure import structure
from sidmacib.yaml_text import read_yaml
from workflow import engine, solve
from workflow.configuration import read_study
from workflow.jobs import case_jobs
from workflow.results import read_records
from workflow.results.structure_part import StructureRecord
from workflow.schema import with_changes


def study(name: str, **interfaces: float) -> dict[str, Any]:
    """The description in a file of the studies, with other ``interfaces``."""
    description = read_yaml(Path(__file__).parents[1] / f"studies/{name}.yaml")
    return with_changes(description, {"interfaces": interfaces} if interfaces else {})


def example(name: str) -> dict[str, Any]:
    """The description of a structure of the published studies."""
    return study(f"structures/{name}")


def read_structure(path: Path) -> Problem:
    """The structure and its load in a file."""
    return structure_of(description_in(path), path.parent)


def read_flat_vault(blocks: int) -> Problem:
    """Abeille's flat vault of so many blocks along either side."""
    return structure_of(study(f"flat_vault/vault{blocks}"))


def row_of_cubes(count: int) -> list[Block]:
    """Cubes side by side without a floor between two fixed walls: only locks hold them up."""
    edge = 0.4
    names = ["left", *(f"cube{number}" for number in range(count)), "right"]
    return [
        box(name, (x, 0.0, 0.0), (x + edge, edge, edge), 2e3, fixed=name in ("left", "right"))
        for name, x in zip(names, (edge * (place - 1) for place in range(len(names))), strict=True)
    ]


def condensed_keys() -> dict[str, Any]:
    """Keyed blocks whose locks are condensed, which the static model refuses."""
    keyed = example("keyed")
    (locks,) = keyed["locks"]
    return {**keyed, "locks": [{**locks, "condensed": {"working": 1}}]}


ONLY_STRUCTURES = {  # a trilith with bonds and without, condensed locks, and a stack that is tilted
    "structures": {
        "trilith": {"description": example("trilith"), "variants": {"dry": {"special": None}}},
        "keyed": {"description": condensed_keys()},
        "stack": {"description": example("stack")},
    },
    "models": ["static", "limit"],
    "dem": {"engines": []},
}
WITH_STRUCTURES = COARSE | ONLY_STRUCTURES | {"eccentricities": [0, 0.3]}


def solved(folder: Path, **config: Any) -> list[StructureRecord]:
    """The records of a study, whose steps are called one by one."""
    jobs, records = case_jobs(read_study(config)), []
    for job, case in jobs.engines.items():
        (folder / job).mkdir(parents=True)
        outputs = {name: folder / job / f"{name}.json" for name in ("record", "result")}
        arguments = {"case": case.to_json(), "time_limit": 300.0, "last_try": 1}
        engine.run(arguments, {}, outputs)
        records.append(outputs["record"])
    for job, cases in jobs.batches.items():
        (folder / job).mkdir(parents=True)
        outputs = {name: folder / job / name for name in ("records", "nodes", "history")}
        module = MODELS[cases[0].model].structures
        arguments = {"module": module, "cases": [case.to_json() for case in cases]}
        solve.run(arguments, {}, outputs)
        records.append(outputs["records"])
    return read_records(records)


def dry(friction: float) -> FaceMaterial:
    return FaceMaterial(1e10, 1e10, friction, 0.0, 0.0)


GROUND = box("ground", (-2.0, -2.0, -1.0), (2.0, 2.0, 0.0), 2e3, fixed=True)
BLOCK = box("block", (0.0, 0.0, 0.0), (0.4, 0.6, 1.0), 2e3)
LEANING = prism(  # falls over
    "leaning", [(0, 0, 0), (0.4, 0, 0), (1.4, 0, 1.0), (1.0, 0, 1.0)], (0.0, 0.6, 0.0), 2e3
)


def on_ground(friction: float) -> Assembly:
    return structure([GROUND, BLOCK], dry(friction))


def degrees(slope: float) -> float:
    return math.degrees(math.atan(slope))


def moved(block: Block, turn: Rotation, shift: Sequence[float]) -> Block:
    """The block turned about the origin, then shifted (m)."""
    places = turn.apply(block.places) + np.array(shift)
    return replace(block, vertices=tuple(tuple(map(float, place)) for place in places))


def notch(width: float, height: float) -> list[Block]:
    """A long block in a notch between two flanks, as type c: it turns over before it slides."""
    low, high = 0.5, 0.5 + width / math.sqrt(3.0)
    blocks = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        top = [(side * 2.0, 0, high), (side * width, 0, high), (0, 0, low)]
        outline = [(0, 0, 0), (side * 2.0, 0, 0), *top]
        blocks.append(prism(name, outline, (0.0, 1.0, 0.0), 2e3, fixed=True))
    outline = [(0, 0, low), (width, 0, high), (width, 0, height), (-width, 0, height)]
    return [*blocks, prism("key", [*outline, (-width, 0, high)], (0.0, 1.0, 0.0), 2e3)]


# --- as a file describes them, to ask several doors about -----------------------------------------
CUBE: dict[str, Any] = {  # of 1 m
    "blocks": {
        "ground": {"low": [-2, -2, -1], "high": [3, 3, 0], "fixed": True},
        "cube": {"low": [0, 0, 0], "high": [1, 1, 1], "density": 2000},
    },
    "interfaces": {"friction": 0.5},
}
WEIGHT = 2000.0 * GRAVITY  # N, of the cube
PUSH: dict[str, Any] = {"acceleration": [1, 0, 0]}
DOWN: dict[str, Any] = {"force": {"block": "cube", "at": [0.5, 0.5, 1], "direction": [0, 0, -1]}}
FILES = {
    "bonded block": {
        "blocks": {
            "base": {"low": [-1, -1, -0.3], "high": [2, 2, 0], "fixed": True},
            "top": {"low": [0, 0, 0], "high": [0.5, 0.5, 0.4]},
        },
        "interfaces": {"friction": 0.5, "cohesion": 1.5e4, "tensile_strength": 1.5e4},
        "load": PUSH,
    },
    "bonded arch": study("arch/arch", cohesion=5.0e4, tensile_strength=2.0e4),
    "mortar wall": study("wall/wall", cohesion=2.0e4, tensile_strength=1.0e4),
    "crushed arch": study("arch/arch", compressive_strength=1.5e5, friction=0.7),
    "trilith": example("trilith"),
    "dry wall": study("wall/wall"),
}
FALLS = {"pressure": {"side": [-1, 0, 0], "pascals": 4e4}}
DEMANDED = {
    "bonds": with_changes(example("trilith"), {"load": {"newtons": "4kN"}}),
    "wall": example("retaining"),
    "arch": {  # a bond fails before the load is raised
        **study("arch/arch"),
        "interfaces": {"cohesion": "20kPa", "tensile_strength": "10kPa"},
        "load": {**PUSH, "newtons": "1kN"},
    },
    "locks": with_changes(condensed_keys(), {"load": {"newtons": 100}}),
    "crushed": {
        **CUBE,
        "interfaces": {"friction": 0.7, "compressive_strength": "50kPa"},
        "load": {**PUSH, "over_weight": 0.45},
    },
    "cases": {
        **CUBE,
        "permanent": [{"surcharge": {"pascals": 1e3}}],
        "load_cases": {
            "wind, full": {**PUSH, "newtons": 2e4},
            "crowd": {**DOWN, "newtons": "1kN"},
            "flood": {**PUSH, "newtons": 1, "permanent": [FALLS]},
        },
    },
}


def blocks_from_mesh(path: Path, density: float) -> dict[str, Block]:
    return {name: repaired(name, *of, density) for name, of in surfaces_in(path).items()}
