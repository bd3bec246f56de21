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


@pytest.mark.parametrize("value", [*NONE, -1.0])
def test_a_piece_has_a_size_and_a_mass(joint: Joint, value: float) -> None:
    piece = block_on_ground(joint, Kind.DRY, 0.02).pieces[1]
    with pytest.raises(ValueError, match=f"block, mass .*: {value} is"):
        replace(piece, mass=value)
    with pytest.raises(ValueError, match="block, edge x"):
        replace(piece, high=(value, 1.0, 1.0))


@pytest.mark.parametrize("value", [*NONE, -1.0, 0.0])
def test_scales_are_positive(joint: Joint, value: float) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    with pytest.raises(ValueError, match=f"length: {value} is"):
        replace(model, length=value)
    with pytest.raises(ValueError, match=f"scale: {value} is"):
        replace(load_on_block(model, (0.0, 1.0, 0.0), 0.0), scale=value)


@pytest.mark.parametrize("value", NONE)
@pytest.mark.parametrize("name", ["permanent", "variable"])
def test_loads_are_finite(joint: Joint, name: str, value: float) -> None:
    model = block_on_ground(joint, Kind.DRY, 0.02)
    loads = load_on_block(model, (0.0, 1.0, 0.0), 0.0)
    with pytest.raises(ValueError, match=f"{name} loads"):
        replace(loads, **{name: np.full((2, 6), value)})


def test_nodes_stand_face_by_face_and_have_an_area(joint: Joint) -> None:
    nodes = block_on_ground(joint, Kind.DRY, 0.02).nodes
    with pytest.raises(ValueError, match="in the order of their faces"):
        replace(nodes, face=np.arange(len(nodes.face))[::-1])
    for value in (*NONE, 0.0, -1.0):
        with pytest.raises(ValueError, match="areas"):
            replace(nodes, area=nodes.area * value)
