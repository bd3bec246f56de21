"""Laws and locks of interfaces by name, by material, by direction or by a rule."""

from typing import Any

import pytest

from sidmacib.mechanics.assembly import Kind
from sidmacib.structure.files.structure_file import structure_of


def block(x: float, z: float, **more: Any) -> dict[str, Any]:
    return {"low": [x, 0, z], "high": [x + 1, 1, z + 1], **more}


WALL: dict[str, Any] = {  # two by two on a base: bed joints are level, head joints upright
    "blocks": {
        "base": {"low": [0, 0, -1], "high": [2, 1, 0], "fixed": True, "material": "rock"},
        "low-1": block(0, 0, material="stone"),
        "low-2": block(1, 0, material="brick"),
        "top-1": block(0, 1, material="stone"),
        "top-2": block(1, 1, material="brick"),
    },
    "load": {"acceleration": [1, 0, 0]},
}


def frictions(*special: dict[str, Any]) -> dict[str, float]:
    """The friction of each interface."""
    assembly = structure_of({**WALL, "special": list(special)}).assembly
    return {face.name: face.material.friction for face in assembly.faces}


def chosen(between: Any) -> set[str]:
    """The interfaces that a rule fits."""
    found = frictions({"between": between, "friction": 0.1})
    return {name for name, friction in found.items() if friction == 0.1}


BEDS = {"base-low-1", "base-low-2", "low-1-top-1", "low-2-top-2"}
HEADS = {"low-1-low-2", "top-1-top-2"}


@pytest.mark.parametrize(
    ("between", "expected"),
    [
        (["top-1", "low-1"], {"low-1-top-1"}),
        ("all", BEDS | HEADS),
        ({"normal": [0, 0, 1]}, BEDS),
        ({"normal": [-3, 0, 0]}, HEADS),
        ({"normal": [1, 0, 1], "within": 45}, BEDS | HEADS),
        ({"materials": ["brick", "stone"]}, HEADS),
        ({"materials": ["stone", "brick"]}, HEADS),
        ({"materials": "stone"}, {"low-1-top-1"}),
        ({"blocks": ["top-*", "*"]}, {"low-1-top-1", "low-2-top-2", "top-1-top-2"}),
        ({"blocks": "low-*"}, {"low-1-low-2"}),
        ({"blocks": ["*", "*-1"], "normal": [0, 0, 1]}, {"base-low-1", "low-1-top-1"}),
    ],
)
def test_a_law_is_for_the_pairs_that_a_rule_fits(between: Any, expected: set[str]) -> None:
    assert chosen(between) == expected


def test_the_last_law_that_fits_counts() -> None:
    rough = {"between": ["low-1", "low-2"], "friction": 0.9}
    found = frictions({"between": {"normal": [1, 0, 0]}, "friction": 0.2}, rough)
    assert (found["low-1-low-2"], found["top-1-top-2"]) == (0.9, 0.2)
    assert frictions(rough, {"between": "all", "friction": 0.2})["low-1-low-2"] == 0.2


def test_locks_are_of_the_pairs_that_a_rule_fits() -> None:
    locks = {"count": 3, "height": 0.1, "row": [0, 1, 0], "condensed": {"working": "all"}}
    locks["between"] = {"materials": ["stone", "brick"]}  # type: ignore[assignment]
    locked = [
        face.name
        for face in structure_of({**WALL, "locks": [locks]}).assembly.faces
        if face.kind is Kind.LOCKED
    ]
    assert set(locked) == HEADS
