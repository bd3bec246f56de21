"""What an assembly refuses."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import block_on_ground, load_on_block

from sidmacib.joint import DRY, Joint
from sidmacib.mechanics.assembly import Kind

NONE = math.nan, math.inf, -math.inf


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, value) for name in vars(DRY) for value in (*NONE, -1.0)),
        *(("normal_stiffness", 0.0), ("shear_stiffness", 0.0)),
    ],
)
def test_a_material_has_stiffness_and_nothing_negative_or_infinite(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name}: {value}"):
        replace(DRY, **{name: value})


def test_nodes_stand_face_by_face(joint: Joint) -> None:
    nodes = block_on_ground(joint, Kind.DRY, 0.02).nodes
    with pytest.raises(ValueError, match="in the order of their faces"):
        replace(nodes, face=np.arange(len(nodes.face))[::-1])


@pytest.mark.parametrize("value", [*NONE, -1.0, 0.0])
def test_sizes_masses_scales_and_loads_are_numbers(joint: Joint, value: float) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads, piece = load_on_block(model, (0.0, 1.0, 0.0), 0.0), model.pieces[1]
    refused = [
        (model, {"length": value}, f"length: {value} is"),
        (loads, {"scale": value}, f"scale: {value} is"),
        (model.nodes, {"area": model.nodes.area * value}, "areas"),
    ]
    if value:  # a piece may have no mass, and begins at 0
        refused.append((piece, {"mass": value}, f"block, mass .*: {value} is"))
        refused.append((piece, {"high": (value, 1.0, 1.0)}, "block, edge x"))
    if not math.isfinite(value):
        given = np.full((2, 6), value)
        refused += [(loads, {n: given}, f"{n} loads") for n in ("permanent", "variable")]
    for whole, change, words in refused:
        with pytest.raises(ValueError, match=words):
            replace(whole, **change)
