"""Small configurations of studies."""

from typing import Any

CUT = {"upper_body": "columns"}  # as in the paper
SMALL: dict[str, Any] = {  # the static model of three locks
    "assembly": CUT,
    "samples": {"n3": {"locks": 3}},
    "meshes": [0.02],
    "eccentricities": [0, 0.5, "torsion"],
    "models": ["static"],
    "dem": {"engines": []},
}
TWO_MESHES = SMALL | {"meshes": [0.02, 0.01]}
COARSE = SMALL | {"meshes": [0.03]}
BOTH: dict[str, Any] = {"dem": {"engines": ["yade", "liggghts"]}}
ONE: dict[str, Any] = {"samples": {"n3": {"locks": 3}}, "assembly": CUT}


def merged(**change: Any) -> dict[str, Any]:
    return {**ONE, **change}
