"""Structures as a file describes them, to ask several doors about."""

from typing import Any

from conftest import ROOT

from sidmacib.mechanics.assembly import GRAVITY
from sidmacib.yaml_text import read_yaml
from workflow.schema import with_changes

BLOCK = {
    "blocks": {
        "base": {"low": [-1, -1, -0.3], "high": [2, 2, 0], "fixed": True},
        "top": {"low": [0, 0, 0], "high": [0.5, 0.5, 0.4]},
    },
    "interfaces": {"friction": 0.5, "cohesion": 1.5e4, "tensile_strength": 1.5e4},
    "load": {"acceleration": [1, 0, 0]},
}

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


def study(name: str, **interfaces: float) -> dict[str, Any]:
    description = read_yaml(ROOT / f"studies/{name}.yaml")
    return with_changes(description, {"interfaces": interfaces})


FILES = {
    "bonded block": BLOCK,
    "bonded arch": study("arch/arch", cohesion=5.0e4, tensile_strength=2.0e4),
    "mortar wall": study("wall/wall", cohesion=2.0e4, tensile_strength=1.0e4),
    "crushed arch": study("arch/arch", compressive_strength=1.5e5, friction=0.7),
    "trilith": study("structures/trilith"),
    "dry wall": study("wall/wall"),
}
