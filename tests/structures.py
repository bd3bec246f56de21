"""What tests of structures share."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation
from small import COARSE

from sidmacib import Assembly, FaceMaterial, limit_load
from sidmacib.structure.blocks import Block, box, prism
from sidmacib.structure.loads import acceleration, free_weight
from sidmacib.structure.structure import structure
from sidmacib.yaml_text import read_yaml


def example(name: str) -> dict[str, Any]:
    """The description of a structure of the published studies."""
    folder = Path(__file__).parents[1] / "studies/structures"
    found: dict[str, Any] = read_yaml(folder / f"{name}.yaml")
    return found


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


def tilt(assembly: Assembly) -> float:
    """Angle in degrees at which a dry structure fails when it is tilted towards x."""
    loads = acceleration(assembly, (1.0, 0.0, 0.0))
    load = limit_load(assembly, loads, friction=True).load
    return degrees(load / free_weight(assembly))
