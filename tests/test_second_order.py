"""What finite rotation changes of a load of the static model, to second order."""

import math
from pathlib import Path
from typing import Any

import pytest
from command_runner import by_model
from described import PUSH

WIDTH, HEIGHT = 0.4, 2.0
TILT = {"tilt": {"axis": [0, 1, 0]}}


def static_note(path: Path, stiffness: float, load: dict[str, Any]) -> str:
    tower = {
        "blocks": {
            "ground": {"low": [-2, -2, -1], "high": [2, 2, 0], "fixed": True},
            "tower": {"low": [0, 0, 0], "high": [WIDTH, 0.6, HEIGHT], "density": 2000},
        },
        "interfaces": {f"{way}_stiffness": stiffness for way in ("normal", "shear")}
        | {"friction": 0.7},
        "load": load,
    }
    return str(by_model(path, tower)["static"]["note"])


@pytest.mark.parametrize("load", [PUSH, TILT])
def test_soft_joints_let_a_tower_lean_and_carry_less(tmp_path: Path, load: dict[str, Any]) -> None:
    assert static_note(tmp_path / "tower.yaml", 1e10, load).endswith("; small displacements")
    stiffness = 2e7
    note = static_note(tmp_path / "tower.yaml", stiffness, load)
    words, share = note.rsplit("; ", 1)[1].rsplit(" about ", 1)
    assert words == "small displacements: finite rotation would lower it by"
    # At the peak it rests on one edge, which gives by its weight until the middle row of nodes
    # opens: the load is W tan(alpha - turn). A quarter of the area is at the edge, on cells of half
    # the size.
    weight = WIDTH * 0.6 * HEIGHT * 2000 * 9.81
    turn = weight / (stiffness * WIDTH * 0.6 / 4) / (WIDTH / 2)
    alpha = math.atan(WIDTH / HEIGHT)
    known = 1.0 - math.tan(alpha - turn) / math.tan(alpha)
    assert known > 0.15
    assert float(share.removesuffix(" %")) / 100.0 == pytest.approx(known, rel=0.15)
